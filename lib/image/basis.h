/* The two codecs of Basis Universal, as their specifications tell: UASTC blocks (Khronos Data
 * Format 1.4, 25) and BasisLZ with ETC1S blocks (KTX 2.0, appendix B). Inside of lib/image. */
#ifndef GTX_IMAGE_BASIS_H
#define GTX_IMAGE_BASIS_H

#include <geotex/geotex.h>

/* What the reader of a container knows of one image. */
typedef struct gtx_basis_image {
    const uint8_t *level, *global;   /* of BasisLZ: the level's bytes, and those of all levels */
    size_t level_size, global_size;
    uint32_t image_count;            /* of all levels */
    uint32_t width, height;
    int has_alpha;
} gtx_basis_image;

enum { GTX_UASTC_BLOCK = 16 };

/* 4 x 4 texels of RGBA, rows from the top. A block that is none becomes magenta. */
void gtx_uastc_decode(const uint8_t *block, uint8_t texels[64]);

/* Fills 4 * width * height bytes. Errors: READ (it ends too early, or names what it lacks),
 * UNSUPPORTED (a frame of a film), MEMORY. */
gtx_result gtx_etc1s_decode(const gtx_basis_image *image, uint8_t *pixels, gtx_error *error);

#endif
