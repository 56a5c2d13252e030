/* What operations do: what a blur keeps and takes, and that no seam opens. */
#include "edit/edits.h"

/* ---- what operations do ---- */

static void a_plane_stays(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_flat(0.5, 8);
    for (uint32_t flags = 0; flags <= GTX_EDIT_ALONE; flags += GTX_EDIT_ALONE) {
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
    const gtx_edit_blur blur = {.radius = 8, .flags = GTX_EDIT_ALONE};
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plane_stays),
        cmocka_unit_test(a_sphere_shrinks_and_stays_closed),
        cmocka_unit_test(alone_a_sphere_comes_apart),
        cmocka_unit_test(a_pattern_has_its_height),
        cmocka_unit_test(an_operation_of_ones_own_reaches_neighbours),
        cmocka_unit_test(a_blur_smooths_and_a_boost_roughens),
        cmocka_unit_test(a_stamp_presses_across_a_border),
        cmocka_unit_test(neighbours_follow_a_rectangle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
