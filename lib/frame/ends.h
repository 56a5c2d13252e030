/* The two end colours that a block of BC1 or BC7 stores; its texels are steps between them. */
#ifndef GTX_FRAME_ENDS_H
#define GTX_FRAME_ENDS_H

#include "frame/bc.h"

#include <stdbool.h>

enum { GTX_CHANNELS = 4 };

typedef float gtx_ends[2][GTX_CHANNELS];

/* Along the line on which texels stray most from their mean. */
void gtx_first_ends(const gtx_texels *texels, const uint8_t *weights, gtx_ends ends);
/* The ends that lose least where texel i is the share[step[i]] of the way from the first to the
 * second: least squares. False where all steps are one. */
bool gtx_solve_ends(const gtx_texels *texels, const uint8_t *weights, const uint8_t *step,
                    const float *share, gtx_ends ends);

#endif
