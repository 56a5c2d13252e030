/* Resamples a height field whose points have moved to the texels of its patch: its cells are drawn,
 * as two triangles each, along the patch's z. */
#include "edit/edit.h"

#include <math.h>

/* Cells must show by this much, in texels, to be drawn; texels may lie this much outside. */
static const float MIN_SHOWN = 0.01f;
static const double SLACK = 1e-3;

/* `low` for what is no number. */
static double clamped(double value, double low, double high)
{
    return !(value > low) ? low : value < high ? value : high;
}

/* A height field's texel where it is now: texels of the source in x and y, object units in z. */
typedef struct corner {
    double x, y;
    size_t at;
} corner;

static corner find_corner(const gtx_edit *edit, const gtx_field_span *field, uint32_t i, uint32_t j)
{
    const size_t at = field->first + (size_t)j * field->width + i;
    corner c = {(double)i - GTX_EDIT_MARGIN, (double)j - GTX_EDIT_MARGIN, at};
    for (int k = 0; k < 3; ++k) {
        const double move = (double)edit->point[at][k] - edit->rest[at][k];
        c.x += field->to_grid[0][k] * move;
        c.y += field->to_grid[1][k] * move;
    }
    return c;
}

gtx_window gtx_edit_window(const gtx_edit *edit, const gtx_field_span *field)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (uint32_t j = 0; j < field->height; ++j)
        for (uint32_t i = 0; i < field->width; ++i) {
            const size_t at = field->first + (size_t)j * field->width + i;
            const double shown = GTX_TRIM_SHOWN - (double)edit->trim[at];
            if (!edit->kind[at] || shown < MIN_SHOWN)
                continue;
            /* So far from the outline, the next texel shows too. */
            const double beyond = fmin(shown, 1) - 2 * MIN_SHOWN;
            const corner c = find_corner(edit, field, i, j);
            low[0] = fmin(low[0], floor(c.x - beyond));
            low[1] = fmin(low[1], floor(c.y - beyond));
            high[0] = fmax(high[0], ceil(c.x + beyond));
            high[1] = fmax(high[1], ceil(c.y + beyond));
        }
    gtx_window window = {.size = {0, 0}};
    const bool shows = low[0] <= high[0] && low[1] <= high[1];
    for (int a = 0; a < 2 && shows; ++a) {
        /* What is farther away than any page is large is refused later. */
        low[a] = clamped(low[a], -1e6, 2e6);
        high[a] = clamped(high[a], -1e6, 2e6);
        window.low[a] = (int32_t)low[a];
        window.size[a] = (uint32_t)(high[a] - low[a]) + 1;
    }
    return window;
}

/* Takes a texel for a triangle of the height field if none that is deeper inside the outline has
 * it. */
static void offer(const gtx_edit *edit, const gtx_field_span *field, const corner corners[3],
                  const double weight[3], gtx_texel *out)
{
    double trim = 0;
    for (int k = 0; k < 3; ++k)
        trim += weight[k] * edit->trim[corners[k].at];
    if (out->covered && out->trim <= (float)trim)
        return;
    *out = (gtx_texel){.trim = (float)trim, .covered = 1};
    for (int k = 0; k < 3; ++k) {
        const size_t at = corners[k].at, own = at - field->first;
        out->height += (float)(weight[k] * gtx_edit_height(edit, field, at));
        out->from[0] += (float)(weight[k] * ((double)(own % field->width) - GTX_EDIT_MARGIN));
        out->from[1] += (float)(weight[k] * ((double)(own / field->width) - GTX_EDIT_MARGIN));
        for (int c = 0; c < 3; ++c)
            out->normal[c] += (float)weight[k] * edit->normal[at][c];
    }
}

static void draw_triangle(const gtx_edit *edit, const gtx_field_span *field, const corner c[3],
                          const gtx_window *window, gtx_texel *out)
{
    const double ux = c[1].x - c[0].x, uy = c[1].y - c[0].y;
    const double vx = c[2].x - c[0].x, vy = c[2].y - c[0].y, area = ux * vy - uy * vx;
    if (!(area > 1e-6)) /* it has turned away from z */
        return;
    const double low[2] = {fmin(fmin(c[0].x, c[1].x), c[2].x), fmin(fmin(c[0].y, c[1].y), c[2].y)};
    const double high[2] = {fmax(fmax(c[0].x, c[1].x), c[2].x), fmax(fmax(c[0].y, c[1].y), c[2].y)};
    int32_t first[2], last[2];
    for (int a = 0; a < 2; ++a) {
        const double begin = window->low[a], end = begin + window->size[a];
        first[a] = (int32_t)clamped(ceil(low[a] - SLACK), begin, end);
        last[a] = (int32_t)clamped(floor(high[a] + SLACK), begin - 1, end - 1);
    }
    for (int32_t y = first[1]; y <= last[1]; ++y)
        for (int32_t x = first[0]; x <= last[0]; ++x) {
            const double px = x - c[0].x, py = y - c[0].y;
            const double s = (px * vy - py * vx) / area, t = (ux * py - uy * px) / area;
            const double weight[3] = {1 - s - t, s, t};
            if (weight[0] < -SLACK || s < -SLACK || t < -SLACK)
                continue;
            offer(edit, field, c, weight,
                  &out[(size_t)(y - window->low[1]) * window->size[0] +
                       (size_t)(x - window->low[0])]);
        }
}

/* Texels get a code where a cell shows and has all its corners. */
static void mark_coded(const gtx_window *window, gtx_texel *texels)
{
    const size_t width = window->size[0];
    for (uint32_t j = 0; j + 1 < window->size[1]; ++j)
        for (uint32_t i = 0; i + 1 < width; ++i) {
            gtx_texel *a = texels + j * width + i, *b = a + width;
            const float trim = fminf(fminf(a[0].trim, a[1].trim), fminf(b[0].trim, b[1].trim));
            if (a[0].covered && a[1].covered && b[0].covered && b[1].covered &&
                trim <= GTX_TRIM_SHOWN - MIN_SHOWN)
                a[0].coded = a[1].coded = b[0].coded = b[1].coded = 1;
        }
}

void gtx_edit_warp(const gtx_edit *edit, const gtx_field_span *field, const gtx_window *window,
                   gtx_texel *out)
{
    for (uint32_t j = 0; j + 1 < field->height; ++j)
        for (uint32_t i = 0; i + 1 < field->width; ++i) {
            const size_t a = field->first + (size_t)j * field->width + i, b = a + field->width;
            if (!edit->kind[a] || !edit->kind[a + 1] || !edit->kind[b] || !edit->kind[b + 1])
                continue;
            const corner c[4] = {find_corner(edit, field, i, j),
                                 find_corner(edit, field, i + 1, j),
                                 find_corner(edit, field, i + 1, j + 1),
                                 find_corner(edit, field, i, j + 1)};
            draw_triangle(edit, field, (const corner[3]){c[0], c[1], c[2]}, window, out);
            draw_triangle(edit, field, (const corner[3]){c[0], c[2], c[3]}, window, out);
        }
    mark_coded(window, out);
}
