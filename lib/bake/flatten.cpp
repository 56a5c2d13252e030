/* Lays a chart and its overlap out in the texel grid of its frame. */
#include "bake/patch_maps.hpp"

#include <algorithm>

namespace gtx::baking {

/* Cells a chart gets at least along a side, and texels it may have at most. */
constexpr double LEAST_CELLS = 4, MOST_TEXELS = 512;
/* A pitch is never finer than this part of the model's: a needle is no reason for a fine map. */
constexpr double FINEST = 1.0 / 16;
/* Texels around the core: overlap, what is shown beyond it, and the far corner of a cell there. */
constexpr int MARGIN = 4;

static Grid reciprocal_grid(const Frame &frame)
{
    Grid grid;
    double det = dot(cross(frame.x, frame.y), frame.z);
    grid.origin = frame.origin;
    grid.dual[0] = cross(frame.y, frame.z) / det;
    grid.dual[1] = cross(frame.z, frame.x) / det;
    grid.dual[2] = cross(frame.x, frame.y) / det;
    return grid;
}

/* Fits the grid around the core: the model's pitch, finer along a side of under four cells, coarser
 * where the map would become too large. */
static Grid fit_grid(const Mesh &mesh, const Chart &chart, double pitch)
{
    Grid grid = reciprocal_grid(chart.frame);
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (uint32_t t : chart.triangles) {
        for (int k = 0; k < 3; ++k) {
            Vec3d p = mesh.position(t, k) - grid.origin;
            for (int axis = 0; axis < 2; ++axis) {
                double a = dot(grid.dual[axis], p);
                low[axis] = std::min(low[axis], a);
                high[axis] = std::max(high[axis], a);
            }
        }
    }
    double longest = std::max(high[0] - low[0], high[1] - low[1]);
    pitch = std::max(pitch, longest / MOST_TEXELS);
    int size[2];
    for (int axis = 0; axis < 2; ++axis) {
        double extent = high[axis] - low[axis];
        double own = std::clamp(extent / LEAST_CELLS, pitch * FINEST, pitch);
        size[axis] = int(std::ceil(extent / own)) + 2 * MARGIN;
        grid.pitch[axis] = own;
        grid.corner[axis] = (low[axis] + high[axis]) / 2 - size[axis] * own / 2;
    }
    grid.w = size[0];
    grid.h = size[1];
    return grid;
}

static FlatTriangle flat_triangle(const Mesh &mesh, const Grid &grid, uint32_t source)
{
    FlatTriangle flat;
    flat.source = source;
    for (int k = 0; k < 3; ++k)
        flat.corner[k] = grid.texel(mesh.position(source, k));
    Vec3d e = flat.corner[1] - flat.corner[0], f = flat.corner[2] - flat.corner[0];
    flat.front = e.x * f.y - e.y * f.x > 0;
    return flat;
}

/* The place of `source` among the triangles, which are two ascending runs. */
static uint32_t find_triangle(const FlatChart &chart, uint32_t source)
{
    auto before = [](const FlatTriangle &a, uint32_t b) { return a.source < b; };
    auto begin = chart.triangles.begin(), middle = begin + ptrdiff_t(chart.core);
    auto end = chart.triangles.end();
    for (auto run : {std::make_pair(begin, middle), std::make_pair(middle, end)}) {
        auto at = std::lower_bound(run.first, run.second, source, before);
        if (at != run.second && at->source == source)
            return uint32_t(at - begin);
    }
    return NO_TRIANGLE;
}

FlatChart flatten(const Mesh &mesh, const Neighbours &neighbours, const Chart &chart, double pitch)
{
    FlatChart flat;
    flat.grid = fit_grid(mesh, chart, pitch);
    flat.core = chart.triangles.size();
    /* Beyond the overlap that is shown, texels are sampled rather than extrapolated while there is
     * source surface to sample. */
    std::vector<uint32_t> overlap =
        overlap_triangles(mesh, neighbours, chart, (MARGIN - 0.5) * flat.grid.coarse_pitch());
    flat.triangles.reserve(flat.core + overlap.size());
    for (uint32_t t : chart.triangles)
        flat.triangles.push_back(flat_triangle(mesh, flat.grid, t));
    for (uint32_t t : overlap)
        flat.triangles.push_back(flat_triangle(mesh, flat.grid, t));

    /* A chart that nowhere faces its frame is junk; all of it is shown rather than nothing. */
    auto core_end = flat.triangles.begin() + ptrdiff_t(flat.core);
    if (std::none_of(flat.triangles.begin(), core_end, [](const auto &t) { return t.front; }))
        for (FlatTriangle &t : flat.triangles)
            t.front = true;

    flat.mate.resize(flat.triangles.size());
    for (size_t i = 0; i < flat.triangles.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            uint32_t across = neighbours[flat.triangles[i].source][k];
            uint32_t at = across == NO_TRIANGLE ? NO_TRIANGLE : find_triangle(flat, across);
            flat.mate[i][k] = at != NO_TRIANGLE && flat.triangles[at].front ? at : NO_TRIANGLE;
        }
    }
    return flat;
}

} // namespace gtx::baking
