/* Images as textures: their smaller levels, and looking into them. Internal to lib/mesh. */
#pragma once

#include "mesh/material/appearance.hpp"

namespace gtx {

/* What the texels of an image say, and so how they are averaged. */
enum class Texels : uint8_t {
    COLOR, /* sRGB, averaged as light; alpha as it is */
    DATA   /* as they are */
};

/* An image of width x height texels with all its levels, down to one texel. */
Image make_image(uint32_t width, uint32_t height, Vector<Rgba8> texels, Texels kind);

/* The mean over a square of `side` texels of the finest level around (u, v), which the texture's
 * transform has been applied to: 0..1, the colours of COLOR as light. Trilinear (Williams 1983). */
std::array<float, 4> sample_image(const Image &image, const Wrap wrap[2], double u, double v,
                                  double side, Texels kind);

} // namespace gtx
