/* Normals of the vertices of LOD meshes: octahedral, two bytes each, and what a level's own
 * triangles tell of them, in whole numbers, so that every reader expects the same. */
#include "asset/lod.h"
#include "asset/patch.h"

#include "base/bytes.h"

/* Bits of the largest triangle's normal: sums over some hundred of them keep their sign. */
enum { SUM_BITS = 24 };

typedef struct wide {
    int64_t at[3];
} wide;

/* Twice the area long, in steps; 0 where a corner is none of the vertices. */
static wide normal_of(const uint8_t *index, const uint8_t *positions, size_t vertices)
{
    int64_t side[2][3];
    const uint32_t first = gtx_load_u32(index);
    for (int e = 0; e < 2; ++e) {
        const uint32_t other = gtx_load_u32(index + 4 * (e + 1));
        if (first >= vertices || other >= vertices)
            return (wide){{0, 0, 0}};
        for (size_t k = 0; k < 3; ++k)
            side[e][k] = (int64_t)gtx_load_u16(positions + 6 * (size_t)other + 2 * k) -
                         gtx_load_u16(positions + 6 * (size_t)first + 2 * k);
    }
    wide out;
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        out.at[k] = side[0][i] * side[1][j] - side[0][j] * side[1][i];
    }
    return out;
}

static int64_t magnitude(int64_t n)
{
    return n < 0 ? -n : n;
}

/* floor(128 + 127.5 v / size), at most 255 */
static uint8_t code_of(int64_t v, int64_t size)
{
    const int64_t code = size ? (256 * size + 255 * v) / (2 * size) : 128;
    return (uint8_t)(code > 255 ? 255 : code);
}

/* Octahedral, of a vector of any length. */
static void encode_sum(const uint8_t *sum, uint8_t out[2])
{
    int64_t n[3], size = 0;
    for (int k = 0; k < 3; ++k) {
        n[k] = (int32_t)gtx_load_u32(sum + 4 * k);
        size += magnitude(n[k]);
    }
    int64_t x = n[0], y = n[1];
    if (n[2] < 0) {
        x = (size - magnitude(n[1])) * (n[0] < 0 ? -1 : 1);
        y = (size - magnitude(n[0])) * (n[1] < 0 ? -1 : 1);
    }
    out[0] = code_of(x, size);
    out[1] = code_of(y, size);
}

void gtx_lod_expect_normals(const uint8_t *indices, size_t triangles, const uint8_t *positions,
                            size_t vertices, uint8_t *sums, uint8_t *out)
{
    int64_t most = 0;
    int shift = 0;
    memset(sums, 0, 12 * vertices);
    for (size_t t = 0; t < triangles; ++t) {
        const wide n = normal_of(indices + 12 * t, positions, vertices);
        for (int k = 0; k < 3; ++k)
            most = magnitude(n.at[k]) > most ? magnitude(n.at[k]) : most;
    }
    while (most >> shift >> SUM_BITS)
        ++shift;
    for (size_t t = 0; t < triangles; ++t) {
        const wide n = normal_of(indices + 12 * t, positions, vertices);
        for (size_t c = 0; c < 3; ++c) {
            const uint32_t vertex = gtx_load_u32(indices + 12 * t + 4 * c);
            if (vertex >= vertices)
                continue;
            uint8_t *sum = sums + 12 * (size_t)vertex;
            for (int k = 0; k < 3; ++k, sum += 4)
                gtx_store_u32(sum, gtx_load_u32(sum) + (uint32_t)(n.at[k] >> shift));
        }
    }
    /* Each is in front of what is read next, where `out` is the place of the sums. */
    for (size_t i = 0; i < vertices; ++i) {
        uint8_t code[2];
        encode_sum(sums + 12 * i, code);
        memcpy(out + 2 * i, code, 2);
    }
}

/* ---- as the format has them ---- */

void gtx_encode_octahedral(const float n[3], uint8_t out[2])
{
    const float sum = fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]);
    float v[2] = {sum > 0 ? n[0] / sum : 0, sum > 0 ? n[1] / sum : 0};
    if (n[2] < 0) {
        const float folded = (1 - fabsf(v[1])) * (v[0] < 0 ? -1.0f : 1.0f);
        v[1] = (1 - fabsf(v[0])) * (v[1] < 0 ? -1.0f : 1.0f);
        v[0] = folded;
    }
    for (int k = 0; k < 2; ++k) {
        const float code = floorf(128.0f + 127.5f * v[k]);
        out[k] = code > 255 ? 255 : code > 0 ? (uint8_t)code : 0; /* NaN ends at 0 */
    }
}

void gtx_decode_octahedral(const uint8_t in[2], float n[3])
{
    const float x = (float)in[0] / 127.5f - 1, y = (float)in[1] / 127.5f - 1;
    const float z = 1 - fabsf(x) - fabsf(y), fold = z < 0 ? -z : 0;
    const float v[3] = {x < 0 ? x + fold : x - fold, y < 0 ? y + fold : y - fold, z};
    const float size = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; ++k)
        n[k] = v[k] / size;
}
