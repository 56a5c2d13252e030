/* Networks of right triangles: cells whose surface bends away from both halves. */
#include "derive/rtin.h"

#include <math.h>

void gtx_rtin_add_twist(const gtx_grid *finest, gtx_rtin *rtin, const gtx_rtin_node *nodes,
                        float *error)
{
    const float rounded = 1 + 1e-5f; /* for errors to be no less than what drawing finds */
    const size_t row = gtx_rtin_row(rtin);
    uint16_t *rise = &rtin->rise[GTX_RTIN_LEVELS - 1];
    for (uint32_t y = 0; y + 1 < finest->nodes_y; ++y)
        for (uint32_t x = 0; x + 1 < finest->nodes_x; ++x) {
            const size_t at = y * row + x;
            const float twist = (float)gtx_rtin_twist(&nodes[at], row) / 4;
            if (!(twist > 0) || !finest->solid[(size_t)y * (finest->nodes_x - 1) + x])
                continue;
            const float middle = 0.25f * (float)(nodes[at].code + nodes[at + 1].code +
                                                 nodes[at + row].code + nodes[at + row + 1].code);
            rtin->twist = fmaxf(rtin->twist, twist);
            for (uint32_t c = 0; c < 4; ++c) {
                const size_t corner = at + c / 2 * row + c % 2;
                const float away = ceilf(fabsf((float)nodes[corner].code - middle));
                *rise = away > *rise ? (uint16_t)away : *rise;
                if ((x + y + c / 2 + c % 2) % 2)
                    error[corner] = fmaxf(error[corner], twist * rtin->code * rounded);
            }
        }
}
