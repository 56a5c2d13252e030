/* The view's planes, taken to object space. */
#include "frame/frustum.h"

#include <math.h>
#include <string.h>

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

static gtx_sides sides_of(const gtx_sight *sight, const float clip_from_world[16],
                          const gtx_instance_data *placed)
{
    gtx_plane rows[4] = {{{0}, 0}};
    for (int r = 0; r < 4; ++r) {
        for (int k = 0; k < 4; ++k)
            for (int i = 0; i < 3; ++i)
                rows[r].row[k] += (double)clip_from_world[4 * i + r] * placed->world[i][k];
        rows[r].row[3] += clip_from_world[12 + r];
    }
    const gtx_plane *w = &rows[3];
    const gtx_plane low = combine(w, sight->depth[0], &rows[2], 1);
    const gtx_plane high = combine(w, 1, &rows[2], -1);
    return (gtx_sides){{sight->reversed ? high : low, sight->reversed ? low : high,
                        combine(w, 1, &rows[0], 1), combine(w, 1, &rows[0], -1),
                        combine(w, 1, &rows[1], 1), combine(w, 1, &rows[1], -1)}, finish(*w)};
}

gtx_frustum gtx_frustum_of(const gtx_draw_call *draw, const gtx_model *model,
                           const gtx_instance_data *placed)
{
    const gtx_view *view = draw->view;
    const gtx_sight *sight = &draw->sight;
    const gtx_sides first = sides_of(sight, sight->clip_from_world, placed);
    gtx_frustum f = {.w = first.w, .two = sight->two,
                     .eye = {placed->object[0][3], placed->object[1][3], placed->object[2][3],
                             sight->depth[3]},
                     .pixels = sight->detail[0] * sight->detail[3] * gtx_stretch_of(placed),
                     .scale = sight->detail[0] * gtx_stretch_of(placed),
                     .level = -1};
    memcpy(f.side, first.side, sizeof f.side);
    if (f.two)
        f.other = sides_of(sight, sight->other_clip, placed);
    const int32_t last = (int32_t)model->mip_count - 1;
    if (view->level > 0)
        f.level = (int32_t)view->level - 1 < last ? (int32_t)view->level - 1 : last;
    else if (view->viewport_height == 0)
        f.level = 0;
    return f;
}

/* Whether the sphere reaches out of a plane's inside. */
static bool reaches_out(const gtx_plane *p, const float sphere[4])
{
    return gtx_plane_at(p, sphere) < p->slope * sphere[3];
}

bool gtx_is_before_near(const gtx_frustum *f, const float sphere[4])
{
    return reaches_out(&f->side[0], sphere) || (f->two && reaches_out(&f->other.side[0], sphere));
}

static bool is_outside(const gtx_plane side[GTX_FRUSTUM_SIDES], const float sphere[4])
{
    bool outside = false;
    for (int k = 0; k < GTX_FRUSTUM_SIDES; ++k)
        outside = outside || gtx_plane_at(&side[k], sphere) < -side[k].slope * sphere[3];
    return outside;
}

bool gtx_is_outside(const gtx_frustum *f, const float sphere[4])
{
    return is_outside(f->side, sphere) && (!f->two || is_outside(f->other.side, sphere));
}

/* A camera's near and far planes often touch what they show. */
bool gtx_is_cut(const gtx_frustum *f, const float sphere[4])
{
    bool cut = false;
    for (int k = 2; k < GTX_FRUSTUM_SIDES; ++k)
        cut = cut || reaches_out(&f->side[k], sphere) ||
              (f->two && reaches_out(&f->other.side[k], sphere));
    return cut;
}

static double nearest(const gtx_plane *w, const float sphere[4])
{
    return gtx_plane_at(w, sphere) - w->slope * sphere[3];
}

double gtx_allowed_error(const gtx_frustum *f, const float sphere[4])
{
    double least = nearest(&f->w, sphere);
    if (f->two)
        least = fmin(least, nearest(&f->other.w, sphere));
    return fmax(least, 0) / f->scale;
}
