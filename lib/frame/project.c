/* Outlines of slabs in the picture: by their corners, or by what the near plane leaves of them. */
#include "frame/project.h"

#include <math.h>

enum { CORNERS = 8, EDGES = 12 }; /* of a slab */

/* How far, in pixels, rounding may move a slab's outline. */
static const float slack = 0.03f;

/* Slabs some point of which is nearer than this share of the farthest one are cut at the near
 * plane. Above it no slab's outline is much larger than what is in view. */
static const float near_share = 0.1f;

/* How far, in shares of the terms that it sums up, a coordinate of a corner may be off. */
static const double rounding = 1e-6;

/* A slab's corners in x, y and t, x and y times t when the camera is perspective. */
typedef struct corners {
    float at[3][CORNERS];
} corners;

/* What some points span: x, y, t, x + y and x - y. */
typedef struct extents {
    float x[2], y[2], t[2], sum[2], difference[2];
} extents;

/* The least and the greatest of the values at the corners. */
static inline void range_of(const float value[CORNERS], float range[2])
{
    float low[CORNERS / 2], high[CORNERS / 2];
    for (int n = 0; n < CORNERS / 2; ++n) {
        const float a = value[n], b = value[n + CORNERS / 2];
        low[n] = a < b ? a : b;
        high[n] = a < b ? b : a;
    }
    range[0] = low[0];
    range[1] = high[0];
    for (int n = 1; n < CORNERS / 2; ++n) {
        range[0] = low[n] < range[0] ? low[n] : range[0];
        range[1] = high[n] > range[1] ? high[n] : range[1];
    }
}

/* Within bounds of at most 2^20, rounded down or up; a bound when it is no number. The C library's
 * own are calls where processors need not have the instruction. */
static int32_t floor_within(float value, int32_t low, int32_t high)
{
    value = value > (float)low ? value : (float)low;
    value = value < (float)high ? value : (float)high;
    const int32_t whole = (int32_t)value;
    return whole - (value < (float)whole);
}

static int32_t ceil_within(float value, int32_t low, int32_t high)
{
    return -floor_within(-value, -high, -low);
}

/* The tiles along an axis of which some pixel's centre is within; false when there is none. */
static bool tiles_of(const float range[2], uint32_t pixels, uint16_t *first, uint16_t *last)
{
    const int32_t end = (int32_t)pixels;
    const int32_t low = ceil_within(range[0] - 0.5f - slack, 0, end);
    const int32_t high = floor_within(range[1] - 0.5f + slack, -1, end - 1);
    *first = (uint16_t)(low / GTX_TILE);
    *last = (uint16_t)(high / GTX_TILE);
    return low <= high;
}

/* Which tiles have a pixel in a range of x + y, or of x - y, by the sum or the difference of the
 * tiles' own x and y. `middle`: that of the middle of tile 0, in pixels. */
static void diagonals_of(const float range[2], float middle, int32_t out[2])
{
    const float reach = GTX_TILE - 1 + 2 * slack;
    const int32_t most = 1 << 20;
    out[0] = ceil_within((range[0] - middle - reach) / GTX_TILE, -most, most);
    out[1] = floor_within((range[1] - middle + reach) / GTX_TILE, -most, most);
}

/* A row over grid space at the corners of a slab. */
static inline void corners_of(const float row[4], const gtx_slab *slab, float out[CORNERS])
{
    const float along_x = row[0] + row[2] * slab->slope[0];
    const float along_y = row[1] + row[2] * slab->slope[1];
    const float from_x[2] = {along_x * slab->low[0], along_x * slab->high[0]};
    const float from_y[2] = {along_y * slab->low[1], along_y * slab->high[1]};
    for (int n = 0; n < CORNERS; ++n)
        out[n] = from_x[n & 1] + from_y[n >> 1 & 1] + (row[2] * slab->height[n >> 2] + row[3]);
}

/* The most that such a coordinate may be off. */
static double error_of(const float row[4], const gtx_slab *slab)
{
    double most[3], sum = fabs((double)row[3]);
    for (int k = 0; k < 2; ++k) {
        most[k] = fmax(fabs((double)slab->low[k]), fabs((double)slab->high[k]));
        sum += most[k] * (fabs((double)row[k]) + fabs((double)row[2] * (double)slab->slope[k]));
    }
    most[2] = fmax(fabs((double)slab->height[0]), fabs((double)slab->height[1]));
    return rounding * (sum + most[2] * fabs((double)row[2]));
}

