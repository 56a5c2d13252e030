/* Blocks of UASTC, 4 x 4 texels in 16 bytes: what KTX2 textures of glTF hold. */
#pragma once

#include <array>
#include <cstdint>

namespace gtx {

constexpr unsigned UASTC_BYTES = 16, UASTC_TEXELS = 16;
using UastcTexels = std::array<std::array<uint8_t, 3>, UASTC_TEXELS>; /* rows from the top */
using UastcBlock = std::array<uint8_t, UASTC_BYTES>;

/* The block whose texels are nearest, of the modes of opaque colours: solid ones, one line of
 * colours of three precisions, two lines beside each other, and a line with one channel apart. With
 * the hints by which transcoders make ETC1 of it. The same texels give the same block. */
UastcBlock encode_uastc(const UastcTexels &texels);

} // namespace gtx
