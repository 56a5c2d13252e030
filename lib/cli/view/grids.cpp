/* Height grids as assets to show; guesses what their files leave open, and says so. */
#include "cli/view/scene.hpp"

#include <geotex/grid.h>

#include <algorithm>
#include <cmath>

namespace gtx {

struct ReadGrid : gtx_height_grid {
    ReadGrid() : gtx_height_grid() {}
    ReadGrid(const ReadGrid &) = delete;
    ~ReadGrid() { gtx_height_grid_free(this); }
};

/* Pixels are no metres: heights that would be spikes rise by an eighth of the width. */
static double vertical_of(const gtx_height_grid &grid)
{
    constexpr double SHARE = 0.125;
    float low = INFINITY, high = -INFINITY;
    for (size_t k = 0; k < size_t(grid.nx) * grid.ny; ++k) {
        low = std::fmin(low, grid.values[k]);
        high = std::fmax(high, grid.values[k]);
    }
    const double width = SHARE * std::max(grid.nx, grid.ny);
    return grid.unplaced && high > low && double(high - low) > width ? width / double(high - low)
                                                                     : 1;
}

AssetPointer asset_of_grid(const std::string &path, gtx_progress_fn progress, void *user,
                           const WarnFn &warn)
{
    ReadGrid grid;
    gtx_error error;
    gtx_height_grid_desc reading = {};
    reading.limits = cli_limits;
    require_ok(gtx_height_grid_read(path.c_str(), &reading, &grid, &error), error);
    if (grid.in_degrees) {
        const double middle = grid.origin[1] + grid.spacing[1] * (grid.ny - 1) / 2;
        require_ok(gtx_height_grid_to_metres(&grid, middle, &error), error);
        warn(GTX_WARNING_LOCAL_METRES, "degrees are shown as metres at the grid's middle");
    }
    gtx_horizons_desc desc = {};
    desc.vertical = vertical_of(grid);
    desc.progress = progress;
    desc.progress_user = user;
    desc.limits = cli_limits;
    if (desc.vertical != 1)
        warn(GTX_WARNING_NO_PLACE, "it tells no place: heights are shown as an eighth of its "
                                 "width (gtx horizons --spacing, --vertical)");
    gtx_asset *asset;
    require_ok(gtx_horizons(&grid, 1, &desc, &asset, nullptr, &error), error);
    return AssetPointer(asset);
}

} // namespace gtx
