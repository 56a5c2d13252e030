/* Renders an asset with the ray query. */
#include "measure/cast.hpp"

#include "asset/asset.h"

#include <algorithm>

namespace gtx {

/* Steps of height within which a crossing from below is the edge of an overlap, not a leak. */
static const double LEAK_STEPS = 4;

AssetView::AssetView(const gtx_asset *asset, uint32_t level, double max_error)
    : patches_(gtx_patches(asset)),
      color_(static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_COLOR, 0, nullptr)))
{
    gtx_get_info(asset, &info_);
    gtx_caster_desc desc = {};
    desc.allocator = &asset->allocator;
    desc.level = level;
    desc.max_error = float(max_error);
    desc.limits.memory = desc.limits.cells = UINT64_MAX; /* the allocator counts; cells take time */
    gtx_caster *caster = nullptr;
    gtx_error error;
    require_ok(gtx_caster_create(asset, &desc, &caster, &error), error);
    caster_.reset(caster);
}

double AssetView::height_step(uint32_t patch) const
{
    return gtx_height_step(&patches_[patch], info_.height_bits);
}

void AssetView::cast_row(const View &view, uint32_t j, Vector<gtx_hit> &hits,
                         Vector<Crossing> &crossings) const
{
    Vector<gtx_ray> rays(view.size), again;
    Vector<uint32_t> pixel;
    const Vec3d anchor(info_.anchor[0], info_.anchor[1], info_.anchor[2]);
    for (uint32_t i = 0; i < view.size; ++i) {
        Vec3d origin = view.at(i, j) - anchor;
        rays[i] = gtx_ray{{float(origin.x), float(origin.y), float(origin.z)}, 0,
                          {float(-view.toward.x), float(-view.toward.y), float(-view.toward.z)}, 0};
    }
    hits.resize(view.size);
    crossings.assign(view.size, Crossing::none);
    gtx_raycast(caster_.get(), rays.data(), hits.data(), rays.size(), GTX_RAY_TWO_SIDED);
    for (uint32_t i = 0; i < view.size; ++i) {
        if (hits[i].patch == NO_HIT)
            continue;
        crossings[i] = Crossing::shown;
        if (hits[i].back && !(patches_[hits[i].patch].flags & GTX_PATCH_TWO_SIDED)) {
            again.push_back(rays[i]);
            pixel.push_back(i);
        }
    }
    /* Where the nearest crossing is not shown, what is shown lies behind it. */
    Vector<gtx_hit> shown(again.size());
    gtx_raycast(caster_.get(), again.data(), shown.data(), again.size(), 0);
    for (size_t k = 0; k < again.size(); ++k) {
        gtx_hit &hit = hits[pixel[k]];
        if (!(shown[k].t - hit.t <= LEAK_STEPS * height_step(hit.patch)))
            crossings[pixel[k]] = Crossing::leak;
        hit = shown[k];
    }
}

Fragment AssetView::fragment(const gtx_hit &hit) const
{
    double side = hit.back ? -1 : 1;
    Fragment fragment = {Vec3d(hit.normal[0], hit.normal[1], hit.normal[2]) * side,
                         {255, 255, 255}};
    if (!color_)
        return fragment;
    const gtx_patch &patch = patches_[hit.patch];
    uint32_t i = std::min(uint32_t(hit.x), patch.rect[2] - 2u);
    uint32_t j = std::min(uint32_t(hit.y), patch.rect[3] - 2u);
    double u = hit.x - i, v = hit.y - j;
    const double weight[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    size_t row = size_t(patch.page) * info_.page_height + patch.rect[1] + j;
    const uint8_t *texel = color_ + 4 * (row * info_.page_width + patch.rect[0] + i);
    const uint8_t *next = texel + 4 * size_t(info_.page_width);
    for (int a = 0; a < 3; ++a)
        fragment.color[a] = weight[0] * texel[a] + weight[1] * texel[4 + a] + weight[2] * next[a] +
                            weight[3] * next[4 + a];
    return fragment;
}

} // namespace gtx
