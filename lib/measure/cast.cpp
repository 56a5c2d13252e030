/* Renders assets with the ray query. */
#include "measure/cast.hpp"

#include "asset/asset.h"

#include <algorithm>

namespace gtx {

/* Steps of height within which a crossing from below is the edge of an overlap, not a leak. */
static const double LEAK_STEPS = 4;

static Vec3d anchor_of(const gtx_info &info)
{
    return {info.anchor[0], info.anchor[1], info.anchor[2]};
}

/* The box of all patches' boxes. */
static void bound(const gtx_patch *patches, const gtx_info &info, Vec3d &low, Vec3d &high)
{
    low = Vec3d(INFINITY, INFINITY, INFINITY);
    high = -low;
    const Vec3d anchor = anchor_of(info);
    for (uint32_t i = 0; i < info.patch_count; ++i) {
        const gtx_patch_frame frame = gtx_patch_frame_of(&patches[i], info.height_bits);
        const double steps[3] = {patches[i].rect[2] - 1., patches[i].rect[3] - 1.,
                                 gtx_height_steps(info.height_bits) + 1};
        for (int corner = 0; corner < 8; ++corner)
            for (int k = 0; k < 3; ++k) {
                double at = frame.origin[k] + anchor[k];
                for (int a = 0; a < 3; ++a)
                    at += corner >> a & 1 ? steps[a] * frame.axis[a][k] : 0;
                low[k] = std::min(low[k], at);
                high[k] = std::max(high[k], at);
            }
    }
}

AssetView::AssetView(const Vector<const gtx_asset *> &assets, uint32_t level, double max_error)
{
    for (const gtx_asset *asset : assets) {
        Part part = {};
        gtx_get_info(asset, &part.info);
        part.patches = gtx_patches(asset);
        part.color =
            static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_COLOR, 0, nullptr));
        bound(part.patches, part.info, part.low, part.high);
        gtx_caster_desc desc = {};
        desc.allocator = &asset->allocator;
        desc.level = level;
        desc.max_error = float(max_error);
        /* the allocator counts; cells take time */
        desc.limits.memory = desc.limits.cells = UINT64_MAX;
        gtx_caster *caster = nullptr;
        gtx_error error;
        require_ok(gtx_caster_create(asset, &desc, &caster, &error), error);
        part.caster.reset(caster);
        parts_.push_back(std::move(part));
    }
}

double AssetView::height_step(const ViewHit &hit) const
{
    return gtx_height_step(&patch_of(hit), parts_[hit.asset].info.height_bits);
}

double AssetView::texel(const ViewHit &hit) const
{
    const gtx_patch_frame frame =
        gtx_patch_frame_of(&patch_of(hit), parts_[hit.asset].info.height_bits);
    double longest = 0;
    for (int a = 0; a < 2; ++a) {
        const Vec3d side(frame.axis[a][0], frame.axis[a][1], frame.axis[a][2]);
        longest = std::max(longest, length(side));
    }
    return longest;
}

namespace {

/* The pixels that a box may be seen at, and how near, a margin for rounding included. */
struct Window {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, near = INFINITY;
    uint32_t part;

    Window(const View &view, const Vec3d &from, const Vec3d &to, uint32_t number) : part(number)
    {
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3d at = view.project({corner & 1 ? to.x : from.x, corner & 2 ? to.y : from.y,
                                           corner & 4 ? to.z : from.z});
            for (int k = 0; k < 2; ++k) {
                low[k] = std::min(low[k], at[k] - 2);
                high[k] = std::max(high[k], at[k] + 2);
            }
            near = std::min(near, at.z - 2 * view.pixel);
        }
    }
    bool holds(int axis, uint32_t pixel) const
    {
        return pixel + 0.5 >= low[axis] && pixel + 0.5 <= high[axis];
    }
};

} // namespace

