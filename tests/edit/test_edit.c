/* Image operations: what is refused, what a blur keeps and takes, and that no seam opens. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/counter.h"
#include "common/fixture.h"

#include <geotex/edit.h>

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static gtx_edit *begin(const gtx_asset *asset)
{
    gtx_edit *edit = NULL;
    gtx_error error = {0};
    if (gtx_edit_begin(asset, NULL, &edit, &error))
        fail_msg("%s", error.message);
    return edit;
}

/* Ends the edit. */
static gtx_asset *finish(gtx_edit *edit)
{
    gtx_asset *out = NULL;
    gtx_error error = {0};
    if (gtx_edit_finish(edit, &out, &error))
        fail_msg("%s", error.message);
    gtx_edit_end(edit);
    return out;
}

static void must(gtx_result result)
{
    if (result)
        fail_msg("%s", gtx_result_string(result));
}

static void same_bytes(const gtx_asset *a, const gtx_asset *b)
{
    void *data[2];
    size_t size[2];
    must(gtx_encode(a, NULL, &data[0], &size[0], NULL));
    must(gtx_encode(b, NULL, &data[1], &size[1], NULL));
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(data[0], data[1], size[0]);
    free(data[0]);
    free(data[1]);
}

static void expect_unchanged(const gtx_edit *edit, const gtx_asset *asset)
{
    gtx_asset *out = NULL;
    must(gtx_edit_finish(edit, &out, NULL));
    same_bytes(out, asset);
    gtx_close(out);
}

/* ---- what is refused ---- */

static void empty_field(const gtx_patch *patch, double x, double y, const void *user,
                        fixture_texel *out)
{
    (void)patch, (void)x, (void)y, (void)user;
    out->height = -1;
}

static void an_empty_asset_is_refused(void **state)
{
    (void)state;
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, 16, 16, 1, 1), empty_field, NULL};
    gtx_asset *asset = fixture_build(&patch, 1, 8, 4);
    gtx_edit *edit = NULL;
    gtx_error error = {0};
    assert_int_equal(gtx_edit_begin(asset, NULL, &edit, &error), GTX_ERROR_EMPTY);
    assert_null(edit);
    assert_non_null(strstr(error.message, "no texel"));
    assert_int_equal(gtx_edit_begin(NULL, NULL, &edit, NULL), GTX_ERROR_ARGUMENT);
    const gtx_edit_desc dirty = {.reserved = {1}};
    assert_int_equal(gtx_edit_begin(asset, &dirty, &edit, NULL), GTX_ERROR_NOT_ZEROED);
    gtx_edit_end(NULL);
    gtx_close(asset);
}

static void bad_blurs_change_nothing(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_bumpy(8, 0);
    gtx_edit *edit = begin(asset);
    const struct {
        gtx_edit_blur blur;
        gtx_result result;
    } bad[] = {{{.radius = 0}, GTX_ERROR_ARGUMENT},
               {{.radius = -1}, GTX_ERROR_ARGUMENT},
               {{.radius = NAN}, GTX_ERROR_ARGUMENT},
               {{.radius = INFINITY}, GTX_ERROR_ARGUMENT},
               {{.radius = 1, .flags = 64}, GTX_ERROR_ARGUMENT},
               {{.radius = 1, .reserved = {7}}, GTX_ERROR_NOT_ZEROED},
               {{.radius = 65}, GTX_ERROR_LIMIT}, /* texels; the patch has 64 */
               {{.radius = 4.1f, .flags = GTX_EDIT_WORLD}, GTX_ERROR_LIMIT}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
        gtx_error error = {0};
        assert_int_equal(gtx_edit_gaussian(edit, &bad[i].blur, &error), bad[i].result);
        assert_int_equal(gtx_edit_high_boost(edit, &bad[i].blur, 1, &error), bad[i].result);
        assert_true(bad[i].result == GTX_ERROR_NOT_ZEROED || error.message[0]);
    }
    const gtx_edit_blur fine = {.radius = 1};
    const float amounts[] = {0, -1, 17, NAN};
    for (size_t i = 0; i < 4; ++i)
        assert_int_equal(gtx_edit_high_boost(edit, &fine, amounts[i], NULL), GTX_ERROR_ARGUMENT);
    expect_unchanged(edit, asset);
    gtx_edit_end(edit);
    gtx_close(asset);
}

