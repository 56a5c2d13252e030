/* Casting against the exhaustive search, and against surfaces that are known. */
#include "trace/balls.h"

typedef struct tally {
    int hits, wrong, excluded;
} tally;

static bool near_edge(const gtx_hit *hit, uint32_t level)
{
    double step = 1u << level, x = hit->x / step, y = hit->y / step;
    return fabs(x - round(x)) < 1e-4 || fabs(y - round(y)) < 1e-4;
}

/* A ray is wrong when hit and miss differ, or hits by more than a height step and 1/8 texel. Rays
 * close to an edge or a tangent are excluded and counted. */
static void judge(const gtx_asset *asset, uint32_t level, const gtx_ray *ray, const gtx_hit *a,
                  const gtx_hit *b, tally *out)
{
    bool hit_a = a->patch != UINT32_MAX, hit_b = b->patch != UINT32_MAX, wrong = hit_a != hit_b;
    const gtx_hit *some = hit_a ? a : b;
    out->hits += hit_b;
    if (hit_a && hit_b) {
        const gtx_patch *p = &gtx_patches(asset)[a->patch];
        double steps = p->extent_x / p->rect[2] / 8 + p->extent_z / 254;
        wrong = fabs((double)a->t - b->t) > steps;
    }
    if (!wrong)
        return;
    double tangent = 0;
    for (int k = 0; k < 3; ++k)
        tangent += (double)some->facet[k] * ray->direction[k];
    if (near_edge(some, level) || fabs(tangent) < 1e-4)
        ++out->excluded;
    else
        ++out->wrong;
}

static tally compare(const gtx_asset *asset, uint32_t level, uint32_t flags, int count,
                     uint64_t seed)
{
    enum { BATCH = 1000 };
    gtx_caster *caster = caster_of(asset, level);
    gtx_info info;
    gtx_get_info(asset, &info);
    tally result = {0};
    static gtx_ray rays[BATCH];
    static gtx_hit fast[BATCH], slow[BATCH];
    for (int done = 0; done < count; done += BATCH) {
        for (int i = 0; i < BATCH; ++i)
            rays[i] = random_ray(&info, &seed);
        gtx_raycast(caster, rays, fast, BATCH, flags);
        gtx_raycast(caster, rays, slow, BATCH, flags | GTX_RAY_EXHAUSTIVE);
        for (int i = 0; i < BATCH; ++i)
            judge(asset, level, &rays[i], &fast[i], &slow[i], &result);
    }
    gtx_caster_destroy(caster);
    return result;
}

static void expect_no_wrong_ray(gtx_asset *asset, uint32_t level, uint32_t flags, int count)
{
    tally t = compare(asset, level, flags, count, 7 + level);
    print_message("# level %u flags %u: %d rays, %d hits, %d wrong, %d excluded\n", level, flags,
                  count, t.hits, t.wrong, t.excluded);
    assert_true(t.hits > count / 20);
    assert_int_equal(t.wrong, 0);
    assert_true(t.excluded <= count / 10000);
}

static void bumpy_agrees_with_every_cell(void **state)
{
    (void)state;
    for (uint32_t bits = 8; bits <= 16; bits += 8) {
        gtx_asset *asset = fixture_bumpy(bits, 0);
        expect_no_wrong_ray(asset, 0, 0, 200000);
        expect_no_wrong_ray(asset, 0, GTX_RAY_TWO_SIDED, 100000);
        for (uint32_t level = 1; level < 8; ++level)
            expect_no_wrong_ray(asset, level, level & 1 ? GTX_RAY_TWO_SIDED : 0, 25000);
        gtx_close(asset);
    }
    gtx_asset *asset = fixture_bumpy(8, GTX_PATCH_TWO_SIDED);
    expect_no_wrong_ray(asset, 0, 0, 50000);
    gtx_close(asset);
}

static void sphere_agrees_with_every_cell(void **state)
{
    (void)state;
    for (uint32_t bits = 8; bits <= 16; bits += 8) {
        gtx_asset *asset = fixture_sphere(1.5, 48, bits);
        expect_no_wrong_ray(asset, 0, 0, 30000);
        expect_no_wrong_ray(asset, 2, 0, 30000);
        gtx_close(asset);
    }
}

