/* Lays a chart and its overlap out in the texel grid of its frame. */
#include "bake/field/flatten.hpp"

#include "chart/places.hpp"

#include <algorithm>

namespace gtx::baking {

/* Cells a chart gets at least along a side (truck: 3 % more texels at double), and texels it may
 * have at most: a limit against hostile charts, which no model reaches. */
constexpr double MIN_CELLS = 4, MAX_TEXELS = 512;
/* A pitch is never finer than this part of the model's: a needle is no reason for a fine map. A
 * limit: hardly a byte changes at half or double. */
constexpr double FINEST = 1.0 / 16;
/* Texels around the core: overlap, what is shown beyond it, and the far corner of a cell there.
 * Truck: RMS -7 % at half; Duck: 3 % more at double. */
constexpr int MARGIN = 4;

/* Cosine between two planes from which their edge is sharp. At 0.9 coarse models have as few walls,
 * and more of a scan's noise counts. */
constexpr double SHARP = 0.7;
/* Texels that those on the core's sides are inside, so that every rasteriser covers them. At half a
 * box's outline is twice as far off. */
constexpr double INSIDE = 1.0 / 32;
/* Of the core's two sides across an axis, the part that has to end at creases or borders for them
 * to be aligned, and texels that these may be off. At a few texels the truck has 8 hole pixels
 * more. */
constexpr double STRAIGHT = 0.5, OFF_SIDE = 1e-3;

bool is_crease(const Mesh &mesh, const Neighbours &neighbours, uint32_t triangle, int side)
{
    const uint32_t beyond = neighbours[triangle][size_t(side)];
    if (beyond == NO_TRIANGLE)
        return false;
    const Vec3d normal = normalize(mesh.area_vector(triangle));
    if (!(dot(normal, normalize(mesh.area_vector(beyond))) < SHARP))
        return false;
    double highest = -INFINITY, lowest = INFINITY;
    for (int k = 0; k < 3; ++k) {
        const double above =
            dot(normal, mesh.position(beyond, k) - mesh.position(triangle, side));
        highest = std::max(highest, above);
        lowest = std::min(lowest, above);
    }
    return highest < -lowest;
}

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

/* The core's sides: from where to where along an axis, at the pitch of a texel, in how many
 * cells. */
struct Side {
    double low = INFINITY, high = -INFINITY, pitch = 0;
    int cells = 0;
};

/* The model's pitch, finer along a side of under four cells, coarser where the map would become
 * too large. */
static std::array<Side, 2> measure_sides(const Mesh &mesh, const Chart &chart, const Grid &grid,
                                         double pitch)
{
    std::array<Side, 2> sides;
    for (uint32_t t : chart.triangles) {
        for (int k = 0; k < 3; ++k) {
            Vec3d p = mesh.position(t, k) - grid.origin;
            for (int axis = 0; axis < 2; ++axis) {
                double a = dot(grid.dual[axis], p);
                sides[axis].low = std::min(sides[axis].low, a);
                sides[axis].high = std::max(sides[axis].high, a);
            }
        }
    }
    pitch = std::max(pitch, std::max(sides[0].high - sides[0].low, sides[1].high - sides[1].low) /
                                MAX_TEXELS);
    for (Side &side : sides) {
        double extent = side.high - side.low;
        side.pitch = std::clamp(extent / MIN_CELLS, pitch * FINEST, pitch);
        side.cells = int(std::ceil(extent / side.pitch));
    }
    return sides;
}

/* Those of a chart that was cut along its grid: `finer` times as many cells. */
static std::array<Side, 2> given_sides(const Chart &chart, double finer)
{
    std::array<Side, 2> sides;
    for (int axis = 0; axis < 2; ++axis) {
        int cells = int(std::ceil(chart.cells[axis] * finer));
        sides[axis] = {0, chart.frame.extent[axis], chart.frame.extent[axis] / cells, cells};
    }
    return sides;
}

/* Which sides of the core are straight ends of the surface. Where these lie on texels bilinear trim
 * follows them exactly, around corners too. */
static void align(const Mesh &mesh, const Neighbours &neighbours, const Chart &chart,
                  const std::array<Side, 2> &sides, Grid &grid)
{
    double straight[2] = {};
    for (uint32_t t : chart.triangles) {
        Vec3d at[3];
        for (int k = 0; k < 3; ++k) {
            const Vec3d p = mesh.position(t, k) - grid.origin;
            at[k] = {dot(grid.dual[0], p) / sides[0].pitch, dot(grid.dual[1], p) / sides[1].pitch,
                     0};
        }
        for (int k = 0; k < 3; ++k)
            for (int axis = 0; axis < 2; ++axis) {
                const Vec3d &p = at[k], &q = at[(k + 1) % 3];
                auto off = [&](const Vec3d &r) {
                    return std::min(std::abs(r[axis] - sides[axis].low / sides[axis].pitch),
                                    std::abs(r[axis] - sides[axis].high / sides[axis].pitch));
                };
                if (std::max(off(p), off(q)) <= OFF_SIDE &&
                    (neighbours[t][size_t(k)] == NO_TRIANGLE || is_crease(mesh, neighbours, t, k)))
                    straight[axis] += std::abs(p[1 - axis] - q[1 - axis]);
            }
    }
    for (int axis = 0; axis < 2; ++axis)
        grid.aligned[axis] = sides[axis].high > sides[axis].low && straight[axis] > 0 &&
                             straight[axis] >= STRAIGHT * 2 * sides[size_t(1 - axis)].cells;
}

/* `aligned` as it is where there are no neighbours to look at. */
static Grid fit_grid(const Mesh &mesh, const Neighbours *neighbours, const Chart &chart,
                     double pitch, double finer, const bool aligned[2])
{
    Grid grid = reciprocal_grid(chart.frame);
    std::array<Side, 2> sides = chart.cells[0] ? given_sides(chart, finer)
                                               : measure_sides(mesh, chart, grid, pitch / finer);
    std::copy_n(aligned, 2, grid.aligned);
    if (neighbours)
        align(mesh, *neighbours, chart, sides, grid);
    for (int axis = 0; axis < 2; ++axis) {
        Side &s = sides[axis];
        if (grid.aligned[axis])
            s.pitch = (s.high - s.low) / (s.cells + 2 * INSIDE);
        int size = s.cells + 2 * MARGIN + grid.aligned[axis];
        (axis ? grid.h : grid.w) = size;
        grid.pitch[axis] = s.pitch;
        grid.corner[axis] = (s.low + s.high) / 2 - size * s.pitch / 2;
        grid.clip_low[axis] = (chart.clip_low[axis] - grid.corner[axis]) / s.pitch - 0.5;
        grid.clip_high[axis] = (chart.clip_high[axis] - grid.corner[axis]) / s.pitch - 0.5;
    }
    return grid;
}

static void lay_corners(const Mesh &mesh, const Grid &grid, FlatTriangle &flat)
{
    for (int k = 0; k < 3; ++k)
        flat.corner[k] = grid.texel(mesh.position(flat.source, k));
}

static FlatTriangle flat_triangle(const Mesh &mesh, const Grid &grid, uint32_t source)
{
    FlatTriangle flat;
    flat.source = source;
    lay_corners(mesh, grid, flat);
    flat.front = flat.signed_area() > 0;
    return flat;
}

FlatChart flatten(const Mesh &mesh, const Neighbours &neighbours, const Chart &chart, double pitch,
                  double finer)
{
    FlatChart flat;
    flat.grid = fit_grid(mesh, &neighbours, chart, pitch, finer, flat.grid.aligned);
    flat.core = chart.triangles.size();
    /* Beyond the overlap that is shown, texels are sampled rather than extrapolated while there is
     * source surface to sample. */
    Vector<uint32_t> overlap =
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

    Places places(flat.triangles.size());
    for (size_t i = 0; i < flat.triangles.size(); ++i)
        places.add(flat.triangles[i].source, uint32_t(i));
    flat.mate.resize(flat.triangles.size());
    for (size_t i = 0; i < flat.triangles.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            uint32_t across = neighbours[flat.triangles[i].source][k];
            uint32_t at = across == NO_TRIANGLE ? NO_TRIANGLE : places.find(across);
            flat.mate[i][k] = at != NO_TRIANGLE && flat.triangles[at].front ? at : NO_TRIANGLE;
        }
    }
    return flat;
}

void flatten_again(const Mesh &mesh, const Chart &chart, FlatChart &flat)
{
    flat.grid = fit_grid(mesh, nullptr, chart, 0, 1, flat.grid.aligned);
    for (FlatTriangle &t : flat.triangles)
        lay_corners(mesh, flat.grid, t);
}

} // namespace gtx::baking
