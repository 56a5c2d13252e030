/* The end colours of a block: a line is fitted to its texels by principal axis, then by least
 * squares. */
#include "frame/ends.h"

#include <math.h>
#include <string.h>

bool gtx_solve_ends(const gtx_texels *texels, const uint8_t *weights, const uint8_t *step,
                    const float *share, gtx_ends ends)
{
    float aa = 0, ab = 0, bb = 0, at[GTX_CHANNELS] = {0}, bt[GTX_CHANNELS] = {0};
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        const float w = weights[i], y = share[step[i]], x = 1 - y;
        aa += w * x * x;
        ab += w * x * y;
        bb += w * y * y;
        for (int c = 0; c < GTX_CHANNELS; ++c) {
            at[c] += w * x * texels->at[i][c];
            bt[c] += w * y * texels->at[i][c];
        }
    }
    const float det = aa * bb - ab * ab;
    if (!(det > 1e-6f))
        return false;
    for (int c = 0; c < GTX_CHANNELS; ++c) {
        ends[0][c] = (at[c] * bb - bt[c] * ab) / det;
        ends[1][c] = (bt[c] * aa - at[c] * ab) / det;
    }
    return true;
}

/* The direction along which texels stray most from their mean, by the power method. */
static void find_axis(const gtx_texels *texels, const uint8_t *weights,
                      float mean[GTX_CHANNELS], float axis[GTX_CHANNELS])
{
    enum { TURNS = 6 };
    float sum = 0, spread[GTX_CHANNELS][GTX_CHANNELS] = {{0}};
    memset(mean, 0, GTX_CHANNELS * sizeof *mean);
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        sum += weights[i];
        for (int c = 0; c < GTX_CHANNELS; ++c)
            mean[c] += (float)weights[i] * texels->at[i][c];
    }
    for (int c = 0; c < GTX_CHANNELS; ++c)
        mean[c] /= sum;
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i)
        for (int c = 0; c < GTX_CHANNELS; ++c)
            for (int d = 0; d < GTX_CHANNELS; ++d)
                spread[c][d] += (float)weights[i] * ((float)texels->at[i][c] - mean[c]) *
                                ((float)texels->at[i][d] - mean[d]);
    int widest = 0;
    for (int c = 1; c < GTX_CHANNELS; ++c)
        widest = spread[c][c] > spread[widest][widest] ? c : widest;
    memcpy(axis, spread[widest], GTX_CHANNELS * sizeof *axis);
    for (int turn = 0; turn < TURNS; ++turn) {
        float next[GTX_CHANNELS] = {0}, most = 0;
        for (int c = 0; c < GTX_CHANNELS; ++c) {
            for (int d = 0; d < GTX_CHANNELS; ++d)
                next[c] += spread[c][d] * axis[d];
            most = fmaxf(most, fabsf(next[c]));
        }
        for (int c = 0; c < GTX_CHANNELS; ++c)
            axis[c] = most > 0 ? next[c] / most : 0;
    }
}

void gtx_first_ends(const gtx_texels *texels, const uint8_t *weights, gtx_ends ends)
{
    float mean[GTX_CHANNELS], axis[GTX_CHANNELS], square = 0, least = 0, most = 0;
    find_axis(texels, weights, mean, axis);
    for (int c = 0; c < GTX_CHANNELS; ++c)
        square += axis[c] * axis[c];
    for (int i = 0; square > 0 && i < GTX_BLOCK_TEXELS; ++i) {
        float along = 0;
        for (int c = 0; c < GTX_CHANNELS; ++c)
            along += axis[c] * ((float)texels->at[i][c] - mean[c]) / square;
        least = weights[i] && along < least ? along : least;
        most = weights[i] && along > most ? along : most;
    }
    for (int c = 0; c < GTX_CHANNELS; ++c) {
        ends[0][c] = mean[c] + least * axis[c];
        ends[1][c] = mean[c] + most * axis[c];
    }
}
