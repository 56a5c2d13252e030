/* Frame times of an asset, of the mesh it was cooked from, and of simplified meshes. */
#pragma once

#include "base/json.h"
#include "cli/bench/truth.hpp"
#include "cli/view/scene.hpp"
#include "host/offscreen.h"

#include <array>
#include <functional>

namespace gtx {

enum class BenchMethod : uint32_t {
    MESH,        /* the source in buffers, in vertex-cache order, its back faces culled */
    MESH_STREAM, /* the same arrays sent anew each frame */
    MESH_LOD,    /* its coarsest simplification that looks as good as what AUTO draws */
    PAPER, CAST, LOD, AUTO,
    CAST_DEPTH, AUTO_DEPTH, /* the depth pass alone */
    CAST_FRAGMENT, /* cast in fragments where CAST is by tiles */
    GRID, GRID_DEPTH,
    FLOOR,         /* of run_path alone: the pixels that AUTO covers, shaded once */
    CAST_OWN, LOD_OWN, AUTO_OWN, GRID_OWN, /* by a fragment main of an engine's own (own.cpp) */
    /* The same by Vulkan; of run_bench alone. */
    PAPER_VULKAN, CAST_VULKAN, LOD_VULKAN, AUTO_VULKAN, CAST_FRAGMENT_VULKAN, GRID_VULKAN
};
constexpr uint32_t BENCH_METHODS = 23;
/* What draws the same by OpenGL; itself for methods that are not Vulkan's. And the other way round,
 * MESH where there is none. */
BenchMethod without_vulkan(BenchMethod method);
BenchMethod with_vulkan(BenchMethod method);
inline bool is_own(BenchMethod method)
{
    return method >= BenchMethod::CAST_OWN && method <= BenchMethod::GRID_OWN;
}
extern const char *const bench_method_names[BENCH_METHODS]; /* as in reports */
/* Pixels. An error is stated for the farthest point: outlines agree at larger ones. */
constexpr double bench_errors[] = {0.25, 0.3, 0.35, 0.42, 0.5, 0.59, 0.71, 0.84, 1,
                                   1.19, 1.41, 1.68, 2, 2.38, 2.83, 3.36, 4};

struct BenchOptions {
    Vector<std::array<uint32_t, 2>> sizes;      /* windows, pixels */
    Vector<uint32_t> instances;                 /* ascending */
    Vector<BenchMethod> methods;                /* in the table's order */
    uint32_t frames = 12;
    double max_error = 0.5;                     /* pixels */
    double min_iou = 0;                         /* over 0: max_error is the largest of
                                                   bench_errors that AUTO keeps it at */
    double budget = 600;                        /* seconds, of all rows */
    bool along_path = false;                    /* for run_path, not run_bench */
    uint32_t repeats = 3;                       /* of a view of a path */
    gtx_compression compress = GTX_COMPRESS_NONE; /* of the asset's model */
    bool compress_normals = false;
    bool truth = false;                         /* compare pictures with it, too */
    gtx_host_load load = gtx_offscreen_load;    /* what the renderer is given */
};

struct BenchRow {
    std::array<uint32_t, 2> size;
    uint32_t instances;
    BenchMethod method;
    uint32_t triangles = 0;         /* of a mesh, an instance */
    double max_error = 0;           /* pixels that it was drawn at; 0: a mesh */
    uint32_t frames = 0;            /* 0: skipped, and why */
    const char *skipped = nullptr;
    double median = 0, least = 0;   /* milliseconds; the median of each azimuth, averaged */
    double work = 0;                /* the same of all processors together */
    /* One instance at its share of the window, over four azimuths, against the mesh: */
    double iou = 0;                 /* of what is covered */
    double psnr = 0;                /* decibels, over what either covers; infinite: the same */
    uint64_t pixels = 0;            /* covered, a view */
    uint64_t holes = 0;             /* pixels not covered inside what the mesh covers */
    uint64_t rays = 0, hits = 0;    /* fragments shaded and kept, a view; 0: not told */
    TruthError truth;               /* where it was asked for */
};

struct BenchSetup {
    std::string renderer;           /* of OpenGL: the platform */
    std::string device;             /* of Vulkan, or empty */
    uint32_t triangles = 0;
    uint64_t geometry_bytes = 0;    /* of the asset on the GPU, colour apart */
    /* Milliseconds: file to asset, asset to model, model to GPU. */
    double open = 0, prepare = 0, upload = 0;
};

/* Measures every window, instance count and method through EGL, without a window; rows are told
 * one by one as they are done. The methods of a window take turns frame by frame, each frame
 * ended by glFinish, so that a machine that slows down slows all of them. A method whose first
 * frame takes over two seconds is measured once. Throws Error: GL, SHADER, MEMORY, LIMIT, and
 * what opening the files says. */
void run_bench(const std::string &asset_path, const Mesh &mesh, const BenchOptions &options,
               const std::function<void(const BenchSetup &)> &begin,
               const std::function<void(const BenchRow &)> &tell);

/* bench_report.cpp: the table's head; a line, with ratios to the median of the mesh's row of the
 * same window, 0 if there is none; and a row as JSON. */
void print_bench_head(bool truth);
void print_bench_row(const BenchRow &row, double mesh);
void write_bench_row(gtx_json &json, const BenchSetup &setup, const BenchRow &row);

} // namespace gtx
