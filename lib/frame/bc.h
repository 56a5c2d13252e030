/* Blocks of 4x4 texels as GPUs read them: BC1, BC4, of which BC5 is two, and BC7. */
#ifndef GTX_FRAME_BC_H
#define GTX_FRAME_BC_H

#include <stdint.h>

enum { GTX_BLOCK_SIDE = 4, GTX_BLOCK_TEXELS = 16 };

/* Texels of four channels, in rows. */
typedef struct gtx_texels {
    uint8_t at[GTX_BLOCK_TEXELS][4];
} gtx_texels;

/* Texels of weight 0 are not looked up, and cost no error; at least one weighs something. */
/* Three channels along one line, 4 steps; alpha is not looked at. */
void gtx_bc1_encode(const gtx_texels *texels, const uint8_t weights[GTX_BLOCK_TEXELS],
                    uint8_t out[8]);
void gtx_bc4_encode(const uint8_t texels[GTX_BLOCK_TEXELS],
                    const uint8_t weights[GTX_BLOCK_TEXELS], uint8_t out[8]);
/* Mode 6 alone: four channels along one line, 16 steps. */
void gtx_bc7_encode(const gtx_texels *texels, const uint8_t weights[GTX_BLOCK_TEXELS],
                    uint8_t out[16]);

#endif
