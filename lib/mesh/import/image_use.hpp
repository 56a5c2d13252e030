/* Images that are not used as a material's textures are. Internal to lib/mesh. */
#pragma once

#include "mesh/material/texture.hpp"

namespace gtx {

/* From glossiness in alpha, times a factor, to a metal-rough map of no metal. */
void make_rough(float glossiness, Vector<Rgba8> &texels);

/* From heights, where the image is grey, to normals as glTF has them (Sobel's slopes; white lies
 * eight texels above black, for such heights have no unit); any other image holds normals already.
 * Slopes are multiplied by `scale`. The image repeats. */
void make_normals(float scale, uint32_t width, uint32_t height, Vector<Rgba8> &texels);

/* Alpha, or red where all is opaque, in every channel. */
void make_opacity(Vector<Rgba8> &texels);

} // namespace gtx
