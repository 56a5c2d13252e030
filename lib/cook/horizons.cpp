/* Height grids -> an asset (paper, section 6.2), behind the C API. */
#include "cook/assemble.hpp"
#include "cook/grids.hpp"
#include "cook/guard.hpp"
#include "cook/options.hpp"
#include "cook/report.hpp"

#include "bake/tiles.hpp"
#include "base/alloc.h"

#include <geotex/cook.h>

#include <algorithm>
#include <cstring>
#include <set>

namespace gtx {

/* Grey: a colour of none of the maps. */
constexpr std::array<uint8_t, 3> NO_PROPERTY = {128, 128, 128};

static ColorMap map_of(const gtx_colors &colors)
{
    return number_of(colors) == GTX_COLORS_RAINBOW ? ColorMap::RAINBOW : ColorMap::VIRIDIS;
}

/* ---- making ---- */

/* Returns the number of nodes. */
static uint64_t check(const gtx_height_grid *grids, uint32_t count, const gtx_horizons_desc &desc)
{
    uint64_t nodes = 0;
    require_zeroed(desc.reserved);
    require_limits(desc.limits);
    require_argument(count > 0 && count <= 4096, "there are 1 to 4096 grids");
    require_argument(number_of(desc.colors) <= GTX_COLORS_NONE, "unknown colours");
    require_argument(desc.depths <= 1, "depths is 0 or 1");
    require_argument(desc.one_surface <= 1, "one_surface is 0 or 1");
    require_argument(desc.vertical >= 0 && desc.vertical < 1e9, "vertical is a positive number");
    require_argument(std::isfinite(desc.color_range[0]) && std::isfinite(desc.color_range[1]),
                     "color_range is two finite numbers");
    require_argument(!desc.tile || (desc.tile >= 16 && desc.tile <= 512), "tile is 16 to 512");
    require_argument(!desc.height_bits || desc.height_bits == 8 || desc.height_bits == 16,
                     "height_bits is 8 or 16");
    require_argument(desc.mips <= 8, "mips is 1 to 8");
    require_argument(is_lod_levels(desc.lod_levels),
                     "lod_levels is 0 to 5, or GTX_LOD_LEVELS_NONE");
    require_argument(desc.threads <= 1024, "threads is at most 1024");
    require_argument(desc.unit >= 0 && std::isfinite(desc.unit), "unit is a positive number");
    for (uint32_t n = 0; n < count; ++n) {
        const gtx_height_grid &g = grids[n];
        const std::string name = "grid " + std::to_string(n);
        require_placed(g);
        if (g.in_degrees)
            throw Error(GTX_ERROR_INPUT, name + IN_DEGREES +
                                             ", or say how far its nodes are apart "
                                             "(--spacing)");
        if (g.nx < 2 || g.ny < 2)
            throw Error(GTX_ERROR_INPUT, name + " has " + std::to_string(g.nx) + " x " +
                                             std::to_string(g.ny) +
                                             " nodes, and a surface takes 2 x 2");
        nodes += uint64_t(g.nx) * g.ny;
        if (!desc.one_surface && (g.nx != grids[0].nx || g.ny != grids[0].ny))
            throw Error(GTX_ERROR_INPUT,
                        name + " has " + std::to_string(g.nx) + " x " + std::to_string(g.ny) +
                            " nodes, the first one " + std::to_string(grids[0].nx) + " x " +
                            std::to_string(grids[0].ny));
        require_argument(!desc.one_surface || !g.property == !grids[0].property,
                         "of the parts of one surface some have a property and some do not");
    }
    return nodes;
}

/* The surfaces, and what each is coloured by: an empty grid stands for its heights. */
struct Surfaces {
    Vector<HeightGrid> heights, properties;
    SharedNodes shared;