static void extend(float range[2], double value, double off)
{
    range[0] = fminf(range[0], (float)(value - off));
    range[1] = fmaxf(range[1], (float)(value + off));
}

/* Takes a point in, of which no coordinate is farther off than `error`. */
static void add_point(extents *e, const double p[3], const double error[3])
{
    const double t = p[2] - error[2];
    if (!(t > 0)) { /* it may be anywhere */
        *e = (extents){{-INFINITY, INFINITY}, {-INFINITY, INFINITY}, {-INFINITY, e->t[1]},
                       {-INFINITY, INFINITY}, {-INFINITY, INFINITY}};
        return;
    }
    const double x = p[0] / p[2], y = p[1] / p[2];
    const double off[2] = {(error[0] + fabs(x) * error[2]) / t,
                           (error[1] + fabs(y) * error[2]) / t};
    extend(e->x, x, off[0]);
    extend(e->y, y, off[1]);
    extend(e->t, p[2], error[2]);
    extend(e->sum, x + y, off[0] + off[1]);
    extend(e->difference, x - y, off[0] + off[1]);
}

/* What is behind the near plane spans: corners, and points where edges pass it. */
static extents extents_behind(const gtx_patch_view *v, const gtx_slab *slab, const corners *p)
{
    const float none[2] = {INFINITY, -INFINITY};
    extents e;
    float behind[CORNERS];
    double error[3];
    corners_of(v->near, slab, behind);
    const float off = (float)error_of(v->near, slab);
    for (int k = 0; k < 3; ++k)
        error[k] = error_of(v->row[k], slab);
    memcpy(e.x, none, sizeof none);
    memcpy(e.y, none, sizeof none);
    memcpy(e.t, none, sizeof none);
    memcpy(e.sum, none, sizeof none);
    memcpy(e.difference, none, sizeof none);
    for (int n = 0; n < CORNERS; ++n) {
        const double a = (double)(behind[n] + off);
        const double from[3] = {(double)p->at[0][n], (double)p->at[1][n], (double)p->at[2][n]};
        if (a >= 0)
            add_point(&e, from, error);
        for (int axis = 1; axis < CORNERS; axis *= 2) {
            const double b = (double)(behind[n ^ axis] + off);
            if (!(a >= 0 && b < 0))
                continue;
            double at[3];
            for (int k = 0; k < 3; ++k)
                at[k] = from[k] + a / (a - b) * ((double)p->at[k][n ^ axis] - from[k]);
            add_point(&e, at, error);
        }
    }
    return e;
}

static extents extents_of(const gtx_camera_rows *c, const corners *p)
{
    extents e;
    float x[CORNERS], y[CORNERS], sums[CORNERS], differences[CORNERS];
    for (int n = 0; n < CORNERS; ++n) {
        const float inverse = c->perspective ? 1 / p->at[2][n] : 1;
        x[n] = p->at[0][n] * inverse;
        y[n] = p->at[1][n] * inverse;
        sums[n] = x[n] + y[n];
        differences[n] = x[n] - y[n];
    }
    range_of(x, e.x);
    range_of(y, e.y);
    range_of(p->at[2], e.t);
    range_of(sums, e.sum);
    range_of(differences, e.difference);
    return e;
}

bool gtx_project_slab(const gtx_camera_rows *c, const gtx_patch_view *v, const gtx_slab *slab,
                      gtx_visible_slab *out)
{
    corners p;
    for (int k = 0; k < 3; ++k)
        corners_of(v->row[k], slab, p.at[k]);
    extents e = extents_of(c, &p);
    if (c->perspective && !(e.t[1] > 0))
        return false;
    if (c->perspective && !(e.t[0] > near_share * e.t[1]))
        e = extents_behind(v, slab, &p);
    out->near = e.t[0];
    if (!tiles_of(e.x, c->width, &out->x0, &out->x1) ||
        !tiles_of(e.y, c->height, &out->y0, &out->y1))
        return false;
    diagonals_of(e.sum, GTX_TILE, out->sum);
    diagonals_of(e.difference, 0, out->difference);
    return true;
}
