/* Affine placements: inverse, stretch and boxes. */
#include "derive/placement.h"

#include "asset/patch.h"

#include <math.h>

bool gtx_placement_of(const float transform[16], gtx_placement *out)
{
    bool finite = true;
    for (int i = 0; i < 16; ++i)
        finite = finite && isfinite(transform[i]);
    if (!finite || transform[3] != 0 || transform[7] != 0 || transform[11] != 0 ||
        transform[15] != 1)
        return false;
    for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 4; ++k)
            out->world[r][k] = transform[4 * k + r];
    /* A matrix M stretches by no more than the root of the largest row sum of M^T M. */
    double most = 0;
    for (int i = 0; i < 3; ++i) {
        double sum = 0;
        for (int j = 0; j < 3; ++j) {
            double dot = 0;
            for (int r = 0; r < 3; ++r)
                dot += out->world[r][i] * out->world[r][j];
            sum += fabs(dot);
        }
        most = fmax(most, sum);
    }
    out->stretch = sqrt(most);
    gtx_invert_affine(out->world, out->object);
    for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 4; ++k)
            finite = finite && isfinite((float)out->object[r][k]);
    return finite;
}

gtx_box gtx_placement_box(const gtx_placement *placement, const gtx_box *object)
{
    gtx_box box = gtx_box_empty;
    for (int corner = 0; corner < 8 && object->low[0] <= object->high[0]; ++corner)
        for (int r = 0; r < 3; ++r) {
            double p = placement->world[r][3];
            for (int k = 0; k < 3; ++k)
                p += placement->world[r][k] *
                     (double)(corner >> k & 1 ? object->high[k] : object->low[k]);
            box.low[r] = fminf(box.low[r], (float)p);
            box.high[r] = fmaxf(box.high[r], (float)p);
        }
    if (object->low[0] <= object->high[0])
        gtx_box_widen(&box);
    return box;
}

double gtx_ray_offset(const gtx_asset *asset)
{
    double most = 0;
    for (uint32_t i = 0; i < asset->info.patch_count; ++i) {
        const gtx_patch *p = &asset->patches[i];
        most = fmax(most, 2 * gtx_height_step(p, asset->info.height_bits));
        most = fmax(most, p->extent_x / p->rect[2] / 32);
        most = fmax(most, p->extent_y / p->rect[3] / 32);
    }
    return most;
}
