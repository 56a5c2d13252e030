/* Reading height grids, and fitting them to each other, behind the C API. */
#include "cook/grids.hpp"
#include "cook/guard.hpp"
#include "cook/options.hpp"

#include "base/alloc.h"
#include "mesh/task.hpp"

#include <algorithm>

namespace gtx {

HeightGrid lattice(const gtx_height_grid &from, const float *values)
{
    HeightGrid grid;
    grid.nx = from.nx;
    grid.ny = from.ny;
    std::copy_n(from.origin, 2, grid.origin);
    std::copy_n(from.spacing, 2, grid.step);
    grid.rotation = from.rotation;
    grid.in_degrees = from.in_degrees;
    grid.is_unplaced = from.unplaced;
    grid.has_categories = from.categories;
    grid.values.assign(values, values + grid.count());
    for (float &value : grid.values)
        if (!(std::fabs(value) < 1e30f))
            value = NAN;
    return grid;
}

void require_placed(const gtx_height_grid &g)
{
    require_zeroed(g.reserved);
    require_argument(g.values, "a grid has no values");
    require_argument(g.in_degrees <= 1 && g.unplaced <= 1 && g.categories <= 1,
                     "in_degrees, unplaced and categories are 0 or 1");
    for (double place : {g.origin[0], g.origin[1], g.rotation, g.spacing[0], g.spacing[1]})
        require_argument(std::fabs(place) < 1e15,
                         "a grid's origin, rotation or spacing is not below 10^15");
    require_argument(g.spacing[0] > 0 && g.spacing[1] > 0, "a grid's spacing is not positive");
}

static void require_lattice(const gtx_height_grid &g)
{
    require_placed(g);
    require_argument(g.nx > 0 && g.ny > 0 && g.nx <= MAX_SIDE && g.ny <= MAX_SIDE,
                     "a side of a grid has 1 to 2^24 nodes");
}

/* A copy of values by an allocator. */
static const float *given(const Vector<float> &values, const gtx_allocator &allocator)
{
    auto *out = static_cast<float *>(gtx_alloc_array(&allocator, values.size(), sizeof(float)));
    if (!out)
        throw std::bad_alloc();
    std::copy(values.begin(), values.end(), out);
    return out;
}

static void read(const char *path, const gtx_height_grid_desc &desc, gtx_height_grid *out)
{
    require_zeroed(desc.reserved);
    require_argument(desc.has_missing <= 1, "has_missing is 0 or 1");
    const bool ranged = desc.range[0] != 0 || desc.range[1] != 0;
    require_argument(std::isfinite(desc.range[0]) && std::isfinite(desc.range[1]),
                     "range is two finite numbers");
    require_limits(desc.limits);
    Task task(1, nullptr, nullptr, {}, {}, desc.limits);
    GridReading reading;
    reading.missing = desc.has_missing ? &desc.missing : nullptr;
    reading.range = ranged ? desc.range : nullptr;
    const HeightGrid grid = read_grid(path, reading, task);
    gtx_height_grid made = {};
    made.nx = grid.nx;
    made.ny = grid.ny;
    std::copy_n(grid.origin, 2, made.origin);
    std::copy_n(grid.step, 2, made.spacing);
    made.rotation = grid.rotation;
    made.in_degrees = grid.in_degrees;
    made.unplaced = grid.is_unplaced;
    made.allocator = gtx_allocator_or_default(desc.allocator);
    made.values = given(grid.values, made.allocator);
    *out = made;
}

static void fit(const gtx_height_grid &from, const gtx_height_grid &to,
                const gtx_allocator *allocator, gtx_height_grid *out)
{
    require_lattice(from);
    require_lattice(to);
    gtx_height_grid made = to;
    made.property = nullptr;
    made.categories = from.categories;
    made.allocator = gtx_allocator_or_default(allocator);
    made.values = given(resample(lattice(from, from.values), lattice(to, to.values)),
                        made.allocator);
    *out = made;
}

static void take_metres(gtx_height_grid &grid, double latitude)
{
    require_argument(std::fabs(latitude) <= 90, "a latitude is -90 to 90");
    HeightGrid placed;
    std::copy_n(grid.origin, 2, placed.origin);
    std::copy_n(grid.spacing, 2, placed.step);
    placed.rotation = grid.rotation;
    placed.in_degrees = grid.in_degrees;
    use_local_metres(placed, latitude);
    std::copy_n(placed.origin, 2, grid.origin);
    std::copy_n(placed.step, 2, grid.spacing);
    grid.in_degrees = 0;
}

} // namespace gtx

gtx_result gtx_height_grid_read(const char *path, const gtx_height_grid_desc *desc,
                                gtx_height_grid *out, gtx_error *error)
{
    return gtx::guard(error, [&] {
        gtx::require_argument(path && out, "gtx_height_grid_read needs a path and a result");
        gtx::read(path, desc ? *desc : gtx_height_grid_desc{}, out);
    });
}

void gtx_height_grid_free(gtx_height_grid *grid)
{
    if (!grid)
        return;
    if (grid->allocator.free)
        gtx_free_array(&grid->allocator, const_cast<float *>(grid->values),
                       size_t(grid->nx) * grid->ny, sizeof(float));
    *grid = {};
}

gtx_result gtx_height_grid_resample(const gtx_height_grid *from, const gtx_height_grid *to,
                                    const gtx_allocator *allocator, gtx_height_grid *out,
                                    gtx_error *error)
{
    return gtx::guard(error, [&] {
        gtx::require_argument(from && to && out, "gtx_height_grid_resample needs three grids");
        gtx::fit(*from, *to, allocator, out);
    });
}

gtx_result gtx_height_grid_to_metres(gtx_height_grid *grid, double latitude, gtx_error *error)
{
    return gtx::guard(error, [&] {
        gtx::require_argument(grid, "gtx_height_grid_to_metres needs a grid");
        gtx::take_metres(*grid, latitude);
    });
}
