/* Little-endian loads and stores, the processor's own, and arithmetic that reports overflow. */
#ifndef GTX_BASE_BYTES_H
#define GTX_BASE_BYTES_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Numbers in memory have their high byte first. */
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
#define GTX_BIG_ENDIAN 1
#else
#define GTX_BIG_ENDIAN 0
#endif

static inline uint16_t gtx_load_u16(const uint8_t *p)
{
    return (uint16_t)(p[0] | p[1] << 8);
}

static inline uint32_t gtx_load_u32(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static inline uint64_t gtx_load_u64(const uint8_t *p)
{
    return gtx_load_u32(p) | (uint64_t)gtx_load_u32(p + 4) << 32;
}

static inline float gtx_load_f32(const uint8_t *p)
{
    uint32_t bits = gtx_load_u32(p);
    float value;
    memcpy(&value, &bits, 4);
    return value;
}

static inline double gtx_load_f64(const uint8_t *p)
{
    uint64_t bits = gtx_load_u64(p);
    double value;
    memcpy(&value, &bits, 8);
    return value;
}

static inline void gtx_store_u16(uint8_t *p, uint16_t v)
{
    p[0] = (uint8_t)v;
    p[1] = (uint8_t)(v >> 8);
}

static inline void gtx_store_u32(uint8_t *p, uint32_t v)
{
    for (int i = 0; i < 4; ++i)
        p[i] = (uint8_t)(v >> (8 * i));
}

static inline void gtx_store_u64(uint8_t *p, uint64_t v)
{
    for (int i = 0; i < 8; ++i)
        p[i] = (uint8_t)(v >> (8 * i));
}

static inline void gtx_store_f32(uint8_t *p, float v)
{
    uint32_t bits;
    memcpy(&bits, &v, 4);
    gtx_store_u32(p, bits);
}

static inline void gtx_store_f64(uint8_t *p, double v)
{
    uint64_t bits;
    memcpy(&bits, &v, 8);
    gtx_store_u64(p, bits);
}

/* Numbers of two bytes in the processor's order, of any alignment. */
static inline uint32_t gtx_load_own_u16(const uint8_t *p)
{
    return p[GTX_BIG_ENDIAN] | (uint32_t)p[!GTX_BIG_ENDIAN] << 8;
}

static inline void gtx_store_own_u16(uint8_t *p, uint32_t v)
{
    p[GTX_BIG_ENDIAN] = (uint8_t)v;
    p[!GTX_BIG_ENDIAN] = (uint8_t)(v >> 8);
}

/* Two or four bytes that were copied into a number, as the number that has the first of them low;
 * and back. */
static inline uint16_t gtx_first_low_u16(uint16_t v)
{
    return GTX_BIG_ENDIAN ? (uint16_t)(v << 8 | v >> 8) : v;
}

static inline uint32_t gtx_first_low_u32(uint32_t v)
{
    if (!GTX_BIG_ENDIAN)
        return v;
    return v << 24 | (v & 0xFF00) << 8 | (v >> 8 & 0xFF00) | v >> 24;
}

/* *out = a * b; false on overflow. */
static inline bool gtx_mul_u64(uint64_t a, uint64_t b, uint64_t *out)
{
    if (a && b > UINT64_MAX / a)
        return false;
    *out = a * b;
    return true;
}

/* *out = a + b; false on overflow. */
static inline bool gtx_add_u64(uint64_t a, uint64_t b, uint64_t *out)
{
    if (b > UINT64_MAX - a)
        return false;
    *out = a + b;
    return true;
}

#endif
