/* Readers of height grids: what each reads becomes an asset. */
#include "fuzz/fuzz.hpp"

#include "grid/grid.hpp"

#include <geotex/cook.h>

#include <cmath>

namespace fuzz {

constexpr uint64_t MAX_NODES = 4096;

static void make_asset(const gtx_height_grid &grid, uint64_t how)
{
    Counted memory;
    const gtx_allocator hooks = memory.hooks();
    gtx_horizons_desc desc = {};
    desc.allocator = &hooks;
    desc.threads = 1;
    desc.tile = 16 + uint32_t(how & 31);
    desc.mips = 1 + uint32_t(how >> 5 & 3);
    desc.height_bits = how >> 7 & 1 ? 16 : 8;
    desc.lod_levels = (how >> 8 & 7) == 0 ? 1 : GTX_LOD_LEVELS_NONE;
    desc.one_surface = uint32_t(how >> 12 & 1);
    desc.depths = uint32_t(how >> 13 & 1);
    gtx_height_grid grids[2] = {grid, grid};
    grids[1].origin[0] += grid.spacing[0] * (grid.nx - 1);
    gtx_asset *asset = nullptr;
    gtx_horizons_result result;
    gtx_error error = {};
    if (gtx_horizons(grids, 1 + uint32_t(how >> 14 & 1), &desc, &asset, &result, &error))
        return REQUIRE(error.result == GTX_ERROR_LIMIT || error.result == GTX_ERROR_INPUT ||
                           error.result == GTX_ERROR_EMPTY || error.result == GTX_ERROR_MEMORY,
                       "horizons: %d, rule %u: %s", error.result, error.rule, error.message);
    round_trip(asset, true, "horizons");
    gtx_close(asset);
}

static void run(const uint8_t *data, size_t size, const char *name)
{
    const uint64_t how = choices(data, size);
    write_scratch(name, data, size);
    Counted memory;
    const gtx_allocator hooks = memory.hooks();
    gtx_height_grid_desc desc = {};
    desc.allocator = &hooks;
    desc.has_missing = uint32_t(how & 1);
    desc.range[1] = how & 14 ? 0 : 1;
    gtx_height_grid grid = {};
    gtx_error error = {};
    if (gtx_height_grid_read(scratch(name).c_str(), &desc, &grid, &error))
        return REQUIRE(error.result == GTX_ERROR_LIMIT || error.result == GTX_ERROR_INPUT ||
                           error.result == GTX_ERROR_READ || error.result == GTX_ERROR_MEMORY ||
                           error.result == GTX_ERROR_UNSUPPORTED ||
                           (error.result == GTX_ERROR_ARGUMENT && desc.range[1] != 0),
                       "grid: %d %s", error.result, error.message);
    for (uint64_t i = 0; i < uint64_t(grid.nx) * grid.ny; ++i)
        REQUIRE(!std::isinf(grid.values[i]), "value %g", grid.values[i]);
    if (uint64_t(grid.nx) * grid.ny <= MAX_NODES && (how >> 4) % 8 == 0)
        make_asset(grid, how >> 7);
    gtx_height_grid_free(&grid);
}

/* What is no grid would be tried as an image, which is a target of its own. */
void run_irap(const uint8_t *data, size_t size)
{
    const std::string_view text(reinterpret_cast<const char *>(data), size);
    if (gtx::is_irap_classic(text) || gtx::is_irap_binary(text))
        run(data, size, "a.irap");
}

void run_zmap(const uint8_t *data, size_t size)
{
    if (gtx::is_zmap({reinterpret_cast<const char *>(data), size}))
        run(data, size, "a.zmap");
}

void run_cps3(const uint8_t *data, size_t size)
{
    if (gtx::is_cps3({reinterpret_cast<const char *>(data), size}))
        run(data, size, "a.cps3");
}

/* The classic kinds; what reads HDF5 is another process. */
void run_netcdf(const uint8_t *data, size_t size)
{
    if (gtx::is_netcdf({reinterpret_cast<const char *>(data), size}))
        run(data, size, "a.nc");
}

void run_image(const uint8_t *data, size_t size) { run(data, size, "a.png"); }

} // namespace fuzz
