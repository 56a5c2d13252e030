/* Images as textures: their smaller levels, and looking into them. */
#include "mesh/material/texture.hpp"
#include "base/exact.h"

#include "mesh/material/srgb.hpp"

#include <algorithm>
#include <cmath>

namespace gtx {

using Value = std::array<float, 4>;

static Value value_of(const Rgba8 &c, Texels kind)
{
    constexpr float unit = 1.f / 255;
    if (kind == Texels::COLOR)
        return {srgb_to_linear(c.r), srgb_to_linear(c.g), srgb_to_linear(c.b), float(c.a) * unit};
    return {float(c.r) * unit, float(c.g) * unit, float(c.b) * unit, float(c.a) * unit};
}

static Rgba8 texel_of(const Value &v, Texels kind)
{
    auto plain = [](float x) { return uint8_t(std::clamp(x, 0.f, 1.f) * 255 + 0.5f); };
    if (kind == Texels::COLOR)
        return {linear_to_srgb(v[0]), linear_to_srgb(v[1]), linear_to_srgb(v[2]), plain(v[3])};
    return {plain(v[0]), plain(v[1]), plain(v[2]), plain(v[3])};
}

static void add(Value &sum, const Value &v, float weight)
{
    for (size_t k = 0; k < 4; ++k)
        sum[k] += weight * v[k];
}

/* ---- levels ---- */

namespace {
/* The texels of a row of `fine` that one of a row half as long stands for: two, or three where
 * the row is odd, by the lengths that they share. */
struct Taps {
    uint32_t first;
    int count;
    float weight[3];
};
} // namespace

static Taps taps_of(uint32_t at, uint32_t coarse, uint32_t fine)
{
    if (fine == 1)
        return {0, 1, {1}};
    if (fine % 2 == 0)
        return {2 * at, 2, {0.5f, 0.5f}};
    float n = float(fine), left = float(coarse - at), right = float(at + 1);
    return {2 * at, 3, {left / n, float(coarse) / n, right / n}};
}

static Image::Level halve(const Image::Level &fine, Texels kind)
{
    Image::Level out;
    out.width = std::max(fine.width / 2, 1u);
    out.height = std::max(fine.height / 2, 1u);
    out.texels.reserve(size_t(out.width) * out.height);
    for (uint32_t y = 0; y < out.height; ++y) {
        const Taps down = taps_of(y, out.height, fine.height);
        for (uint32_t x = 0; x < out.width; ++x) {
            const Taps across = taps_of(x, out.width, fine.width);
            Value sum = {0, 0, 0, 0};
            for (int j = 0; j < down.count; ++j) {
                const Rgba8 *row = &fine.texels[size_t(down.first + uint32_t(j)) * fine.width];
                for (int i = 0; i < across.count; ++i)
                    add(sum, value_of(row[across.first + uint32_t(i)], kind),
                        down.weight[j] * across.weight[i]);
            }
            out.texels.push_back(texel_of(sum, kind));
        }
    }
    return out;
}

Image make_image(uint32_t width, uint32_t height, Vector<Rgba8> texels, Texels kind)
{
    Image image;
    image.levels.push_back({width, height, std::move(texels)});
    while (image.levels.back().width > 1 || image.levels.back().height > 1) {
        Image::Level next = halve(image.levels.back(), kind);
        image.levels.push_back(std::move(next));
    }
    return image;
}

/* ---- looking ---- */

namespace {
/* The two texels beside a place along one axis, and how far it is from the first. */
struct Between {
    uint32_t at[2];
    float share;
};
} // namespace

static Between place(double u, uint32_t size, Wrap wrap)
{
    if (!std::isfinite(u))
        u = 0;
    if (wrap == Wrap::REPEAT) {
        u -= std::floor(u);
    } else if (wrap == Wrap::MIRROR) {
        u -= 2 * std::floor(u / 2);
        u = u > 1 ? 2 - u : u;
    }
    const double x = std::clamp(u, 0., 1.) * size - 0.5, first = std::floor(x);
    const int64_t last = int64_t(size) - 1, i = int64_t(first);
    auto index = [&](int64_t k) {
        if (wrap == Wrap::REPEAT)
            return uint32_t(k < 0 ? last : k > last ? 0 : k);
        return uint32_t(std::clamp<int64_t>(k, 0, last));
    };
    return {{index(i), index(i + 1)}, float(x - first)};
}

static Value sample_level(const Image::Level &level, const Wrap wrap[2], double u, double v,
                          Texels kind)
{
    const Between x = place(u, level.width, wrap[0]), y = place(v, level.height, wrap[1]);
    Value sum = {0, 0, 0, 0};
    for (int k = 0; k < 4; ++k) {
        int i = k % 2, j = k / 2;
        float weight = (i ? x.share : 1 - x.share) * (j ? y.share : 1 - y.share);
        add(sum, value_of(level.texels[size_t(y.at[j]) * level.width + x.at[i]], kind), weight);
    }
    return sum;
}

Value sample_image(const Image &image, const Wrap wrap[2], double u, double v, double side,
                   Texels kind)
{
    const size_t last = image.levels.size() - 1;
    const double depth = side > 1 ? std::min(gtx_log2(side), double(last)) : 0;
    const size_t level = size_t(depth);
    const float share = float(depth - double(level));
    Value fine = sample_level(image.levels[level], wrap, u, v, kind);
    if (!(share > 0))
        return fine;
    Value coarse = sample_level(image.levels[level + 1], wrap, u, v, kind), sum = {0, 0, 0, 0};
    add(sum, fine, 1 - share);
    add(sum, coarse, share);
    return sum;
}

} // namespace gtx
