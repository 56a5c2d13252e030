/* The mathematics of a draw, in double: the eye, the clip planes, instances' inverses. */
#include "frame/view.h"

#include "asset/asset.h"
#include "base/error.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Where a float overflows, float arithmetic in shaders cannot go on. */
static bool all_finite(const float *values, int count)
{
    for (int i = 0; i < count; ++i)
        if (!isfinite(values[i]))
            return false;
    return true;
}

static double determinant(const double x[3], const double y[3], const double z[3])
{
    return x[0] * (y[1] * z[2] - y[2] * z[1]) + x[1] * (y[2] * z[0] - y[0] * z[2]) +
           x[2] * (y[0] * z[1] - y[1] * z[0]);
}

/* Solves m x = (0, 0, 1, 0) for a column-major m, by elimination with pivoting: the point, or for
 * an orthographic m the direction, that all rays share. False when m has no inverse. */
static bool shared_point(const double m[16], double x[4])
{
    double a[4][5];
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column)
            a[row][column] = m[4 * column + row];
        a[row][4] = row == 2;
    }
    for (int i = 0; i < 4; ++i) {
        int pivot = i;
        for (int row = i + 1; row < 4; ++row)
            if (fabs(a[row][i]) > fabs(a[pivot][i]))
                pivot = row;
        if (a[pivot][i] == 0)
            return false;
        for (int k = 0; k < 5; ++k) {
            const double swap = a[i][k];
            a[i][k] = a[pivot][k];
            a[pivot][k] = swap;
        }
        for (int row = 0; row < 4; ++row) {
            const double factor = row == i ? 0 : a[row][i] / a[i][i];
            for (int k = i; k < 5; ++k)
                a[row][k] -= factor * a[i][k];
        }
    }
    for (int i = 0; i < 4; ++i)
        x[i] = a[i][4] / a[i][i];
    return true;
}

static void multiply(const float a[16], const float b[16], double out[16])
{
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) {
            double sum = 0;
            for (int k = 0; k < 4; ++k)
                sum += (double)a[4 * k + row] * b[4 * column + k];
            out[4 * column + row] = sum;
        }
}

/* The eye and the direction of view, and whether the view mirrors; false when there is none. */
static bool find_eye(const double clip[16], gtx_sight *sight, double forward[3])
{
    double point[4];
    if (!shared_point(clip, point))
        return false;
    double x[3], y[3], w[3];
    for (int k = 0; k < 3; ++k) {
        x[k] = clip[4 * k];
        y[k] = clip[4 * k + 1];
        w[k] = clip[4 * k + 3];
    }
    const bool perspective = w[0] != 0 || w[1] != 0 || w[2] != 0;
    /* Clip z grows away from the camera, or towards it when reversed. */
    const double sign = sight->reversed ? -1 : 1;
    for (int k = 0; k < 3; ++k) {
        forward[k] = perspective ? w[k] : sign * point[k];
        sight->eye[k] = perspective ? point[k] / point[3] : -sign * point[k];
    }
    sight->eye[3] = perspective;
    const double turn = determinant(x, y, forward);
    sight->mirrored = turn > 0;
    return turn != 0 && isfinite(turn) && isfinite(sight->eye[0]) && isfinite(sight->eye[1]) &&
           isfinite(sight->eye[2]);
}

/* The other eye of a view that draws two. */
static gtx_result set_other(const gtx_eye *other, gtx_sight *sight, gtx_error *error)
{
    double clip[16], forward[3];
    gtx_sight its = {.reversed = sight->reversed};
    if (!all_finite(other->view, 16) || !all_finite(other->projection, 16))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the other eye's view is not finite");
    multiply(other->projection, other->view, clip);
    if (!find_eye(clip, &its, forward) || its.mirrored != sight->mirrored ||
        its.eye[3] != sight->eye[3])
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "the other eye's projection * view has no inverse, or is of another kind");
    sight->two = true;
    for (int i = 0; i < 16; ++i)
        sight->other_clip[i] = (float)clip[i];
    for (int k = 0; k < 3; ++k)
        sight->other_eye[k] = (float)(its.eye[k] - sight->eye[k]);
    return GTX_OK;
}

static void set_light(const gtx_view *view, const double forward[3], float light[4])
{
    double direction[3], length = 0;
    bool head = true;
    for (int k = 0; k < 3; ++k)
        head = head && view->light_direction[k] == 0;
    for (int k = 0; k < 3; ++k) {
        direction[k] = head ? -forward[k] : view->light_direction[k];
        length += direction[k] * direction[k];
    }
    for (int k = 0; k < 3; ++k)
        light[k] = (float)(direction[k] / sqrt(length));
    light[3] = view->ambient > 0 ? view->ambient : 0.2f;
}

/* The error allowed, and what levels are chosen by. */
static void set_detail(const gtx_view *view, const double clip[16], float detail[4])
{
    const double max_error = view->max_error > 0 ? view->max_error : 0.5;
    double y = 0;
    for (int k = 0; k < 3; ++k)
        y += clip[4 * k + 1] * clip[4 * k + 1];
    detail[0] = (float)fmin(sqrt(y) * view->viewport_height / 2 / max_error, FLT_MAX);
    detail[3] = (float)max_error;
}

