/* Images that are not used as a material's textures are: glossiness, heights, opacity. */
#include "mesh/import/image_use.hpp"

#include "mesh/import/import.hpp"

#include <algorithm>
#include <cstdlib>

namespace gtx {

void make_rough(float glossiness, Vector<Rgba8> &texels)
{
    for (Rgba8 &c : texels)
        c = {255, to_byte(1 - double(glossiness) * c.a / 255), 0, 255};
}

/* But for what a lossy codec makes of grey. */
static bool is_grey(const Rgba8 &c)
{
    constexpr int NOISE = 8;
    return std::abs(c.r - c.g) <= NOISE && std::abs(c.g - c.b) <= NOISE;
}

/* Normals are coded as glTF has them: (n + 1) / 2, green upwards. */
static Rgba8 normal_code(Vec3d n)
{
    n = normalize(n);
    return {to_byte((n.x + 1) / 2), to_byte((n.y + 1) / 2), to_byte((n.z + 1) / 2), 255};
}

void make_normals(float scale, uint32_t width, uint32_t height, Vector<Rgba8> &texels)
{
    if (!std::all_of(texels.begin(), texels.end(), is_grey)) {
        for (Rgba8 &c : texels)
            if (scale != 1)
                c = normal_code({scale * (2. * c.r / 255 - 1), scale * (2. * c.g / 255 - 1),
                                 std::max(2. * c.b / 255 - 1, 1e-3)});
        return;
    }
    Vector<uint8_t> heights(texels.size());
    for (size_t i = 0; i < texels.size(); ++i)
        heights[i] = texels[i].r;
    for (uint32_t y = 0; y < height; ++y) {
        const uint8_t *rows[3];
        for (uint32_t k = 0; k < 3; ++k)
            rows[k] = &heights[size_t((y + height + k - 1) % height) * width];
        for (uint32_t x = 0; x < width; ++x) {
            const uint32_t left = (x + width - 1) % width, right = (x + 1) % width;
            double across = 0, down = 0;
            for (int k = 0; k < 3; ++k)
                across += (k == 1 ? 2 : 1) * (double(rows[k][right]) - rows[k][left]);
            for (uint32_t at : {left, x, x, right})
                down += double(rows[2][at]) - rows[0][at];
            texels[size_t(y) * width + x] =
                normal_code({-scale * across / 255, scale * down / 255, 1});
        }
    }
}

void make_opacity(Vector<Rgba8> &texels)
{
    const bool has_alpha =
        std::any_of(texels.begin(), texels.end(), [](const Rgba8 &c) { return c.a < 255; });
    for (Rgba8 &c : texels) {
        const uint8_t v = has_alpha ? c.a : c.r;
        c = {v, v, v, v};
    }
}

} // namespace gtx