/* The nearest hit of all assets at some pixels of a row. */
void AssetView::cast_nearest(const View &view, uint32_t j, const Vector<uint32_t> &pixels,
                             uint32_t flags, Vector<ViewHit> &hits) const
{
    Vector<gtx_ray> rays;
    Vector<gtx_hit> found;
    Vector<uint32_t> cast; /* places in `pixels` */
    ViewHit none = {};
    none.t = INFINITY;
    none.patch = NO_HIT;
    hits.assign(pixels.size(), none);
    Vector<Window> windows;
    for (uint32_t n = 0; n < parts_.size(); ++n) {
        windows.emplace_back(view, parts_[n].low, parts_[n].high, n);
        if (!windows.back().holds(1, j))
            windows.pop_back();
    }
    std::sort(windows.begin(), windows.end(), [](const Window &a, const Window &b) {
        return a.near != b.near ? a.near < b.near : a.part < b.part;
    });
    for (const Window &window : windows) { /* the nearest hide most of what is behind */
        const Part &part = parts_[window.part];
        const Vec3d anchor = anchor_of(part.info);
        rays.clear();
        cast.clear();
        for (uint32_t k = 0; k < pixels.size(); ++k) {
            if (!window.holds(0, pixels[k]) || window.near > double(hits[k].t))
                continue;
            const Vec3d from = view.at(pixels[k], j) - anchor;
            rays.push_back({{float(from.x), float(from.y), float(from.z)}, 0,
                            {float(-view.toward.x), float(-view.toward.y), float(-view.toward.z)},
                            std::isinf(hits[k].t) ? 0 : hits[k].t}); /* 0: without end */
            cast.push_back(k);
        }
        found.resize(rays.size());
        gtx_raycast(part.caster.get(), rays.data(), found.data(), rays.size(), flags);
        for (size_t k = 0; k < cast.size(); ++k)
            if (found[k].t < hits[cast[k]].t)
                hits[cast[k]] = {found[k], window.part};
    }
}

void AssetView::cast_row(const View &view, uint32_t j, Vector<ViewHit> &hits,
                         Vector<Crossing> &crossings) const
{
    Vector<uint32_t> pixels(view.size), again;
    for (uint32_t i = 0; i < view.size; ++i)
        pixels[i] = i;
    crossings.assign(view.size, Crossing::none);
    cast_nearest(view, j, pixels, GTX_RAY_TWO_SIDED, hits);
    for (uint32_t i = 0; i < view.size; ++i) {
        if (hits[i].patch == NO_HIT)
            continue;
        crossings[i] = Crossing::shown;
        if (hits[i].back && !(patch_of(hits[i]).flags & GTX_PATCH_TWO_SIDED))
            again.push_back(i);
    }
    /* Where the nearest crossing is not shown, what is shown lies behind it. */
    Vector<ViewHit> shown;
    cast_nearest(view, j, again, 0, shown);
    for (size_t k = 0; k < again.size(); ++k) {
        ViewHit &hit = hits[again[k]];
        if (!view.culls && !(shown[k].t - hit.t <= LEAK_STEPS * height_step(hit)))
            crossings[again[k]] = Crossing::leak;
        hit = shown[k];
    }
}

/* As the shaders do it (shaders/geotex_view.glsl: gtx_from_behind). */
static Vec3d from_behind(const Vec3d &normal, const Vec3d &ray)
{
    constexpr double RIM = 0.1;
    const double away = std::max(dot(normal, ray), 0.), t = std::min(away / RIM, 1.);
    const double turned = t * t * (3 - 2 * t);
    return (normal - ray * (2 * away)) * (1 - turned) - normal * turned;
}

Fragment AssetView::fragment(const ViewHit &hit, const View &view) const
{
    const Part &part = parts_[hit.asset];
    const Vec3d normal(hit.normal[0], hit.normal[1], hit.normal[2]);
    Fragment fragment = {hit.back ? from_behind(normal, -view.toward) : normal, {255, 255, 255}};
    if (!part.color)
        return fragment;
    const gtx_patch &patch = patch_of(hit);
    uint32_t i = std::min(uint32_t(hit.x), patch.rect[2] - 2u);
    uint32_t j = std::min(uint32_t(hit.y), patch.rect[3] - 2u);
    double u = hit.x - i, v = hit.y - j;
    const double weight[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    size_t row = size_t(patch.page) * part.info.page_height + patch.rect[1] + j;
    const uint8_t *texel = part.color + 4 * (row * part.info.page_width + patch.rect[0] + i);
    const uint8_t *next = texel + 4 * size_t(part.info.page_width);
    for (int a = 0; a < 3; ++a)
        fragment.color[a] = weight[0] * texel[a] + weight[1] * texel[4 + a] + weight[2] * next[a] +
                            weight[3] * next[4 + a];
    return fragment;
}

} // namespace gtx