static void bad_marks_change_nothing(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_bumpy(16, 0);
    gtx_edit *edit = begin(asset);
    const float grey[4] = {0, 1, 1, 0}, nan[4] = {0, NAN, 1, 0};
    const gtx_edit_image good = {grey, 2, 2}, dot = {grey, 1, 1}, none = {NULL, 2, 2};
    const gtx_edit_image holed = {nan, 2, 2}, huge = {grey, 2, 20000};
    assert_int_equal(gtx_edit_pattern(edit, &dot, 1, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_pattern(edit, &none, 1, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_pattern(edit, &holed, 1, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_pattern(edit, &huge, 1, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_pattern(edit, &good, NAN, 1, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_pattern(edit, &good, 1, 0, NULL), GTX_ERROR_ARGUMENT);

    const uint32_t outside[][4] = {{0, 0, 0, 1}, {64, 0, 1, 1}, {60, 0, 5, 1}, {0, 48, 1, 1},
                                   {0, 1, 1, 48}, {1, 0, UINT32_MAX, 1}, {UINT32_MAX, 0, 1, 1}};
    for (size_t i = 0; i < sizeof outside / sizeof *outside; ++i) {
        gtx_error error = {0};
        assert_int_equal(gtx_edit_set_heights(edit, 0, outside[i], grey, &error),
                         GTX_ERROR_ARGUMENT);
        assert_non_null(strstr(error.message, "not within patch 0"));
    }
    const uint32_t two[4] = {30, 20, 2, 2};
    assert_int_equal(gtx_edit_set_heights(edit, 0, two, nan, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_set_heights(edit, 1, two, grey, NULL), GTX_ERROR_ARGUMENT);

    gtx_edit_stamp_desc stamp = {.centre = {0, 2, 2}, .radius = 1, .direction = {0, 0, 0}};
    assert_int_equal(gtx_edit_stamp(edit, &stamp, NULL), GTX_ERROR_ARGUMENT);
    stamp.direction[2] = -1;
    stamp.up[2] = 1; /* along it */
    assert_int_equal(gtx_edit_stamp(edit, &stamp, NULL), GTX_ERROR_ARGUMENT);
    stamp.up[2] = 0;
    stamp.depth = INFINITY;
    assert_int_equal(gtx_edit_stamp(edit, &stamp, NULL), GTX_ERROR_ARGUMENT);
    stamp.depth = 1;
    stamp.image = dot;
    assert_int_equal(gtx_edit_stamp(edit, &stamp, NULL), GTX_ERROR_ARGUMENT);
    stamp.image = (gtx_edit_image){0};
    stamp.centre[0] = 1e6f; /* far away: fine, and nothing happens */
    must(gtx_edit_stamp(edit, &stamp, NULL));
    expect_unchanged(edit, asset);
    gtx_edit_end(edit);
    gtx_close(asset);
}

static void throw_away(const gtx_edit_field *field, void *user)
{
    (void)user;
    for (uint32_t t = 0; t < field->width * field->height; ++t)
        if (field->kind[t] == GTX_TEXEL_OWN) {
            field->point[t][0] += 1;
            field->point[t][2] = NAN;
        }
}

static void an_operation_must_stay_finite(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    gtx_edit *edit = begin(asset);
    assert_int_equal(gtx_edit_apply(edit, throw_away, NULL, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_edit_apply(edit, NULL, NULL, NULL), GTX_ERROR_ARGUMENT);
    expect_unchanged(edit, asset);
    gtx_edit_end(edit);
    gtx_close(asset);
}

/* ---- what operations do ---- */

static void a_plane_stays(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    for (uint32_t flags = 0; flags <= GTX_EDIT_PER_PATCH; flags += GTX_EDIT_PER_PATCH) {
        gtx_edit *edit = begin(asset);
        const gtx_edit_blur blur = {.radius = 5, .flags = flags};
        must(gtx_edit_gaussian(edit, &blur, NULL));
        gtx_asset *out = finish(edit);
        gtx_caster *caster;
        must(gtx_caster_create(out, NULL, &caster, NULL));
        for (int i = 0; i < 400; ++i) { /* from one end to the other, and a little inside */
            const float x = 0.01f + 3.85f * (float)(i % 20) / 19;
            const float y = 0.01f + 2.85f * (float)(i / 20) / 19;
            const gtx_ray ray = {.origin = {x, y, 5}, .direction = {0, 0, -1}};
            gtx_hit hit;
            must(gtx_raycast(caster, &ray, &hit, 1, 0));
            assert_float_equal(hit.t, 4.5, 1e-4);
            assert_float_equal(hit.normal[2], 1, 1e-3);
        }
        gtx_caster_destroy(caster);
        gtx_close(out);
    }
    gtx_close(asset);
}

/* From all around: every ray towards the middle meets the front of a sphere, within `tolerance`. */
static void expect_sphere(const gtx_asset *asset, double radius, double tolerance)
{
    enum { SIDE = 90 };
    const double pi = acos(-1);
    gtx_caster *caster;
    must(gtx_caster_create(asset, NULL, &caster, NULL));
    for (int i = 0; i < SIDE; ++i)
        for (int j = 0; j < 2 * SIDE; ++j) {
            const double a = pi * (i + 0.5) / SIDE, b = pi * (j + 0.31) / SIDE;
            const double n[3] = {sin(a) * cos(b), cos(a), sin(a) * sin(b)};
            gtx_ray ray = {.t_min = 0};
            gtx_hit hit;
            for (int k = 0; k < 3; ++k) {
                ray.origin[k] = (float)(10 * n[k]);
                ray.direction[k] = (float)-n[k];
            }
            must(gtx_raycast(caster, &ray, &hit, 1, GTX_RAY_TWO_SIDED));
            assert_true(hit.patch != UINT32_MAX && !hit.back);
            assert_float_equal(10 - hit.t, radius, tolerance);
            assert_float_equal(hit.normal[0] * n[0] + hit.normal[1] * n[1] + hit.normal[2] * n[2],
                               1, 3e-3);
        }
    gtx_caster_destroy(caster);
}

/* Rays that pass inside the outline never meet the sphere from behind first: there is no seam. */
static void expect_closed(const gtx_asset *asset, double radius)
{
    enum { SIDE = 160 };
    gtx_caster *caster;
    must(gtx_caster_create(asset, NULL, &caster, NULL));
    unsigned wrong = 0;
    for (int v = 0; v < 9; ++v) {
        const double w[3] = {cos(v), sin(v) * cos(2.3 * v), sin(v) * sin(2.3 * v)};
        const double e[3] = {fabs(w[0]) < 0.8, fabs(w[0]) >= 0.8, 0};
        double x[3], y[3], size = 0;
        for (int k = 0; k < 3; ++k) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            x[k] = w[a] * e[b] - w[b] * e[a];
            size += x[k] * x[k];
        }
        for (int k = 0; k < 3; ++k)
            x[k] /= sqrt(size);
        for (int k = 0; k < 3; ++k) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            y[k] = w[a] * x[b] - w[b] * x[a];
        }
        for (int i = 0; i < SIDE * SIDE; ++i) {
            const double s = radius * 0.99 * (2.0 * (i % SIDE) / (SIDE - 1) - 1);
            const double t = radius * 0.99 * (2.0 * (i / SIDE) / (SIDE - 1) - 1);
            gtx_ray ray = {.t_min = 0};
            gtx_hit hit;
            if (hypot(s, t) > 0.99 * radius)
                continue;
            for (int k = 0; k < 3; ++k) {
                ray.origin[k] = (float)(10 * w[k] + s * x[k] + t * y[k]);
                ray.direction[k] = (float)-w[k];
            }
            must(gtx_raycast(caster, &ray, &hit, 1, GTX_RAY_TWO_SIDED));
            wrong += hit.patch == UINT32_MAX || hit.back;
        }
    }
    gtx_caster_destroy(caster);
    assert_int_equal(wrong, 0);
}

static void a_sphere_shrinks_and_stays_closed(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(2, 64, 16);
    const float radii[] = {2, 8};
    for (size_t i = 0; i < 2; ++i) {
        gtx_edit *edit = begin(asset);
        const gtx_edit_blur blur = {.radius = radii[i]};
        const double sigma = radii[i] * gtx_edit_texel_size(edit), r = 2 * exp(-sigma * sigma / 4);
        must(gtx_edit_gaussian(edit, &blur, NULL));
        gtx_asset *out = finish(edit);
        expect_sphere(out, r, 0.004);
        expect_closed(out, r);
        gtx_close(out);
    }
    gtx_close(asset);
}

static void alone_a_sphere_comes_apart(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(2, 64, 16);
    gtx_edit *edit = begin(asset);
    const gtx_edit_blur blur = {.radius = 8, .flags = GTX_EDIT_PER_PATCH};
    must(gtx_edit_gaussian(edit, &blur, NULL));
    gtx_asset *out = finish(edit);
    gtx_caster *caster;
    must(gtx_caster_create(out, NULL, &caster, NULL));
    float low = INFINITY, high = 0;
    for (int i = 0; i < 1000; ++i) { /* around the equator, across four patches */
        const float x = cosf((float)i * 0.00628f), y = sinf((float)i * 0.00628f);
        const gtx_ray ray = {.origin = {10 * x, 10 * y, 0}, .direction = {-x, -y, 0}};
        gtx_hit hit;
        must(gtx_raycast(caster, &ray, &hit, 1, 0));
        low = fminf(low, 10 - hit.t);
        high = fmaxf(high, 10 - hit.t);
    }
    assert_true(high - low > 0.05f); /* what the other way does not do: there it is 0.004 */
    gtx_caster_destroy(caster);
    gtx_close(out);
    gtx_close(asset);
}

static void a_pattern_has_its_height(void **state)
{
    (void)state;
    const float white[4] = {1, 1, 1, 1};
    const gtx_edit_image image = {white, 2, 2};
    gtx_asset *asset = fixture_sphere(2, 64, 16);
    const float heights[] = {0.12f, -0.12f};
    for (size_t i = 0; i < 2; ++i) {
        gtx_edit *edit = begin(asset);
        must(gtx_edit_pattern(edit, &image, heights[i], 0.5f, NULL));
        gtx_asset *out = finish(edit);
        expect_sphere(out, 2 + heights[i], 0.006);
        expect_closed(out, 2 + heights[i]);
        gtx_close(out);
    }
    gtx_close(asset);
}

static void swell(const gtx_edit_field *field, void *user)
{
    for (uint32_t t = 0; t < field->width * field->height; ++t)
        if (field->kind[t] == GTX_TEXEL_OWN) {
            for (int k = 0; k < 3; ++k)
                field->point[t][k] *= *(const float *)user;
            field->next[t] = field->value[t] + 1;
        } else if (field->kind[t] != GTX_TEXEL_NONE) { /* what is written here does not count */
            field->point[t][0] = 1e30f;
            field->next[t] = -1;
        }
}

static void values_are_two(const gtx_edit_field *field, void *user)
{
    unsigned *texels = user;
    for (uint32_t t = 0; t < field->width * field->height; ++t)
        if (field->kind[t] != GTX_TEXEL_NONE) {
            assert_float_equal(field->value[t], 2, 1e-5);
            ++*texels;
        }
}

static void an_operation_of_ones_own_reaches_neighbours(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(2, 64, 16);
    gtx_edit *edit = begin(asset);
    float by = 1.05f;
    unsigned texels = 0;
    must(gtx_edit_apply(edit, swell, &by, NULL));
    must(gtx_edit_apply(edit, swell, &by, NULL));
    must(gtx_edit_apply(edit, values_are_two, &texels, NULL));
    assert_true(texels > 6 * 50 * 50);
    gtx_asset *out = finish(edit);
    gtx_info info;
    gtx_get_info(out, &info); /* grown by a tenth, rectangles are larger */
    assert_true(gtx_patches(out)[0].rect[2] > 64);
    expect_sphere(out, 2 * 1.05 * 1.05, 0.006);
    expect_closed(out, 2 * 1.05 * 1.05);
    gtx_close(out);
    gtx_close(asset);
}

static double roughness(const gtx_asset *asset)
{
    gtx_caster *caster;
    must(gtx_caster_create(asset, NULL, &caster, NULL));
    double sum = 0;
    for (int i = 0; i < 900; ++i) {
        const gtx_patch *p = gtx_patches(asset);
        gtx_ray ray = {.t_max = 0};
        gtx_hit hit;
        float along[3];
        for (int k = 0; k < 3; ++k) {
            along[k] = 0.3f + 0.4f * (float)(i % 30) / 29;
            ray.origin[k] = p->origin[k] + along[k] * p->extent_x * p->axis_x[k] +
                            (0.3f + 0.4f * (float)(i / 30) / 29) * p->extent_y * p->axis_y[k] +
                            3 * p->axis_z[k];
            ray.direction[k] = -p->axis_z[k];
        }
        must(gtx_raycast(caster, &ray, &hit, 1, 0));
        if (!isinf(hit.t))
            sum += 1 - (hit.facet[0] * p->axis_z[0] + hit.facet[1] * p->axis_z[1] +
                        hit.facet[2] * p->axis_z[2]);
    }
    gtx_caster_destroy(caster);
    return sum / 900;
}

static void a_blur_smooths_and_a_boost_roughens(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_bumpy(16, GTX_PATCH_TWO_SIDED);
    const gtx_edit_blur blur = {.radius = 3};
    gtx_edit *edit = begin(asset);
    must(gtx_edit_gaussian(edit, &blur, NULL));
    gtx_asset *smooth = finish(edit);
    edit = begin(asset);
    must(gtx_edit_high_boost(edit, &blur, 0.5f, NULL));
    gtx_asset *rough = finish(edit);
    const double before = roughness(asset);
    assert_true(roughness(smooth) < 0.8 * before);
    assert_true(roughness(rough) > 1.05 * before);
    gtx_close(smooth);
    gtx_close(rough);
    gtx_close(asset);
}

static void the_same_bytes_twice(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(2, 48, 8), *out[2];
    const float wave[9] = {0, 0.3f, 1, 0.2f, 0.9f, 0, 1, 0.4f, 0.1f};
    for (int i = 0; i < 2; ++i) {
        gtx_edit *edit = begin(asset);
        const gtx_edit_blur blur = {.radius = 2};
        must(gtx_edit_pattern(edit, &(gtx_edit_image){wave, 3, 3}, 0.1f, 0.7f, NULL));
        must(gtx_edit_gaussian(edit, &blur, NULL));
        must(gtx_edit_high_boost(edit, &blur, 0.7f, NULL));
        out[i] = finish(edit);
    }
    same_bytes(out[0], out[1]);
    gtx_close(out[0]);
    gtx_close(out[1]);
    gtx_close(asset);
}

/* ---- while it is drawn ---- */

static void a_stamp_presses_across_a_border(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(2, 64, 16);
    gtx_edit *edit = begin(asset);
    const float s = sqrtf(0.5f);
    const gtx_edit_stamp_desc stamp = {.centre = {2 * s, 2 * s, 0}, .radius = 0.4f,
                                       .direction = {-s, -s, 0}, .depth = 0.1f};
    const gtx_asset *live;
    const uint32_t *patches;
    uint32_t count;
    must(gtx_edit_refresh(edit, &live, &patches, &count, NULL));
    assert_int_equal(count, 0);
    must(gtx_edit_stamp(edit, &stamp, NULL));
    must(gtx_edit_refresh(edit, &live, &patches, &count, NULL));
    assert_int_equal(count, 2); /* the faces to +x and +y */
    gtx_caster *caster;
    gtx_hit hit;
    must(gtx_caster_create(live, NULL, &caster, NULL));
    for (int i = -1; i <= 1; ++i) { /* the bottom, and on either side of the border */
        const float x = s + 0.01f * (float)i, y = s - 0.01f * (float)i;
        const gtx_ray ray = {.origin = {10 * x, 10 * y, 0}, .direction = {-x, -y, 0}};
        must(gtx_raycast(caster, &ray, &hit, 1, GTX_RAY_TWO_SIDED));
        assert_false(hit.back);
        assert_float_equal(10 - hit.t, 1.9, 0.004);
    }
    gtx_caster_destroy(caster);
    expect_closed(live, 1.9);
    must(gtx_edit_refresh(edit, &live, &patches, &count, NULL));
    assert_int_equal(count, 0);
    gtx_edit_end(edit);
    gtx_close(asset);
}

static void neighbours_follow_a_rectangle(void **state)
{
    (void)state;
    enum { FROM = 2, SIZE = 60 };
    gtx_asset *asset = fixture_sphere(2, 64, 16);
    gtx_info info;
    gtx_get_info(asset, &info);
    const gtx_patch *p = &gtx_patches(asset)[0];
    const uint16_t *codes = gtx_map_data(asset, GTX_MAP_HEIGHT, 0, NULL);
    const uint32_t rectangle[4] = {FROM, FROM, SIZE, SIZE};
    float heights[SIZE * SIZE];
    for (int i = 0; i < SIZE * SIZE; ++i) { /* all but the rim, down by 0.02 */
        const size_t row = p->rect[1] + FROM + (size_t)i / SIZE;
        const uint16_t code = codes[row * info.page_width + p->rect[0] + FROM + (size_t)i % SIZE];
        heights[i] = (float)(code - 1) / 65534 - 0.02f / p->extent_z;
    }
    gtx_edit *edit = begin(asset);
    const gtx_asset *live;
    const uint32_t *patches;
    uint32_t count;
    must(gtx_edit_set_heights(edit, 0, rectangle, heights, NULL));
    must(gtx_edit_refresh(edit, &live, &patches, &count, NULL));
    assert_int_equal(count, 5); /* but the one behind */
    expect_closed(live, 1.98);
    gtx_edit_end(edit);
    gtx_close(asset);
}

static void running_out_of_memory_is_a_result(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    for (long n = 0;; ++n) {
        counter c = {n, 0};
        const gtx_allocator hooks = {counted_alloc, counted_free, &c};
        const gtx_edit_desc desc = {.allocator = &hooks};
        const gtx_edit_blur blur = {.radius = 1};
        const gtx_edit_blur alone = {.radius = 1, .flags = GTX_EDIT_PER_PATCH};
        const gtx_edit_stamp_desc stamp = {.centre = {2, 1, 0.5f}, .radius = 1, .depth = 0.1f,
                                           .direction = {0, 0, -1}};
        const uint32_t *patches;
        uint32_t count;
        const gtx_asset *live;
        gtx_edit *edit = NULL;
        gtx_asset *out = NULL;
        gtx_result result = gtx_edit_begin(asset, &desc, &edit, NULL);
        result = result ? result : gtx_edit_gaussian(edit, &blur, NULL);
        result = result ? result : gtx_edit_gaussian(edit, &alone, NULL);
        result = result ? result : gtx_edit_stamp(edit, &stamp, NULL);
        result = result ? result : gtx_edit_refresh(edit, &live, &patches, &count, NULL);
        result = result ? result : gtx_edit_finish(edit, &out, NULL);
        gtx_close(out);
        gtx_edit_end(edit);
        assert_int_equal(c.bytes, 0);
        assert_int_equal(result, c.until_failure >= 0 ? GTX_OK : GTX_ERROR_MEMORY);
        if (!result)
            break;
        assert_true(n < 1000);
    }
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_asset_is_refused),
        cmocka_unit_test(bad_blurs_change_nothing),
        cmocka_unit_test(bad_marks_change_nothing),
        cmocka_unit_test(an_operation_must_stay_finite),
        cmocka_unit_test(a_plane_stays),
        cmocka_unit_test(a_sphere_shrinks_and_stays_closed),
        cmocka_unit_test(alone_a_sphere_comes_apart),
        cmocka_unit_test(a_pattern_has_its_height),
        cmocka_unit_test(an_operation_of_ones_own_reaches_neighbours),
        cmocka_unit_test(a_blur_smooths_and_a_boost_roughens),
        cmocka_unit_test(the_same_bytes_twice),
        cmocka_unit_test(a_stamp_presses_across_a_border),
        cmocka_unit_test(neighbours_follow_a_rectangle),
        cmocka_unit_test(running_out_of_memory_is_a_result),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
