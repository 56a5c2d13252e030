/* The frustum of a view, and error on its screen, in double precision. */
#include "stream/frustum.h"

#include "base/error.h"

#include <math.h>
#include <string.h>

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; ++k)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Rows of clip x, y and w over the tiles' coordinates. */
static void clip_rows(const gtx_stream_view *view, double rows[3][4])
{
    static const int which[3] = {0, 1, 3};
    for (int r = 0; r < 3; ++r) {
        for (int column = 0; column < 4; ++column) {
            rows[r][column] = 0;
            for (int k = 0; k < 4; ++k)
                rows[r][column] += (double)view->projection[4 * k + which[r]] *
                                   (double)view->view[4 * column + k];
        }
        rows[r][3] -= dot(rows[r], view->origin);
    }
}

/* The point where clip x, y and w are 0. */
static void find_eye(double rows[3][4], double determinant, double at[3])
{
    double c[3][3];
    for (int r = 0; r < 3; ++r)
        cross(rows[(r + 1) % 3], rows[(r + 2) % 3], c[r]);
    for (int k = 0; k < 3; ++k)
        at[k] = -(c[0][k] * rows[0][3] + c[1][k] * rows[1][3] + c[2][k] * rows[2][3]) /
                determinant;
}

/* How much w grows per unit of distance from the eye: least towards the corners of the picture. */
static double least_growth(const gtx_stream_frustum *frustum)
{
    double least = INFINITY;
    for (int i = 0; i < 4; ++i) {
        double ray[3];
        cross(frustum->side[i & 1], frustum->side[2 + (i >> 1)], ray);
        least = fmin(least, fabs(dot(ray, frustum->w)) / sqrt(dot(ray, ray)));
    }
    return least;
}

static bool all_finite(const gtx_stream_view *view)
{
    for (int i = 0; i < 16; ++i)
        if (!isfinite(view->view[i]) || !isfinite(view->projection[i]))
            return false;
    return isfinite(view->origin[0]) && isfinite(view->origin[1]) && isfinite(view->origin[2]);
}

gtx_result gtx_stream_frustum_of(const gtx_stream_view *view, gtx_stream_frustum *out,
                                 gtx_error *error)
{
    double rows[3][4], normal[3];
    gtx_result result = gtx_check_reserved(view->reserved, 3, error);
    if (result)
        return result;
    if (!all_finite(view) || !view->viewport_height)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "a view is not finite, or has no viewport_height");
    clip_rows(view, rows);
    memset(out, 0, sizeof *out);
    memcpy(out->w, rows[2], sizeof out->w);
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k)
            out->side[i][k] = rows[2][k] + (i % 2 ? -1 : 1) * rows[i / 2][k];
    out->perspective = dot(out->w, out->w) > 0;
    out->pixels = sqrt(dot(rows[1], rows[1])) * view->viewport_height / 2;
    cross(rows[0], rows[1], normal);
    const double determinant = out->perspective ? dot(normal, out->w) : dot(normal, normal);
    if (determinant == 0 || !isfinite(determinant) || !isfinite(out->pixels) ||
        (!out->perspective && !(out->w[3] > 0)))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a view has no inverse");
    if (out->perspective) {
        find_eye(rows, determinant, out->at);
        out->least = least_growth(out);
        if (!isfinite(out->at[0]) || !isfinite(out->at[1]) || !isfinite(out->at[2]) ||
            !isfinite(out->least))
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "a view has no inverse");
    }
    return GTX_OK;
}

/* The minimum over a box of sign * f: with `sign` -1, minus the maximum of f. */
static double least_of(const double f[4], double sign, const double low[3], const double high[3])
{
    double sum = sign * f[3];
    for (int k = 0; k < 3; ++k)
        sum += fmin(sign * f[k] * low[k], sign * f[k] * high[k]);
    return sum;
}

bool gtx_stream_frustum_sees(const gtx_stream_frustum *frustum, const double low[3],
                             const double high[3])
{
    for (int i = 0; i < 4; ++i)
        if (least_of(frustum->side[i], -1, low, high) > 0)
            return false;
    return true;
}

double gtx_stream_frustum_pixels(const gtx_stream_frustum *frustum, const double low[3],
                                 const double high[3], double length)
{
    double nearest = least_of(frustum->w, 1, low, high), distance = 0;
    if (frustum->perspective) {
        for (int k = 0; k < 3; ++k) {
            const double out = fmax(fmax(low[k] - frustum->at[k], frustum->at[k] - high[k]), 0);
            distance += out * out;
        }
        nearest = fmax(nearest, sqrt(distance) * frustum->least);
    }
    if (length == 0)
        return 0;
    return nearest > 0 ? length * frustum->pixels / nearest : INFINITY;
}
