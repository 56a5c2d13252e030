/* Debug views: a colour a patch, normals as colours, the boxes of patches. */
#include "cli/view/debug_views.hpp"

#include "asset/asset.h"

#include <algorithm>
#include <cmath>

namespace gtx {

using Color = std::array<uint8_t, 4>;

/* Hues a golden section apart: neighbours in number are far apart in colour. */
std::array<uint8_t, 3> patch_color(uint32_t index)
{
    const double hue = std::fmod(index * 0.6180339887498949, 1.0);
    const double strength = 0.55 + 0.1 * (index % 3);
    std::array<uint8_t, 3> out = {0, 0, 0};
    for (int k = 0; k < 3; ++k) {
        double away = std::fabs(std::fmod(6 * hue + 6 - 2 * k, 6.0) - 3);
        double share = std::clamp(away - 1, 0.0, 1.0);
        out[size_t(k)] = uint8_t(235 * (1 - strength * (1 - share)));
    }
    return out;
}

static Color normal_color(const float n[3])
{
    Color out = {0, 0, 0, 255};
    for (int k = 0; k < 3; ++k)
        out[size_t(k)] = uint8_t(std::lround(127.5f + 127.5f * std::clamp(n[k], -1.f, 1.f)));
    return out;
}

/* Fills a patch's rectangle of a colour map. */
static void paint(const gtx_asset *asset, const gtx_info &info, uint32_t index, uint32_t level,
                  DebugView view, Vector<uint8_t> &map)
{
    const gtx_patch &patch = gtx_patches(asset)[index];
    auto normals =
        static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_NORMAL, level, nullptr));
    const size_t width = info.page_width >> level, height = info.page_height >> level;
    const size_t x0 = patch.rect[0] >> level, y0 = patch.rect[1] >> level;
    const size_t x1 = x0 + (size_t(patch.rect[2]) >> level);
    const size_t y1 = y0 + (size_t(patch.rect[3]) >> level);
    const auto hue = patch_color(index);
    const Color flat = {hue[0], hue[1], hue[2], 255};
    float rows[3][3];
    gtx_normal_frame(&patch, rows);
    for (size_t y = y0; y < y1; ++y)
        for (size_t x = x0; x < x1; ++x) {
            const size_t texel = (patch.page * height + y) * width + x;
            Color color = flat;
            if (view == DebugView::NORMALS) {
                float local[3], n[3];
                gtx_decode_normal(normals + 2 * texel, local);
                for (int k = 0; k < 3; ++k)
                    n[k] = local[0] * rows[0][k] + local[1] * rows[1][k] + local[2] * rows[2][k];
                color = normal_color(n);
            }
            std::copy(color.begin(), color.end(), map.begin() + ptrdiff_t(4 * texel));
        }
}

AssetPointer recolor(const gtx_asset *asset, DebugView view)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    Vector<uint8_t> colors[GTX_MAX_MIPS], materials[GTX_MAX_MIPS];
    const uint8_t *normal[GTX_MAX_MIPS], *color[GTX_MAX_MIPS], *material[GTX_MAX_MIPS];
    for (uint32_t level = 0; level < info.mip_count; ++level) {
        size_t texels = gtx_page_texels(asset, level) * info.page_count;
        normal[level] =
            static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_NORMAL, level, nullptr));
        colors[level].resize(4 * texels);
        for (uint32_t i = 0; i < info.patch_count; ++i)
            paint(asset, info, i, level, view, colors[level]);
        color[level] = colors[level].data();
        if (view == DebugView::NORMALS) { /* unlit: a share of lighting of 0 */
            const uint8_t unlit[4] = {255, 255, 0, 0};
            for (size_t i = 0; i < texels; ++i)
                materials[level].insert(materials[level].end(), unlit, unlit + 4);
            material[level] = materials[level].data();
        }
    }
    gtx_asset_desc desc = {};
    desc.patches = gtx_patches(asset);
    desc.patch_count = info.patch_count;
    desc.page_count = info.page_count;
    desc.page_width = info.page_width;
    desc.page_height = info.page_height;
    desc.mip_count = info.mip_count;
    desc.height_bits = info.height_bits;
    desc.height = gtx_map_data(asset, GTX_MAP_HEIGHT, 0, nullptr);
    desc.trim = static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_TRIM, 0, nullptr));
    desc.normal = normal;
    desc.color = color;
    desc.material = view == DebugView::NORMALS ? material : nullptr;
    std::copy(info.bounds_min, info.bounds_min + 3, desc.bounds_min);
    std::copy(info.bounds_max, info.bounds_max + 3, desc.bounds_max);
    std::copy(info.anchor, info.anchor + 3, desc.anchor);
    Vector<gtx_lod_mesh> lod(info.lod_levels);
    for (uint32_t k = 0; k < info.lod_levels; ++k)
        gtx_get_lod_mesh(asset, k, &lod[k]);
    desc.lod = lod.data();
    desc.lod_levels = info.lod_levels;
    desc.unit = info.unit;
    desc.source_triangles = info.source_triangles;
    gtx_asset *out;
    gtx_error error;
    require_ok(gtx_create(&desc, &out, &error), error);
    return AssetPointer(out);
}

void recolor(Polygons &polygons, DebugView view)
{
    if (view != DebugView::NORMALS)
        return;
    polygons.has_materials = false;
    polygons.emissions.clear();
        for (gtx_polygon_vertex &v : polygons.vertices) {
            Color color = normal_color(v.normal);
            color[3] = 0; /* unlit */
            std::copy(color.begin(), color.end(), v.color);
        }
}

Polygons patch_boxes(const gtx_asset *asset)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    Polygons out;
    for (uint32_t i = 0; i < info.patch_count; ++i) {
        const gtx_patch &p = gtx_patches(asset)[i];
        const uint32_t first = uint32_t(out.vertices.size());
        const auto color = patch_color(i);
        for (uint32_t corner = 0; corner < 8; ++corner) { /* bits: along x, y, z */
            gtx_polygon_vertex v = {};
            for (int k = 0; k < 3; ++k) {
                v.position[k] = p.origin[k] + (corner & 1 ? p.extent_x * p.axis_x[k] : 0) +
                                (corner & 2 ? p.extent_y * p.axis_y[k] : 0) +
                                (corner & 4 ? p.extent_z * p.axis_z[k] : 0);
                v.color[k] = uint8_t(color[size_t(k)] / 2);
            }
            v.normal[2] = 1;
            out.vertices.push_back(v);
            for (uint32_t bit = 1; bit < 8; bit *= 2)
                if (!(corner & bit))
                    out.indices.insert(out.indices.end(), {first + corner, first + (corner | bit)});
        }
    }
    return out;
}

} // namespace gtx
