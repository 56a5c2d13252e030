/* What a view shows of a model: how large its parts are in it. Built by emscripten alone; see
 * web.mk. */
#include "frame/model.h"

#include <emscripten/emscripten.h>

#include <float.h>
#include <math.h>

static float length_of(const float v[3])
{
    return sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* The geometric mean of a texel's sides, in object units, as geotex_lod.vert has it. */
static float texel_of(gtx_record record)
{
    const float *x = record[GTX_RECORD_AXIS_X], *y = record[GTX_RECORD_AXIS_Y];
    float area[3];
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        area[k] = x[a] * y[b] - x[b] * y[a];
    }
    return sqrtf(length_of(area));
}

/* `clip` takes the asset's coordinates to clip space, column by column; `height` is the picture's,
 * in pixels. Gives the pixels of an object unit where a patch in view is nearest, and those of a
 * texel where they are most; 0 where none is in view. Valid until the next call. */
EMSCRIPTEN_KEEPALIVE
const float *gtxw_model_need(gtx_model *model, const float *clip, float height)
{
    static float out[2];
    float side[5][4]; /* w, and what is above 0 beside none of four sides */
    for (int k = 0; k < 4; ++k) {
        const float x = clip[4 * k], y = clip[4 * k + 1], w = clip[4 * k + 3];
        const float column[5] = {w, w + x, w - x, w + y, w - y};
        for (int s = 0; s < 5; ++s)
            side[s][k] = column[s];
    }
    const float up[3] = {clip[1], clip[5], clip[9]};
    const float scale = length_of(up) * height / 2;
    out[0] = out[1] = 0;
    for (uint32_t p = 0; p < model->patch_count; ++p) {
        const float *c = model->facts[p].sphere;
        float least[5], most[5];
        for (int s = 0; s < 5; ++s) {
            const float *row = side[s], reach = length_of(row) * c[3];
            const float middle = row[0] * c[0] + row[1] * c[1] + row[2] * c[2] + row[3];
            least[s] = middle - reach;
            most[s] = middle + reach;
        }
        if (most[1] < 0 || most[2] < 0 || most[3] < 0 || most[4] < 0)
            continue;
        const float unit = scale / fmaxf(least[0], FLT_MIN);
        out[0] = fmaxf(out[0], unit);
        out[1] = fmaxf(out[1], unit * texel_of(model->records[p]));
    }
    return out;
}
