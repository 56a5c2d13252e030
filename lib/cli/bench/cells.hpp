/* The number of cells that rays visit: a cost of casting that does not depend on the machine. */
#pragma once

#include "cli/bench/bench.hpp"
#include "cli/bench/path.hpp"

namespace gtx {

/* A method over some views. A pixel's ray is all that its fragments cast. */
struct CellRow {
    std::array<uint32_t, 2> size;
    BenchMethod method;
    uint64_t rays = 0;              /* pixels that are cast for */
    double fragments = 0;           /* that cast, a ray */
    double cells = 0, slabs = 0;    /* looked at, a ray; the paper's search: points */
    uint32_t most_cells = 0, most_slabs = 0; /* of any ray */
    size_t worst = 0;               /* the view with most_cells */
};

bool casts_alone(BenchMethod method);

/* Draws each method once from each view of the path, or as an orbit does where it is null, with
 * shaders that count. The methods are those that cast alone. Throws as run_bench; GL: OpenGL ES. */
void run_cells(const std::string &asset_path, const ViewPath *path, BenchOptions options,
               const std::function<void(const CellRow &)> &tell);

void print_cells_head(const char *scene);
void print_cells(const CellRow &row);

} // namespace gtx
