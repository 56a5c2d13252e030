/* What views see of boxes, against points in them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>

#include "stream/frustum.h"
#include "stream/made.h"

static uint64_t seed = 7;

static double between(double low, double high)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(seed >> 33) / (double)(1u << 31);
}

static double w_of(const gtx_stream_frustum *frustum, const double p[3])
{
    return frustum->w[0] * p[0] + frustum->w[1] * p[1] + frustum->w[2] * p[2] + frustum->w[3];
}

/* A view from anywhere, with fields of any width, off the middle too. */
static gtx_stream_view any_view(double far, int perspective)
{
    const double eye[3] = {between(-9, 9) + far, between(-9, 9), between(-9, 9) - far};
    gtx_stream_view view = made_view(eye, between(0, 7), between(-1.5, 1.5));
    view.projection[0] = (float)between(0.3, 3);
    view.projection[5] = (float)between(0.3, 3);
    view.projection[8] = (float)between(-0.5, 0.5);
    view.projection[9] = (float)between(-0.5, 0.5);
    if (!perspective) {
        view.projection[11] = 0;
        view.projection[15] = 2;
    }
    for (int k = 0; k < 3; ++k) { /* part of the way as a translation */
        const double part = between(-1, 1);
        view.origin[k] += part;
        for (int row = 0; row < 3; ++row)
            view.view[12 + row] += (float)part * view.view[4 * k + row];
    }
    return view;
}

/* No point of a box that is seen has a larger error than said, and the bound is not far from the
 * largest where points are many. */
static void bounds_hold(void **state)
{
    (void)state;
    double loosest = 0;
    int bounded = 0, unseen = 0;
    for (int n = 0; n < 6000; ++n) {
        const double far = n % 3 ? 0 : 1e7;
        const gtx_stream_view view = any_view(far, n % 5 != 0);
        double low[3], high[3], most = 0;
        gtx_stream_frustum frustum;
        int seen = 0;
        assert_int_equal(gtx_stream_frustum_of(&view, &frustum, NULL), GTX_OK);
        for (int k = 0; k < 3; ++k) {
            low[k] = between(-9, 9) + (k == 0 ? far : k == 2 ? -far : 0);
            high[k] = low[k] + between(0, 6);
        }
        const double pixels = gtx_stream_frustum_pixels(&frustum, low, high, 0.25);
        for (int i = 0; i < 400; ++i) {
            double p[3];
            for (int k = 0; k < 3; ++k)
                p[k] = i < 8 ? (i >> k & 1 ? low[k] : high[k]) : between(low[k], high[k]);
            if (!made_sees(&view, p))
                continue;
            ++seen;
            most = fmax(most, 0.25 * frustum.pixels / w_of(&frustum, p));
        }
        if (seen)
            assert_true(gtx_stream_frustum_sees(&frustum, low, high));
        unseen += !gtx_stream_frustum_sees(&frustum, low, high);
        assert_true(most <= pixels * 1.00001);
        if (seen > 100 && !isinf(pixels)) {
            loosest = fmax(loosest, pixels / most);
            ++bounded;
        }
    }
    printf("    at most %.2f times the largest error of %d boxes; %d out of view\n", loosest,
           bounded, unseen);
    assert_true(bounded > 500 && unseen > 1500 && loosest < 6);
}

static void an_eye_in_the_box_sees_all_errors(void **state)
{
    (void)state;
    const gtx_stream_view view = made_view((double[3]){1, 2, 3}, 0.3, 0.1);
    const double low[3] = {0, 0, 0}, high[3] = {5, 5, 5};
    gtx_stream_frustum frustum;
    assert_int_equal(gtx_stream_frustum_of(&view, &frustum, NULL), GTX_OK);
    assert_true(fabs(frustum.at[0] - 1) < 1e-6 && fabs(frustum.at[2] - 3) < 1e-6);
    assert_true(isinf(gtx_stream_frustum_pixels(&frustum, low, high, 1e-9)));
    assert_true(gtx_stream_frustum_pixels(&frustum, low, high, 0) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_hold),
        cmocka_unit_test(an_eye_in_the_box_sees_all_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
