/* Measures of an asset, or of several shown together, against the source mesh, as
 * format/measures.md defines them. */
#pragma once

#include "mesh/mesh.hpp"

#include <geotex/geotex.h>

#include <functional>

namespace gtx {

struct Deviation {
    double rms = 0, max = 0;     /* fractions of the source's bounding diagonal */
};

/* Assets that are shown together, each at its anchor; at least one. */
using Assets = Vector<const gtx_asset *>;

/* Forward: 2^18 area-stratified points of the source to the nearest point of the trimmed asset.
 * Reverse: as many points of all that is drawn, past outlines too, to the nearest point of the
 * source. Fewer where so many surfaces lie over each other that each point takes long. `junk` (per
 * triangle, may be empty) leaves triangles out of the forward samples; so does a mask what it cuts
 * away. */
struct SurfaceError {
    Deviation forward, reverse;
};
SurfaceError surface_error(const Assets &assets, const Mesh &mesh,
                           const Vector<uint8_t> &junk, Task &task);

/* Where patches meet, of one asset or of two: 100,000 points of the outlines of their cores (trim
 * 0), each to the nearest point of the other patches, in height steps of the coarser of the two.
 * Points within two texels of where the source ends have no other patch to meet. */
struct SeamReport {
    uint64_t points = 0, within_two_steps = 0;
    double p99_steps = 0, max_steps = 0;
    double max = 0;              /* fraction of the source's bounding diagonal */
};
SeamReport measure_seams(const Assets &assets, const Mesh &mesh, Task &task);

/* How many pixels a level of detail gets wrong. */
struct LevelReport {
    uint32_t level = 0;
    uint64_t hole_pixels = 0, wall_pixels = 0, leak_pixels = 0;
    double silhouette_iou = 0;
};

/* The same in images of `size` pixels a side, where each patch is cast at the level that the
 * runtime takes there by default: the coarsest within half a pixel. */
struct DetailReport {
    uint32_t size = 0;
    uint64_t surface_pixels = 0, hole_pixels = 0, wall_pixels = 0, leak_pixels = 0;
    double silhouette_iou = 0;
};

/* Figures of all views together. The top ones are those of the worst level that the runtime may
 * draw (level 0). */
struct CompareReport {
    uint32_t views = 0;
    uint64_t surface_pixels = 0, hole_pixels = 0, wall_pixels = 0, leak_pixels = 0;
    uint64_t turned_pixels = 0;
    double silhouette_iou = 0, silhouette_iou_min = 0;
    double depth_rms = 0, depth_p99 = 0, depth_max = 0;   /* fractions of the diagonal */
    double normal_mean_deg = 0, normal_p99_deg = 0;
    double psnr_db = 0;
    Vector<LevelReport> levels;
    Vector<DetailReport> details;      /* the views' own size, then each half of the one before */
    SurfaceError error;
    SeamReport seams;
};

/* One pixel that is wrong, to find out why. */
enum class Fault : uint8_t { hole, wall, turned };
constexpr uint32_t CHOSEN_LEVELS = 0xffffffffu; /* each patch at its own, as for DetailReport */
struct PixelFault {
    Fault kind;
    uint32_t level;              /* or CHOSEN_LEVELS */
    uint32_t size, view, x, y;   /* pixels along a side of the view, which view, and where */
    uint32_t triangle;           /* of the mesh, seen there; UINT32_MAX: none */
    uint32_t patch;              /* that was hit; UINT32_MAX: none */
    uint32_t asset;              /* whose patch that is */
    double off;                  /* by how much too deep, or too near (infinity: alone); degrees */
    Vec3d position;              /* of the source's surface, or a wall's, object space */
};

struct CompareOptions {
    uint32_t size = 1024;        /* pixels along a side of a view */
    uint32_t levels = 1;         /* levels of detail to evaluate */
    bool surface = true;         /* measure `error` and `seams` too */
    bool details = true;         /* evaluate what the runtime would draw too */
    bool cut = false;            /* out of a closed surface: its backs are not there */
    uint32_t random_views = 0;   /* beside the 26 fixed ones, of this seed */
    uint32_t seed = 0;
    Vector<PixelFault> *faults = nullptr;     /* appended to: every fault of every level and
                                              detail, views in order */
};

CompareReport compare(const gtx_asset *asset, const Mesh &mesh, const CompareOptions &options,
                      Task &task);

/* The assets to show where so many object units make up a pixel; 0: for the levels, the distances
 * and the seams. They live as long as the comparison. */
using ShownAt = std::function<Assets(double pixel)>;
CompareReport compare(const ShownAt &shown, const Mesh &mesh, const CompareOptions &options,
                      Task &task);

} // namespace gtx
