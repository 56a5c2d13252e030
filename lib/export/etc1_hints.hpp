/* How a transcoder makes ETC1 of a UASTC block. Inside of the room. */
#pragma once

#include "export/uastc_encode.hpp"

namespace gtx {

/* Of a block: two halves of 8 texels, above each other where `flip`, each of one base colour, told
 * as 5 bits and a difference, or as 4 bits each; and a table of distances for each half. */
struct Etc1Hints {
    static constexpr uint32_t NO_BIAS = 13; /* base colours as they are rounded */
    uint32_t flip, differential, table[2];
};
Etc1Hints etc1_hints(const UastcTexels &texels);

/* A block of one colour, whole. */
struct Etc1Solid {
    uint32_t differential, table, selector;
    std::array<uint8_t, 3> base; /* of 5 bits, or of 4 */
};
Etc1Solid etc1_solid(const std::array<uint8_t, 3> &color);

} // namespace gtx
