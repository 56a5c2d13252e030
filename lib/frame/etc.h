/* Blocks of 4x4 texels of mobile GPUs: EAC, of a channel, and ETC2's of three. */
#ifndef GTX_FRAME_ETC_H
#define GTX_FRAME_ETC_H

#include "frame/bc.h"

/* As in bc.h. A channel of 11 bits, or alpha's of 8. */
void gtx_eac_r11_encode(const uint8_t texels[GTX_BLOCK_TEXELS],
                        const uint8_t weights[GTX_BLOCK_TEXELS], uint8_t out[8]);
void gtx_eac_alpha_encode(const uint8_t texels[GTX_BLOCK_TEXELS],
                          const uint8_t weights[GTX_BLOCK_TEXELS], uint8_t out[8]);
/* Two halves with a colour each, or a plane of colour; alpha is not looked at. */
void gtx_etc2_encode(const gtx_texels *texels, const uint8_t weights[GTX_BLOCK_TEXELS],
                     uint8_t out[8]);

#endif
