/* Inverses of affine maps, and the frame of a patch's grid space: texels in x and y (texel i at
 * x = i), height codes in z. */
#ifndef GTX_DERIVE_FRAME_H
#define GTX_DERIVE_FRAME_H

#include "asset/asset.h"

#ifdef __cplusplus
extern "C" {
#endif

/* From three rows of an affine map, linear part and translation, to those of its inverse. One that
 * has none gives numbers that are not finite. */
void gtx_invert_affine(double (*map)[4], double (*out)[4]);

typedef struct gtx_patch_frame {
    double axis[3][3], origin[3];      /* object = origin + x axis[0] + y axis[1] + z axis[2] */
    double to_grid[3][4];              /* rows of the inverse: linear part and translation */
} gtx_patch_frame;

/* By format/gtx.md, section 3; axes are taken as they stand. */
gtx_patch_frame gtx_patch_frame_of(const gtx_patch *patch, uint32_t height_bits);

#ifdef __cplusplus
}
#endif
#endif