    Surfaces(const gtx_height_grid *grids, uint32_t count, bool as_one, const Limits &limits)
    {
        for (uint32_t n = 0; n < count; ++n) {
            heights.push_back(lattice(grids[n], grids[n].values));
            properties.push_back(grids[n].property ? lattice(grids[n], grids[n].property)
                                                   : HeightGrid());
        }
        if (!as_one)
            return;
        heights = {mosaic(heights, limits, &shared)};
        properties = {grids[0].property ? mosaic(properties, limits) : HeightGrid()};
    }
    const Vector<float> &coloured(size_t n) const
    {
        return properties[n].values.empty() ? heights[n].values : properties[n].values;
    }
};

/* Pairs are looked at among the first so many, which takes a moment. */
constexpr size_t MAX_PAIRED = 64;

static void find_mistakes(const Surfaces &surfaces, gtx_horizons_result &out)
{
    const Vector<HeightGrid> &grids = surfaces.heights;
    out.shared = surfaces.shared.count;
    out.differing = surfaces.shared.differing;
    out.difference = surfaces.shared.difference;
    for (size_t a = 0; a < std::min(grids.size(), MAX_PAIRED) && !out.alike[1]; ++a)
        for (size_t b = a + 1; b < std::min(grids.size(), MAX_PAIRED) && !out.alike[1]; ++b)
            if (are_alike(grids[a], grids[b])) {
                out.alike[0] = uint32_t(a);
                out.alike[1] = uint32_t(b);
            }
    for (size_t a = 0; a + 1 < grids.size(); ++a)
        out.crossings += count_crossings(grids[a], grids[a + 1]);
}

static void find_color_range(const Surfaces &surfaces, const gtx_horizons_desc &desc,
                             double range[2])
{
    std::copy_n(desc.color_range, 2, range);
    if (range[0] != 0 || range[1] != 0)
        return;
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (size_t n = 0; n < surfaces.heights.size(); ++n)
        for (float value : surfaces.coloured(n))
            if (!std::isnan(value)) {
                range[0] = std::min(range[0], double(value));
                range[1] = std::max(range[1], double(value));
            }
    if (range[0] > range[1])
        range[0] = range[1] = 0;
}

static Vector<std::array<uint8_t, 3>> colors_of(const Vector<float> &values,
                                                ColorMap map, const double range[2])
{
    Vector<std::array<uint8_t, 3>> colors;
    colors.reserve(values.size());
    const double size = range[1] - range[0];
    for (float value : values)
        colors.push_back(std::isnan(value) ? NO_PROPERTY
                         : size != 0       ? color_of(map, (value - range[0]) / size)
                                           : color_of(map, 0.5));
    return colors;
}

/* Of all grids that have some, in ascending order; none where there are more than a legend has room
 * for. */
static std::set<float> categories_of(const Surfaces &surfaces)
{
    constexpr size_t MAX_CATEGORIES = 64;
    std::set<float> out;
    for (size_t n = 0; n < surfaces.heights.size(); ++n)
        if (surfaces.heights[n].has_categories)
            for (float value : surfaces.coloured(n)) {
                if (!std::isnan(value))
                    out.insert(value);
                if (out.size() > MAX_CATEGORIES)
                    return {};
            }
    return out;
}

static TileOptions options_of(const gtx_horizons_desc &desc)
{
    TileOptions options;
    if (desc.height_bits)
        options.bake.height_bits = desc.height_bits;
    if (desc.mips)
        options.bake.mips = desc.mips;
    if (desc.tile)
        options.tile = desc.tile;
    options.vertical = (desc.vertical > 0 ? desc.vertical : 1) * (desc.depths ? -1 : 1);
    return options;
}

static std::string meta_of(const gtx_horizons_desc &desc, const Surfaces &surfaces,
                           const double range[2], const gtx_allocator &allocator)
{
    Json json(allocator);
    gtx_json_begin_object(&json, nullptr);
    gtx_json_string(&json, "generator", "geotex horizons");
    if (number_of(desc.colors) != GTX_COLORS_NONE) {
        gtx_json_string(&json, "colors",
                        map_of(desc.colors) == ColorMap::RAINBOW ? "rainbow" : "viridis");
        gtx_json_number(&json, "color_low", range[0]);
        gtx_json_number(&json, "color_high", range[1]);
        if (desc.property_name)
            gtx_json_string(&json, "property", desc.property_name);
        const std::set<float> categories = categories_of(surfaces);
        if (!categories.empty()) {
            gtx_json_begin_array(&json, "categories");
            for (float value : categories)
                gtx_json_number(&json, nullptr, double(value));
            gtx_json_end_array(&json);
        }
    }
    gtx_json_number(&json, "vertical", desc.vertical > 0 ? desc.vertical : 1);
    gtx_json_end_object(&json);
    if (json.failed)
        throw std::bad_alloc();
    return std::string(json.text, json.size);
}

/* The values are in memory already, and the caller's own. */
static gtx_limits limits_of(const gtx_horizons_desc &desc)
{
    gtx_limits limits = desc.limits;
    if (!limits.texels)
        limits.texels = uint64_t(1) << 28;
    return limits;
}

static Asset make_horizons(const gtx_height_grid *grids, uint32_t count,
                           const gtx_horizons_desc &desc, gtx_horizons_result *result)
{
    const uint64_t nodes = check(grids, count, desc);
    const unsigned lod_levels = lod_levels_of(desc.lod_levels);
    const float lod = lod_levels ? 200 : 0;
    Task task(desc.threads, desc.progress, desc.progress_user, {"bake", "pack", "lod", "write"},
              {35, 3, lod, 2}, limits_of(desc));
    task.limits.require(GTX_LIMITED_TEXELS, "the grids", nodes);
    task.limits.read("", nodes * sizeof(float));
    const Surfaces surfaces(grids, count, desc.one_surface, task.limits);
    double range[2] = {0, 0};
    Vector<GridLayer> layers;
    if (number_of(desc.colors) != GTX_COLORS_NONE)
        find_color_range(surfaces, desc, range);
    for (size_t n = 0; n < surfaces.heights.size(); ++n) {
        layers.push_back({&surfaces.heights[n], {}});
        if (number_of(desc.colors) != GTX_COLORS_NONE)
            layers[n].colors = colors_of(surfaces.coloured(n), map_of(desc.colors), range);
    }
    TileReport report;
    const Maps maps = bake_tiles(layers, options_of(desc), report, task);
    Vector<LodLevel> levels;
    if (lod_levels)
        levels = make_lod(lod_source(maps, task), maps, lod_levels, task);
    task.begin("write");
    const gtx_allocator allocator = gtx_allocator_or_default(desc.allocator);
    Asset asset = assemble(maps, levels, {meta_of(desc, surfaces, range, allocator),
                                          desc.unit > 0 ? desc.unit : 1, report.triangles,
                                          allocator});
    if (result) {
        *result = {};
        result->nodes = report.nodes;
        result->triangles = report.triangles;
        result->patches = uint32_t(maps.patches.size());
        result->height_rms = report.rms;
        result->height_max = report.max;
        std::copy_n(range, 2, result->color_range);
        find_mistakes(surfaces, *result);
    }
    return asset;
}

} // namespace gtx

void gtx_color(gtx_colors colors, double value, uint8_t rgb[3])
{
    const std::array<uint8_t, 3> color = gtx::color_of(gtx::map_of(colors), value);
    std::copy(color.begin(), color.end(), rgb);
}

gtx_result gtx_horizons(const gtx_height_grid *grids, uint32_t count, const gtx_horizons_desc *desc,
                        gtx_asset **out, gtx_horizons_result *result, gtx_error *error)
{
    return gtx::guard(error, [&] {
        gtx::require_argument(grids && out, "gtx_horizons needs grids and a result");
        *out = gtx::make_horizons(grids, count, desc ? *desc : gtx_horizons_desc{}, result)
                   .release();
    });
}