static void two_sided_is_a_flag_of_patch_or_ray(void **state)
{
    (void)state;
    gtx_asset *one = fixture_flat(0.5, 8);
    gtx_caster *caster = caster_of(one, 0);
    gtx_ray up = {.origin = {1.03f, 1.04f, -4}, .direction = {0, 0, 1}};
    assert_int_equal(cast(caster, up, 0).patch, UINT32_MAX);
    gtx_hit hit = cast(caster, up, GTX_RAY_TWO_SIDED);
    assert_int_equal(hit.patch, 0);
    assert_int_equal(hit.back, 1);
    assert_float_equal(hit.t, 4.5f, 1e-5f);
    assert_float_equal(hit.facet[2], 1, 1e-6f);
    gtx_caster_destroy(caster);
    gtx_close(one);
}

/* Where a ray meets a sphere around the origin; negative when it does not. */
static double meet_sphere(const gtx_ray *ray, double radius)
{
    double b = 0, c = -radius * radius, a = 0;
    for (int k = 0; k < 3; ++k) {
        a += (double)ray->direction[k] * ray->direction[k];
        b += (double)ray->direction[k] * ray->origin[k];
        c += (double)ray->origin[k] * ray->origin[k];
    }
    double square = b * b - a * c;
    return square < 0 ? -1 : (-b - sqrt(square)) / a;
}

static void sphere_is_a_sphere(void **state)
{
    (void)state;
    const double radius = 2;
    gtx_asset *asset = fixture_sphere(radius, 96, 16);
    gtx_caster *caster = caster_of(asset, 0);
    uint64_t seed = 5;
    int holes = 0;
    for (int i = 0; i < 100000; ++i) {
        gtx_ray ray = {{0}, 0, {0}, 0};
        float aside[3];
        direction(&seed, ray.direction);
        direction(&seed, aside);
        double across = 0, height = radius * 0.995 * sqrt(uniform(&seed));
        for (int k = 0; k < 3; ++k)
            across += (double)aside[k] * ray.direction[k];
        double length = sqrt(1 - across * across);
        for (int k = 0; k < 3; ++k)
            ray.origin[k] = (float)((aside[k] - across * ray.direction[k]) / length * height -
                                    5 * ray.direction[k]);
        gtx_hit hit = cast(caster, ray, 0);
        double expected = meet_sphere(&ray, radius);
        if (hit.patch == UINT32_MAX) {
            ++holes;
            continue;
        }
        double slope = sqrt(1 - height * height / (radius * radius));
        assert_true(fabs(hit.t - expected) < 0.002 / slope);
        for (int k = 0; k < 3; ++k) {
            double n = (ray.origin[k] + hit.t * ray.direction[k]) / radius;
            assert_true(fabs(n - hit.normal[k]) < 0.02);
            assert_true(fabs(n - hit.facet[k]) < 0.05);
        }
    }
    assert_int_equal(holes, 0);
    gtx_caster_destroy(caster);
    gtx_close(asset);
}

static void along_the_axes(void **state)
{
    (void)state;
    /* Code 128 of 8 bits: height 127 / 254. */
    gtx_asset *asset = fixture_flat(0.5, 8);
    gtx_caster *caster = caster_of(asset, 0);
    for (int j = 0; j <= 46; ++j)
        for (int i = 0; i <= 62; ++i) { /* texels and half-way between, borders too */
            gtx_ray down = {.origin = {i * 0.0625f, j * 0.0625f, 8}, .direction = {0, 0, -2}};
            gtx_hit hit = cast(caster, down, 0);
            assert_int_equal(hit.patch, 0);
            assert_float_equal(hit.t, 3.75f, 1e-6f);
            assert_float_equal(hit.x, i * 0.5f, 1e-5f);
            assert_float_equal(hit.y, j * 0.5f, 1e-5f);
        }
    /* Within the plane of the height field nothing is crossed; just past the border neither. */
    for (int k = 0; k < 4; ++k) {
        gtx_ray flat = {.origin = {-1, 1, 0.5f},
                        .direction = {k & 1 ? 1.f : 0, k & 2 ? 1.f : 0, 0}};
        assert_int_equal(cast(caster, flat, GTX_RAY_TWO_SIDED).patch, UINT32_MAX);
    }
    gtx_ray past = {.origin = {3.8751f, 1, 8}, .direction = {0, 0, -1}};
    assert_int_equal(cast(caster, past, 0).patch, UINT32_MAX);
    gtx_caster_destroy(caster);
    gtx_close(asset);
}

static void slope_field(const gtx_patch *patch, double x, double y, const void *user,
                        fixture_texel *out)
{
    (void)patch;
    (void)user;
    (void)y;
    out->height = x / 127;
    out->trim = -5;
}

