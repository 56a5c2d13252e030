/* Maps and LOD mesh -> an asset; the LOD mesh of an asset without a mesh, behind the C API. */
#include "cook/assemble.hpp"

#include "bake/lod_normals.hpp"
#include "cook/guard.hpp"
#include "cook/options.hpp"

#include "base/alloc.h"

#include <geotex/cook.h>

#include <algorithm>
#include <cmath>

namespace gtx {

static Vector<const uint8_t *> level_pointers(const Vector<Vector<uint8_t>> &levels)
{
    Vector<const uint8_t *> pointers;
    for (const auto &level : levels)
        pointers.push_back(level.data());
    return pointers;
}

Asset assemble(const Maps &maps, const Vector<LodLevel> &lod, const AssetFacts &facts)
{
    const Vector<const uint8_t *> normal = level_pointers(maps.normal),
                                       color = level_pointers(maps.color),
                                       material = level_pointers(maps.material),
                                       emission = level_pointers(maps.emission);
    Vector<gtx_lod_mesh> levels;
    for (const LodLevel &level : lod) {
        levels.push_back(level.mesh());
        put_lod_normals(level.normals, levels.back());
    }

    gtx_asset_desc desc = {};
    desc.patches = maps.patches.data();
    desc.patch_count = uint32_t(maps.patches.size());
    desc.page_count = maps.page_count;
    desc.page_width = maps.page_width;
    desc.page_height = maps.page_height;
    desc.mip_count = maps.mip_count;
    desc.height_bits = maps.height_bits;
    desc.height = maps.height.data();
    desc.trim = maps.trim.data();
    desc.normal = normal.data();
    desc.color = color.empty() ? nullptr : color.data();
    desc.material = material.empty() ? nullptr : material.data();
    desc.emission = emission.empty() ? nullptr : emission.data();
    desc.emission_scale = maps.emission_scale;
    desc.lod = levels.data();
    desc.lod_levels = uint32_t(levels.size());
    desc.meta = facts.meta.empty() ? nullptr : facts.meta.data();
    desc.meta_size = facts.meta.size();
    std::copy_n(maps.bounds_min, 3, desc.bounds_min);
    std::copy_n(maps.bounds_max, 3, desc.bounds_max);
    std::copy_n(maps.anchor, 3, desc.anchor);
    desc.unit = facts.unit;
    desc.source_triangles = facts.source_triangles;
    desc.allocator = &facts.allocator;

    gtx_asset *asset = nullptr;
    gtx_error error;
    gtx_result result = gtx_create(&desc, &asset, &error);
    if (result == GTX_ERROR_CORRUPT) /* what is baked must be valid, whatever the model */
        throw Error(GTX_ERROR_INTERNAL, error.message);
    require_ok(result, error);
    return Asset(asset, gtx_close);
}

/* The maps of an asset; its charts are its patches. */
static Maps maps_of(const gtx_asset *asset)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    Maps maps;
    maps.patches.assign(gtx_patches(asset), gtx_patches(asset) + info.patch_count);
    for (uint32_t p = 0; p < info.patch_count; ++p)
        maps.charts.push_back(p);
    maps.page_count = info.page_count;
    maps.page_width = info.page_width;
    maps.page_height = info.page_height;
    maps.mip_count = info.mip_count;
    maps.height_bits = info.height_bits;
    auto bytes = [&](gtx_map map, uint32_t level) {
        size_t size = 0;
        const auto *data = static_cast<const uint8_t *>(gtx_map_data(asset, map, level, &size));
        return data ? Vector<uint8_t>(data, data + size) : Vector<uint8_t>();
    };
    maps.height = bytes(GTX_MAP_HEIGHT, 0);
    maps.trim = bytes(GTX_MAP_TRIM, 0);
    for (uint32_t k = 0; k < info.mip_count; ++k) {
        maps.normal.push_back(bytes(GTX_MAP_NORMAL, k));
        if (info.has_color)
            maps.color.push_back(bytes(GTX_MAP_COLOR, k));
        if (info.has_material)
            maps.material.push_back(bytes(GTX_MAP_MATERIAL, k));
        if (info.has_emission)
            maps.emission.push_back(bytes(GTX_MAP_EMISSION, k));
    }
    maps.emission_scale = info.emission_scale;
    std::copy_n(info.anchor, 3, maps.anchor);
    std::copy_n(info.bounds_min, 3, maps.bounds_min);
    std::copy_n(info.bounds_max, 3, maps.bounds_max);
    return maps;
}

/* Of heights and trim alone: the others are in proportion. */
static uint64_t map_bytes(const gtx_info &info)
{
    return uint64_t(info.page_count) * info.page_width * info.page_height *
           (1 + info.height_bits / 8);
}

/* Places on a patch so far away are not told apart, not even by doubles. */
static void require_near(const Vector<gtx_patch> &patches)
{
    constexpr double MAX_AWAY = 1e9; /* times its size */
    for (size_t p = 0; p < patches.size(); ++p)
        for (float at : patches[p].origin)
            if (std::fabs(at) > MAX_AWAY * std::min(patches[p].extent_x, patches[p].extent_y))
                throw Error(GTX_ERROR_LIMIT, "patch " + std::to_string(p) + " lies more than 10^9 "
                            "times its size away from the anchor");
}

static Asset with_lod(const gtx_asset *asset, const gtx_lod_desc &desc)
{
    require_zeroed(desc.reserved);
    require_limits(desc.limits);
    require_argument(desc.levels <= MAX_LOD_LEVELS, "levels is at most 5");
    require_argument(desc.threads <= 1024, "threads is at most 1024");
    gtx_info info;
    gtx_get_info(asset, &info);
    Task task(desc.threads, desc.progress, desc.progress_user, {"lod"}, {1}, desc.limits);
    task.limits.read("", map_bytes(info));
    const Maps maps = maps_of(asset);
    require_near(maps.patches);
    LodSource source = lod_source(maps, task);
    source.model = info.source_triangles;
    size_t size;
    const char *meta = gtx_meta(asset, &size);
    const AssetFacts facts = {meta ? std::string(meta, size) : std::string(), info.unit,
                              info.source_triangles, gtx_allocator_or_default(desc.allocator)};
    return assemble(maps, make_lod(source, maps, desc.levels ? desc.levels : MAX_LOD_LEVELS,
                                   task), facts);
}

} // namespace gtx

gtx_result gtx_cook_lod_meshes(const gtx_asset *asset, const gtx_lod_desc *desc, gtx_asset **out,
                               gtx_error *error)
{
    return gtx::guard(error, [&] {
        gtx::require_argument(asset && out, "gtx_cook_lod_meshes needs an asset and a result");
        *out = gtx::with_lod(asset, desc ? *desc : gtx_lod_desc{}).release();
    });
}