gtx_result gtx_sight_of_view(const gtx_view *view, gtx_sight *out, gtx_error *error)
{
    double clip[16], forward[3];
    if (!all_finite(view->view, 16) || !all_finite(view->projection, 16) ||
        !all_finite(view->light_direction, 3) || !(view->ambient >= 0 && view->ambient <= 1))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "the view holds a value that is not finite, or an ambient beyond 0..1");
    if (!(view->max_error >= 0) || isinf(view->max_error) || view->level > GTX_MAX_MIPS)
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "the view's error is not finite and >= 0, or its level beyond %d",
                        GTX_MAX_MIPS - 1);
    const uint32_t *steps = view->search_steps;
    if (steps[0] > 1000 || steps[1] > 100 || (steps[1] && !steps[0]))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "the view's search has over 1000 linear or 100 binary steps, "
                        "or no linear ones");
    memset(out, 0, sizeof *out);
    out->search[0] = (float)steps[0];
    out->search[1] = (float)steps[1];
    out->search[2] = view->flags & GTX_VIEW_LINEAR ? 1.0f : 0.0f;
    out->reversed = view->flags & GTX_VIEW_REVERSED_Z;
    multiply(view->projection, view->view, clip);
    if (!find_eye(clip, out, forward))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "projection * view has no inverse");
    for (int i = 0; i < 16; ++i)
        out->clip_from_world[i] = (float)clip[i];
    set_light(view, forward, out->light);
    set_detail(view, clip, out->detail);

    float n = view->depth_range[0], f = view->depth_range[1];
    if (n == 0 && f == 0)
        f = 1;
    if (!(n >= 0 && n <= 1 && f >= 0 && f <= 1))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the depth range is not within 0..1");
    const bool zero_to_one = view->flags & GTX_VIEW_DEPTH_ZERO_TO_ONE;
    out->depth[0] = zero_to_one ? 0.0f : 1.0f;
    out->depth[1] = zero_to_one ? f - n : (f - n) / 2;
    out->depth[2] = zero_to_one ? n : (f + n) / 2;
    out->depth[3] = (float)out->eye[3];
    out->detail[1] = !(f > n) ? 0.0f : out->reversed ? -1.0f : 1.0f;
    return view->other ? set_other(view->other, out, error) : GTX_OK;
}

gtx_result gtx_place_instance(const gtx_sight *sight, const gtx_instance *instance,
                              gtx_instance_data *out, bool *mirrored, gtx_error *error)
{
    const float *m = instance->transform;
    double row[3][3], offset[3];
    if (!all_finite(m, 16) || !all_finite(instance->tint, 4) || m[3] != 0 || m[7] != 0 ||
        m[11] != 0 || m[15] != 1)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "an instance's transform is not affine");
    for (int r = 0; r < 3; ++r) {
        for (int k = 0; k < 4; ++k)
            out->world[r][k] = m[4 * k + r];
        for (int k = 0; k < 3; ++k)
            row[r][k] = m[4 * k + r];
        offset[r] = sight->eye[r] - sight->eye[3] * m[12 + r];
    }
    const double det = determinant(row[0], row[1], row[2]);
    for (int r = 0; r < 3; ++r) {
        double eye = 0;
        for (int k = 0; k < 3; ++k) {
            /* Cofactor of (k, r): the inverse is their transpose over the determinant. */
            const int k1 = (k + 1) % 3, k2 = (k + 2) % 3, r1 = (r + 1) % 3, r2 = (r + 2) % 3;
            const double inverse = (row[k1][r1] * row[k2][r2] - row[k1][r2] * row[k2][r1]) / det;
            out->object[r][k] = (float)inverse;
            eye += inverse * offset[k];
        }
        out->object[r][3] = (float)eye;
    }
    if (!all_finite(out->object[0], 12))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "an instance's transform has no inverse");
    const float *t = instance->tint;
    const bool white = t[0] == 0 && t[1] == 0 && t[2] == 0 && t[3] == 0;
    for (int k = 0; k < 4; ++k)
        out->tint[k] = white ? 1.0f : t[k];
    out->id = instance->id;
    *mirrored = (det < 0) != sight->mirrored;
    return GTX_OK;
}

/* For a transform M the root of the largest row sum of M M^T. */
double gtx_stretch_of(const gtx_instance_data *placed)
{
    double most = 0;
    for (int r = 0; r < 3; ++r) {
        double sum = 0;
        for (int c = 0; c < 3; ++c) {
            double product = 0;
            for (int k = 0; k < 3; ++k)
                product += (double)placed->world[r][k] * placed->world[c][k];
            sum += fabs(product);
        }
        most = fmax(most, sum);
    }
    return sqrt(most);
}

bool gtx_keeps_angles(const gtx_instance_data *placed)
{
    const double slack = 1e-3;
    double product[3][3] = {{0}};
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            for (int k = 0; k < 3; ++k)
                product[r][c] += (double)placed->world[r][k] * placed->world[c][k];
    bool keeps = true;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c <= r; ++c)
            keeps = keeps && fabs(product[r][c] - (r == c ? product[0][0] : 0)) <=
                                 slack * product[0][0];
    return keeps;
}
