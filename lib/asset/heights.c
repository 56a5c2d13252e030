/* The filter of heights, which predicts them from their neighbours (format/gtx.md, 1.2: filter 5).
 * */
#include "asset/codec.h"

#include "base/bytes.h"

static inline uint32_t load_code(const uint8_t *image, uint32_t bytes, size_t at)
{
    return bytes == 1 ? image[at] : gtx_load_u16(image + 2 * at);
}

static inline void store_code(uint8_t *image, uint32_t bytes, size_t at, uint32_t code)
{
    if (bytes == 1)
        image[at] = (uint8_t)code;
    else
        gtx_store_u16(image + 2 * at, (uint16_t)code);
}

/* What the neighbours left, above and above left lead one to expect, the plane through them or the
 * nearest of what is there: 0 is no neighbour. */
static inline uint32_t expected_code(int32_t a, int32_t b, int32_t c, int32_t most)
{
    if (a && b && c) {
        const int32_t plane = a + (b - c); /* `a` was found last */
        if (plane >= 1 && plane <= most) /* nearly always: a branch, which is not waited for */
            return (uint32_t)plane;
        return (uint32_t)(plane < 1 ? 1 : most);
    }
    int32_t near = a ? a : b ? b : c;
    return near ? (uint32_t)near : (uint32_t)(most + 1) / 2;
}

/* Between codes and their differences in planes, row by row, in either direction: one of `plain`
 * and `coded` grows. */
static inline void code_heights(gtx_map_shape shape, uint32_t bytes, uint8_t *plain, uint8_t *coded,
                                bool apply)
{
    const uint32_t most = bytes == 1 ? 255 : 65535;
    const size_t width = shape.width, texels = (size_t)shape.pages * shape.height * width;
    for (size_t first = 0; first < texels; first += width) {
        const bool up = first / width % shape.height != 0;
        uint32_t left = 0, corner = 0;
        for (size_t at = first; at < first + width; ++at) {
            const uint32_t above = up ? load_code(plain, bytes, at - width) : 0;
            uint32_t code = apply ? load_code(plain, bytes, at) : coded[at];
            if (!apply && bytes == 2)
                code |= (uint32_t)coded[texels + at] << 8;
            uint32_t other = code;
            if (code) {
                const uint32_t guess = expected_code((int32_t)left, (int32_t)above,
                                                     (int32_t)corner, (int32_t)most);
                const uint32_t sum = code + guess - 1;
                /* Without a branch, which noise would mislead. */
                other = apply ? 1 + (code + most - guess) % most : sum - (most & -(sum > most));
            }
            if (!apply)
                store_code(plain, bytes, at, other);
            else
                coded[at] = (uint8_t)other;
            if (apply && bytes == 2)
                coded[texels + at] = (uint8_t)(other >> 8);
            left = apply ? code : other;
            corner = above;
        }
    }
}

void gtx_heights_apply(gtx_map_shape shape, const uint8_t *in, uint8_t *coded)
{
    code_heights(shape, shape.texel, (uint8_t *)in, coded, true);
}

void gtx_heights_undo(gtx_map_shape shape, const uint8_t *coded, uint8_t *out)
{
    if (shape.texel == 1)
        code_heights(shape, 1, out, (uint8_t *)coded, false);
    else
        code_heights(shape, 2, out, (uint8_t *)coded, false);
}