static void grazing_rays_meet_a_ramp(void **state)
{
    (void)state;
    /* z = x / 127 * 2 over x in 0..12.7; rays along -x at a height h meet it at x = 63.5 h / 10. */
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, 128, 16, 0.1, 2), slope_field, NULL};
    gtx_asset *asset = fixture_build(&patch, 1, 8, 1);
    gtx_caster *caster = caster_of(asset, 0);
    for (int i = 1; i < 2000; ++i) {
        float h = i * 0.001f;
        gtx_ray level = {.origin = {-3, 0.73f, h}, .direction = {1, 0, 0}};
        gtx_hit hit = cast(caster, level, 0);
        assert_int_equal(hit.patch, 0);
        assert_float_equal(hit.t, 3 + h * 6.35, 2e-4);
        /* Steeper than the ramp by a millionth from below it: no crossing from above. */
        gtx_ray under = {.origin = {-1, 0.73f, -0.2f}, .direction = {12.7f, 0, 2.00001f}};
        assert_int_equal(cast(caster, under, 0).patch, UINT32_MAX);
    }
    gtx_caster_destroy(caster);
    gtx_close(asset);
}

static void half_field(const gtx_patch *patch, double x, double y, const void *user,
                       fixture_texel *out)
{
    (void)patch;
    (void)user;
    (void)y;
    out->height = 0.5;
    out->trim = x - 7.5;
}

static void trim_ends_the_field(void **state)
{
    (void)state;
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, 16, 16, 1, 1), half_field, NULL};
    gtx_asset *asset = fixture_build(&patch, 1, 8, 1);
    for (uint32_t level = 0; level < 3; ++level) {
        gtx_caster *caster = caster_of(asset, level);
        float limit = 7.5f + 0.3f * (float)(1 << level);
        gtx_ray ray = {.origin = {limit - 0.001f, 7.3f, 4}, .direction = {0, 0, -1}};
        assert_int_equal(cast(caster, ray, 0).patch, 0);
        ray.origin[0] = limit + 0.001f;
        assert_int_equal(cast(caster, ray, 0).patch, UINT32_MAX);
        assert_int_equal(cast(caster, ray, GTX_RAY_EXHAUSTIVE).patch, UINT32_MAX);
        gtx_caster_destroy(caster);
    }
    gtx_close(asset);
}

/* Many patches: the hierarchy finds what a look at each of them finds. */
static void a_field_of_patches(void **state)
{
    (void)state;
    enum { COUNT = 200 };
    static fixture_patch patches[COUNT];
    uint64_t seed = 11;
    for (int i = 0; i < COUNT; ++i) {
        const double corner[3] = {20 * uniform(&seed), 20 * uniform(&seed), 20 * uniform(&seed)};
        patches[i] = (fixture_patch){fixture_frame(corner, 8, 8, 0.3, 0.5), half_field, NULL};
        if (i & 1) { /* looking the other way */
            patches[i].frame.axis_x[0] = -1;
            patches[i].frame.axis_z[2] = -1;
        }
    }
    gtx_asset *asset = fixture_build(patches, COUNT, 8, 1);
    tally t = compare(asset, 0, 0, 20000, 1);
    assert_true(t.hits > 500);
    assert_int_equal(t.wrong, 0);
    gtx_close(asset);
}

static void dust_field(const gtx_patch *patch, double x, double y, const void *user,
                       fixture_texel *out)
{
    (void)patch;
    (void)user;
    out->height = ((int)x + (int)y) % 2 ? 0.5 : -1;
    out->trim = -1;
}

static void codes_without_a_cell_are_no_surface(void **state)
{
    (void)state;
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, 8, 8, 1, 1), dust_field, NULL};
    gtx_asset *asset = fixture_build(&patch, 1, 8, 1);
    for (uint32_t level = 0; level < 8; ++level) {
        gtx_caster *caster = caster_of(asset, level);
        gtx_ray ray = {.origin = {3, 2, 4}, .direction = {0.01f, 0.02f, -1}};
        assert_int_equal(cast(caster, ray, 0).patch, UINT32_MAX);
        gtx_caster_destroy(caster);
    }
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bumpy_agrees_with_every_cell),
        cmocka_unit_test(sphere_agrees_with_every_cell),
        cmocka_unit_test(two_sided_is_a_flag_of_patch_or_ray),
        cmocka_unit_test(sphere_is_a_sphere),
        cmocka_unit_test(along_the_axes),
        cmocka_unit_test(grazing_rays_meet_a_ramp),
        cmocka_unit_test(trim_ends_the_field),
        cmocka_unit_test(a_field_of_patches),
        cmocka_unit_test(codes_without_a_cell_are_no_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
