/* Frame times along a path, view by view, of each method and of the mesh. */
#pragma once

#include "cli/bench/bench.hpp"
#include "cli/bench/path.hpp"

namespace gtx {

/* A method at a viewpoint. Times are the least of some frames: what else the machine does only
 * adds. */
struct PathCell {
    double ms = 0, work = 0;        /* of the clock; of all processors together */
    uint64_t pixels = 0;            /* covered */
    double iou = 1;                 /* against the mesh's picture, like what follows */
    uint64_t holes = 0;             /* pixels not covered, inside what the mesh covers */
    uint64_t enclosed = 0;          /* gaps, see enclosed_holes */
    uint32_t outline = 0;           /* pixels, see outline_error */
    uint32_t triangles = 0;         /* of a mesh, before what is out of view */
    TruthError truth;               /* where it was asked for */
};

/* A method along the whole path. `ratio` is its time over the mesh's of the same view. */
struct PathRow {
    BenchMethod method;
    double median = 0, mean = 0, work = 0;    /* milliseconds; work is the median */
    double ratio = 0, worst = 0;    /* median, and the worst of any view */
    double work_ratio = 0, work_worst = 0;    /* the same of work, for machines that are busy */
    Vector<size_t> order;           /* of the views, the worst first */
    double iou = 1;                 /* the least */
    uint64_t holes = 0, enclosed = 0;         /* the most */
    uint32_t outline = 0;           /* the most */
    TruthError truth;               /* of all views together */
};

struct PathReport {
    std::array<uint32_t, 2> size;
    const ViewPath *path;
    size_t measured = 0;            /* views, the first ones: fewer where the budget ends */
    Vector<PathRow> rows;
    Vector<Vector<PathCell>> cells; /* rows x measured views */
};

/* Measures every window through EGL, without a window. The methods of a view take turns, frame by
 * frame, each ended by glFinish; a method that takes over two seconds is measured once. LOD is left
 * out where the asset has no LOD mesh; MESH_STREAM must not be asked for. The mesh is drawn in
 * parts, without those out of view, its back faces culled but where it is two-sided; MESH_LOD is
 * its coarsest simplification with an error of at most max_error at the nearest vertex in view.
 * Throws as run_bench. */
void run_path(const std::string &asset_path, const Mesh &mesh, const ViewPath &path,
              const BenchOptions &options,
              const std::function<void(const BenchSetup &)> &begin,
              const std::function<void(const PathReport &)> &tell);

/* A table, and below it the worst views of each method of the asset as keys of a path. */
void print_path_report(const PathReport &report);
/* As an object of the array "paths". */
void write_path_report(gtx_json &json, const PathReport &report);

} // namespace gtx
