/* Bits of a stream, the lowest of a byte first. Inside of lib/image. */
#ifndef GTX_IMAGE_BITS_H
#define GTX_IMAGE_BITS_H

#include <stddef.h>
#include <stdint.h>

/* Past the end all bits are 0, and `over` says that some were asked for. */
typedef struct gtx_bits {
    const uint8_t *data;
    size_t size, at; /* size: in bytes, at: in bits */
    int over;
} gtx_bits;

static inline uint32_t gtx_take_bit(gtx_bits *b)
{
    if (b->at >= 8 * b->size) {
        b->over = 1;
        return 0;
    }
    const uint32_t bit = b->data[b->at / 8] >> b->at % 8 & 1u;
    ++b->at;
    return bit;
}

/* Up to 32 of them. */
static inline uint32_t gtx_take_bits(gtx_bits *b, uint32_t count)
{
    uint32_t value = 0;
    for (uint32_t i = 0; i < count; ++i)
        value |= gtx_take_bit(b) << i;
    return value;
}

#endif
