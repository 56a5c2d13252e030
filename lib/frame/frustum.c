/* The view's planes, taken to object space. */
#include "frame/frustum.h"

#include <math.h>

static gtx_plane finish(gtx_plane p)
{
    p.slope = sqrt(p.row[0] * p.row[0] + p.row[1] * p.row[1] + p.row[2] * p.row[2]);
    return p;
}

/* w * w_factor + row * factor */
static gtx_plane combine(const gtx_plane *w, double w_factor, const gtx_plane *row, double factor)
{
    gtx_plane p;
    for (int k = 0; k < 4; ++k)
        p.row[k] = w_factor * w->row[k] + factor * row->row[k];
    return finish(p);
}

gtx_frustum gtx_frustum_of(const gtx_draw_call *draw, const gtx_model *model,
                           const gtx_instance_data *placed)
{
    const gtx_view *view = draw->view;
    const gtx_sight *sight = &draw->sight;
    gtx_plane rows[4] = {{{0}, 0}};
    for (int r = 0; r < 4; ++r) {
        for (int k = 0; k < 4; ++k)
            for (int i = 0; i < 3; ++i)
                rows[r].row[k] += (double)sight->clip_from_world[4 * i + r] * placed->world[i][k];
        rows[r].row[3] += sight->clip_from_world[12 + r];
    }
    const gtx_plane *w = &rows[3];
    const gtx_plane low = combine(w, sight->depth[0], &rows[2], 1);
    const gtx_plane high = combine(w, 1, &rows[2], -1);
    gtx_frustum f = {.side = {sight->reversed ? high : low, sight->reversed ? low : high,
                              combine(w, 1, &rows[0], 1), combine(w, 1, &rows[0], -1),
                              combine(w, 1, &rows[1], 1), combine(w, 1, &rows[1], -1)},
                     .w = finish(*w),
                     .eye = {placed->object[0][3], placed->object[1][3], placed->object[2][3],
                             sight->depth[3]},
                     .pixels = sight->detail[0] * sight->detail[3] * gtx_stretch_of(placed),
                     .scale = sight->detail[0] * gtx_stretch_of(placed),
                     .level = -1};
    const int32_t last = (int32_t)model->mip_count - 1;
    if (view->level > 0)
        f.level = (int32_t)view->level - 1 < last ? (int32_t)view->level - 1 : last;
    else if (view->viewport_height == 0)
        f.level = 0;
    return f;
}

double gtx_plane_at(const gtx_plane *p, const float sphere[4])
{
    return p->row[0] * sphere[0] + p->row[1] * sphere[1] + p->row[2] * sphere[2] + p->row[3];
}

bool gtx_is_before_near(const gtx_frustum *f, const float sphere[4])
{
    return gtx_plane_at(&f->side[0], sphere) < f->side[0].slope * sphere[3];
}

bool gtx_is_outside(const gtx_frustum *f, const float sphere[4])
{
    bool outside = false;
    for (int k = 0; k < GTX_FRUSTUM_SIDES; ++k)
        outside = outside || gtx_plane_at(&f->side[k], sphere) < -f->side[k].slope * sphere[3];
    return outside;
}

double gtx_allowed_error(const gtx_frustum *f, const float sphere[4])
{
    const double nearest = gtx_plane_at(&f->w, sphere) - f->w.slope * sphere[3];
    return fmax(nearest, 0) / f->scale;
}
