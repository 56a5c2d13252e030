/* The asset's maps as images whose empty texels are filled. */
#include "export/export.hpp"

#include <algorithm>

namespace gtx {

PageImages::PageImages(const gtx_info &info, unsigned level, std::array<uint8_t, 3> fill)
    : width(info.page_width >> level), height(info.page_height >> level), pages(info.page_count)
{
    texels.resize(3 * size_t(width) * height * pages);
    for (size_t i = 0; i < texels.size(); i += 3)
        std::copy_n(fill.data(), 3, &texels[i]);
}

Vector<uint32_t> nearest_of(const Vector<uint8_t> &valued, uint32_t width, uint32_t height)
{
    constexpr uint32_t NONE = 0xffffffffu;
    Vector<uint32_t> nearest(valued.size(), NONE), queue;
    queue.reserve(valued.size());
    for (uint32_t i = 0; i < valued.size(); ++i)
        if (valued[i]) {
            nearest[i] = i;
            queue.push_back(i);
        }
    if (queue.empty())
        return {};
    for (size_t done = 0; done < queue.size(); ++done) {
        const uint32_t i = queue[done], x = i % width, y = i / width;
        auto reach = [&](bool inside, uint32_t j) {
            if (inside && nearest[j] == NONE) {
                nearest[j] = nearest[i];
                queue.push_back(j);
            }
        };
        reach(x > 0, i - 1);
        reach(x + 1 < width, i + 1);
        reach(y > 0, i - width);
        reach(y + 1 < height, i + width);
    }
    return nearest;
}

/* 1 where a texel of the level covers one with a height. */
static Vector<uint8_t> occupied(const gtx_asset *asset, const gtx_patch &patch, unsigned level)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    const auto *codes =
        static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_HEIGHT, 0, nullptr));
    const size_t bytes = info.height_bits / 8;
    const uint32_t width = patch.rect[2], height = patch.rect[3];
    Vector<uint8_t> out(size_t(width >> level) * (height >> level));
    for (uint32_t y = 0; y < height; ++y) {
        const size_t row = (size_t(patch.page) * info.page_height + patch.rect[1] + y) *
                               info.page_width + patch.rect[0];
        for (uint32_t x = 0; x < width; ++x) {
            const uint8_t *code = codes + (row + x) * bytes;
            out[size_t(y >> level) * (width >> level) + (x >> level)] |=
                uint8_t(code[0] != 0 || (bytes == 2 && code[1] != 0));
        }
    }
    return out;
}

Vector<uint32_t> nearest_texels(const gtx_asset *asset, uint32_t number, unsigned level)
{
    const gtx_patch &patch = gtx_patches(asset)[number];
    return nearest_of(occupied(asset, patch, level), patch.rect[2] >> level,
                      patch.rect[3] >> level);
}

/* ---- colour, material and emission ---- */

namespace {

struct MapCopy {
    const gtx_info &info;
    const uint8_t *map;            /* null: there is none */
    size_t channels;
    PageImages &out;

    const uint8_t *texel(const gtx_patch &patch, uint32_t x, uint32_t y) const
    {
        const size_t row = size_t(patch.page) * info.page_height + patch.rect[1] + y;
        return map + (row * info.page_width + patch.rect[0] + x) * channels;
    }
    void copy(const gtx_patch &patch, const Vector<uint32_t> &nearest) const
    {
        const uint32_t width = patch.rect[2];
        for (uint32_t i = 0; map && i < nearest.size(); ++i)
            std::copy_n(texel(patch, nearest[i] % width, nearest[i] / width), 3,
                        out.texel(patch.page, patch.rect[0] + i % width,
                                  patch.rect[1] + i / width));
    }
};

} // namespace

/* A map whose occupied texels are all alike needs no image. */
static void find_constant(const gtx_asset *asset, PageImages &image)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    bool any = false;
    image.constant = true;
    for (uint32_t p = 0; p < info.patch_count && image.constant; ++p) {
        const gtx_patch &patch = gtx_patches(asset)[p];
        for (uint32_t i = 0; i < uint32_t(patch.rect[2]) * patch.rect[3] && image.constant; ++i) {
            const uint8_t *texel = image.texel(patch.page, patch.rect[0] + i % patch.rect[2],
                                               patch.rect[1] + i / patch.rect[2]);
            if (!any)
                std::copy_n(texel, 3, image.first.data());
            any = true;
            image.constant = std::equal(texel, texel + 3, image.first.data());
        }
    }
}

/* Between rectangles: what far mip levels mix with theirs. */
static std::array<uint8_t, 3> mean_of(const uint8_t *map, size_t texels, size_t channels)
{
    uint64_t sum[3] = {};
    for (size_t i = 0; i < texels; ++i)
        for (size_t k = 0; k < 3; ++k)
            sum[k] += map[i * channels + k];
    std::array<uint8_t, 3> out;
    for (size_t k = 0; k < 3; ++k)
        out[k] = uint8_t((sum[k] + texels / 2) / texels);
    return out;
}

SurfaceImages surface_images(const gtx_asset *asset, Task &task)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    SurfaceImages out;
    const size_t texels = size_t(info.page_width) * info.page_height * info.page_count;
    const MapCopy maps[] = {
        {info, static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_COLOR, 0, nullptr)), 4,
         out.color},
        {info, static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_MATERIAL, 0, nullptr)), 4,
         out.material},
        {info, static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_EMISSION, 0, nullptr)), 3,
         out.emission}};
    for (const MapCopy &m : maps)
        if (m.map)
            m.out = PageImages(info, 0, mean_of(m.map, texels, m.channels));
    Vector<uint8_t> lit(info.patch_count), unlit(info.patch_count);
    task.parallel(maps[0].map || maps[1].map || maps[2].map ? info.patch_count : 0, [&](size_t p) {
        const gtx_patch &patch = gtx_patches(asset)[p];
        const Vector<uint32_t> nearest = nearest_texels(asset, uint32_t(p), 0);
        for (const MapCopy &m : maps)
            m.copy(patch, nearest);
        for (uint32_t i = 0; maps[1].map && i < nearest.size(); ++i) {
            const uint32_t x = nearest[i] % patch.rect[2], y = nearest[i] / patch.rect[2];
            (maps[1].texel(patch, x, y)[3] ? lit : unlit)[p] = 1;
        }
    });
    for (const MapCopy &m : maps)
        if (m.map)
            find_constant(asset, m.out);
    out.material.constant &= out.material.first[0] == 255; /* occlusion has no factor */
    const bool any_unlit = std::count(unlit.begin(), unlit.end(), 1) > 0;
    const bool any_lit = std::count(lit.begin(), lit.end(), 1) > 0;
    out.unlit = any_unlit && !any_lit;
    out.partly_unlit = any_unlit && any_lit;
    return out;
}

} // namespace gtx
