/* KTX 2.0 files of UASTC texels, as KHR_texture_basisu wants them. Inside of the room. */
#pragma once

#include "mesh/task.hpp"

namespace gtx {

/* How texels are averaged for coarser levels, and what they count as. */
enum class TexelKind { COLOR, NUMBERS, NORMALS }; /* sRGB; linear; linear, of unit length */

/* 3 bytes a texel, rows from the top; both sides multiples of 4. All levels down to 1 x 1, packed
 * by zstd where the build has it. The same texels give the same bytes on any thread count. */
Bytes encode_ktx2(uint32_t width, uint32_t height, const uint8_t *texels, TexelKind kind,
                  Task &task);

} // namespace gtx
