/* What the format prescribes for texels, in integers (format/gtx.md, 4.8): normals of coarser
 * levels, and normals and trim where there is no height. The cooker writes just that, and filter 4
 * leaves it out of the file. */
#ifndef GTX_ASSET_FILL_H
#define GTX_ASSET_FILL_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What texels hold that no rule reaches. */
enum { GTX_FAR_NORMAL = 128, GTX_FAR_TRIM = 255 };

/* A sum of normals, as points of the octahedron: each has |x| + |y| + z = 1, here 255. */
typedef struct gtx_normal_sum {
    int32_t a, b, z;
} gtx_normal_sum;

/* Adds a normal if `take` is 1, none if it is 0. */
static inline void gtx_normal_add_if(gtx_normal_sum *sum, const uint8_t code[2], int32_t take)
{
    int32_t a = 2 * code[0] - 255, b = 2 * code[1] - 255;
    int32_t p = a < 0 ? -a : a, q = b < 0 ? -b : b;
    sum->a += a & -take;
    sum->b += b & -take;
    sum->z += (255 - (p > q ? p : q)) & -take; /* |x| + |y| = max(|x + y|, |x - y|) */
}

static inline void gtx_normal_add(gtx_normal_sum *sum, const uint8_t code[2])
{
    gtx_normal_add_if(sum, code, 1);
}

void gtx_normal_mean(const gtx_normal_sum *sum, uint8_t out[2]);

/* A rectangle of an image with `stride` texels a row: its first texel, and a byte a texel that is 1
 * where there is a height and 0 elsewhere. Normals leave there 1 + the steps to the nearest 1. */
typedef struct gtx_fill {
    uint8_t *codes, *ring;
    size_t stride;
    uint32_t width, height;
} gtx_fill;

/* Rings of normals that a patch asks for at a level. */
uint32_t gtx_fill_rings(const gtx_patch *patch, uint32_t level);

/* Fill the texels whose ring is 0, as far as the rule reaches; they hold the far values before. */
void gtx_fill_normals(const gtx_fill *area, uint32_t rings);
void gtx_fill_trim(const gtx_fill *area);

#ifdef __cplusplus
}
#endif
#endif
