/* Assets combined as solids, against exact spheres and cubes. */
#include "edit/combined.h"

static const double PI = 3.14159265358979;
static const double AWAY[3] = {0.9, 0.35, 0.2}; /* of the second ball */

static void near_to(double value, double wanted, double share)
{
    if (!(fabs(value - wanted) <= share * fabs(wanted)))
        fail_msg("%.9g is not within %g of %.9g", value, share, wanted);
}

static double ball_volume(double r)
{
    return 4 * PI / 3 * r * r * r;
}

/* What two balls have in common. */
static double lens_volume(double r, double s, double d)
{
    const double c = r + s - d;
    return PI * c * c * (d * d + 2 * d * (r + s) - 3 * (r - s) * (r - s)) / (12 * d);
}

static bool wanted(gtx_combine_op op, bool a, bool b)
{
    return op == GTX_COMBINE_UNION ? a || b : op == GTX_COMBINE_INTERSECT ? a && b : a && !b;
}

/* Distances outside the unit ball, and outside that of radius 0.8 at AWAY. */
static void distances(const double p[3], double out[2])
{
    double square[2] = {0, 0};
    for (int k = 0; k < 3; ++k) {
        square[0] += p[k] * p[k];
        square[1] += (p[k] - AWAY[k]) * (p[k] - AWAY[k]);
    }
    out[0] = sqrt(square[0]) - 1;
    out[1] = sqrt(square[1]) - 0.8;
}

/* Rays from all around into all places: what they meet first is the front of a surface that is
 * there, no farther from the crossing than was told; and they meet it if they pass inside. */
static void expect_surface(const outcome *o, gtx_combine_op op)
{
    gtx_caster *caster = NULL;
    uint64_t seed = 77;
    unsigned met = 0, backs = 0;
    must(gtx_caster_create(o->asset, NULL, &caster, NULL));
    for (int i = 0; i < 60000; ++i) {
        gtx_ray ray = {.t_max = 0};
        gtx_hit hit;
        double p[3], d[2], deepest = INFINITY;
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = (float)(8 * next_random(&seed) - 4);
            ray.direction[k] = (float)(2 * next_random(&seed) - 0.8) - ray.origin[k];
        }
        if (fabsf(ray.origin[0]) < 2.2f && fabsf(ray.origin[1]) < 2 && fabsf(ray.origin[2]) < 2)
            continue;
        must(gtx_raycast(caster, &ray, &hit, 1, GTX_RAY_TWO_SIDED));
        for (int s = 0; s <= 400; ++s) { /* past the place aimed at */
            for (int k = 0; k < 3; ++k)
                p[k] = (double)ray.origin[k] + s / 200. * (double)ray.direction[k];
            distances(p, d);
            const double outside = op == GTX_COMBINE_UNION ? fmin(d[0], d[1])
                                   : op == GTX_COMBINE_INTERSECT ? fmax(d[0], d[1])
                                                                 : fmax(d[0], -d[1]);
            deepest = fmin(deepest, outside);
        }
        if (hit.patch == UINT32_MAX) {
            if (deepest < -0.01)
                fail_msg("op %d: a ray passes %g deep", (int)op, -deepest);
            continue;
        }
        for (int k = 0; k < 3; ++k)
            p[k] = (double)ray.origin[k] + (double)hit.t * (double)ray.direction[k];
        distances(p, d);
        const double e = 0.003 + o->told.error; /* cells are flat, and steps high */
        const bool of_a = fabs(d[0]) < 0.003, of_b = fabs(d[1]) < 0.003;
        /* From behind the rim that stands out at the crossing, and nothing else. */
        backs += hit.back && fmax(fabs(d[0]), fabs(d[1])) > e;
        if (hit.back)
            continue;
        if (!of_a && !of_b)
            fail_msg("op %d: hit %g and %g off", (int)op, d[0], d[1]);
        const bool keeps_in[2] = {op == GTX_COMBINE_INTERSECT, op != GTX_COMBINE_UNION};
        if (!((of_a && (keeps_in[0] ? d[1] < e : d[1] > -e)) ||
              (of_b && (keeps_in[1] ? d[0] < e : d[0] > -e))))
            fail_msg("op %d: %g and %g off, beyond %g", (int)op, d[0], d[1], e);
        ++met;
    }
    if (met < 2000 || backs > 3) /* the balls alone let one through */
        fail_msg("op %d: %u rays met it, %u of them from behind", (int)op, met, backs);
    gtx_caster_destroy(caster);
}

static void balls_combine(void **state)
{
    (void)state;
    const double d = sqrt(AWAY[0] * AWAY[0] + AWAY[1] * AWAY[1] + AWAY[2] * AWAY[2]);
    const double lens = lens_volume(1, 0.8, d), v[2] = {ball_volume(1), ball_volume(0.8)};
    const double volumes[3] = {v[0] + v[1] - lens, lens, v[0] - lens};
    gtx_asset *a = fixture_sphere(1, 112, 16);
    gtx_asset *b = moved(fixture_sphere(0.8, 96, 8), AWAY[0], AWAY[1], AWAY[2]);
    for (int op = 0; op < 3; ++op) {
        const outcome o = combine(a, b, (gtx_combine_op)op);
        gtx_info info;
        gtx_get_info(o.asset, &info);
        assert_int_equal(info.height_bits, 16);
        near_to(o.facts.volume, volumes[op], 8e-3);
        assert_true(o.told.error > 0 && o.told.error < 0.06);
        assert_true(o.told.cut[0] && o.told.cut[1]);
        for (int side = 0; side < 2; ++side)
            assert_int_equal(o.told.whole[side] + o.told.cut[side] + o.told.dropped[side], 6);
        expect_surface(&o, (gtx_combine_op)op);
        gtx_close(o.asset);
    }
    gtx_close(a);
    gtx_close(b);
}

/* Points of the result are inside as sets say, but close to a surface. */
static void insides_combine(void **state)
{
    (void)state;
    gtx_asset *a = fixture_sphere(1, 64, 8);
    gtx_asset *b = moved(fixture_sphere(0.8, 64, 8), AWAY[0], AWAY[1], AWAY[2]);
    for (int op = 0; op < 3; ++op) {
        const outcome o = combine(a, b, (gtx_combine_op)op);
        gtx_solid *solid = NULL;
        uint64_t seed = 3;
        must(gtx_solid_create(o.asset, NULL, &solid, NULL));
        for (int i = 0; i < 5000; ++i) {
            double p[3], d[2];
            float point[1][3];
            uint8_t inside;
            for (int k = 0; k < 3; ++k)
                point[0][k] = (float)(p[k] = 3.2 * next_random(&seed) - 1.3);
            distances(p, d);
            if (fmin(fabs(d[0]), fabs(d[1])) < 0.02)
                continue;
            must(gtx_solid_inside(solid, (const float (*)[3])point, &inside, 1));
            assert_int_equal(inside, wanted((gtx_combine_op)op, d[0] < 0, d[1] < 0));
        }
        gtx_solid_destroy(solid);
        gtx_close(o.asset);
    }
    gtx_close(a);
    gtx_close(b);
}

static void expect_told(const outcome *o, uint32_t whole_a, uint32_t whole_b)
{
    assert_int_equal(o->told.whole[0], whole_a);
    assert_int_equal(o->told.whole[1], whole_b);
    assert_int_equal(o->told.cut[0] + o->told.cut[1], 0);
    assert_true(o->told.error == 0);
}

static void what_does_not_meet_stays_whole(void **state)
{
    (void)state;
    gtx_asset *a = fixture_sphere(1, 64, 8);
    gtx_asset *far = moved(fixture_sphere(0.5, 48, 8), 3, 0, 0);
    gtx_asset *within = moved(fixture_sphere(0.5, 48, 8), 0.2, 0, 0);
    const gtx_combine_desc intersect = {.op = GTX_COMBINE_INTERSECT};
    const gtx_combine_desc subtract = {.op = GTX_COMBINE_SUBTRACT};
    const double v[2] = {ball_volume(1), ball_volume(0.5)};
    const struct {
        const gtx_asset *b;
        gtx_combine_op op;
        uint32_t whole[2];
        double volume;
    } cases[] = {{far, GTX_COMBINE_UNION, {6, 6}, v[0] + v[1]},
                 {far, GTX_COMBINE_SUBTRACT, {6, 0}, v[0]},
                 {within, GTX_COMBINE_UNION, {6, 0}, v[0]},
                 {within, GTX_COMBINE_INTERSECT, {0, 6}, v[1]},
                 {within, GTX_COMBINE_SUBTRACT, {6, 6}, v[0] - v[1]}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        const outcome o = combine(a, cases[i].b, cases[i].op);
        expect_told(&o, cases[i].whole[0], cases[i].whole[1]);
        near_to(o.facts.volume, cases[i].volume, 8e-3);
        gtx_close(o.asset);
    }
    refused(a, far, &intersect, GTX_ERROR_EMPTY, "nothing is left");
    refused(within, a, &subtract, GTX_ERROR_EMPTY, "nothing is left");
    gtx_close(a);
    gtx_close(far);
    gtx_close(within);
}

/* Turned round, a patch shows the same points from the other side; normals turn with it. */
static void hollows_face_inwards(void **state)
{
    (void)state;
    gtx_asset *a = fixture_sphere(1, 64, 8), *b = fixture_sphere(0.5, 48, 8);
    const outcome o = combine(a, b, GTX_COMBINE_SUBTRACT);
    gtx_caster *casters[2] = {NULL, NULL};
    uint64_t seed = 12;
    must(gtx_caster_create(b, NULL, &casters[0], NULL));
    must(gtx_caster_create(o.asset, NULL, &casters[1], NULL));
    for (int i = 0; i < 3000; ++i) {
        gtx_ray ray = {.t_max = 1.2f};
        gtx_hit out, in;
        for (int k = 0; k < 3; ++k)
            ray.direction[k] = (float)(next_random(&seed) - 0.5);
        const double length = sqrt((double)(ray.direction[0] * ray.direction[0] +
                                            ray.direction[1] * ray.direction[1] +
                                            ray.direction[2] * ray.direction[2]));
        for (int k = 0; k < 3; ++k)
            ray.direction[k] = (float)(0.55 * ray.direction[k] / length);
        must(gtx_raycast(casters[0], &ray, &out, 1, GTX_RAY_TWO_SIDED));
        must(gtx_raycast(casters[1], &ray, &in, 1, 0));
        assert_true(out.back == 1 && in.back == 0);
        assert_true(fabsf(in.t - out.t) < 1e-4f);
        for (int k = 0; k < 3; ++k)
            assert_true(fabsf(in.normal[k] + out.normal[k]) < 1e-3f);
        assert_true(in.normal[0] * ray.direction[0] + in.normal[1] * ray.direction[1] +
                        in.normal[2] * ray.direction[2] < 0);
    }
    gtx_caster_destroy(casters[0]);
    gtx_caster_destroy(casters[1]);
    gtx_close(o.asset);
    gtx_close(a);
    gtx_close(b);
}

static void surfaces_that_coincide_count_once(void **state)
{
    (void)state;
    gtx_asset *ball = fixture_sphere(1, 64, 8), *other = fixture_sphere(1, 48, 16);
    gtx_asset *cube = solid_cube(64, 8), *beside = moved(solid_cube(64, 8), 2, 0, 0);
    const gtx_combine_desc intersect = {.op = GTX_COMBINE_INTERSECT};
    const gtx_combine_desc subtract = {.op = GTX_COMBINE_SUBTRACT};
    for (int op = 0; op < 2; ++op) {
        outcome o = combine(ball, ball, (gtx_combine_op)op);
        near_to(o.facts.volume, ball_volume(1), 8e-3);
        assert_int_equal(o.told.dropped[1], 6);
        gtx_close(o.asset);
        o = combine(ball, other, (gtx_combine_op)op);
        near_to(o.facts.volume, ball_volume(1), 8e-3);
        gtx_close(o.asset);
    }
    refused(ball, ball, &subtract, GTX_ERROR_EMPTY, "nothing is left");
    refused(cube, beside, &intersect, GTX_ERROR_EMPTY, "nothing is left");
    outcome o = combine(cube, beside, GTX_COMBINE_UNION);
    near_to(o.facts.volume, 16, 3e-3);
    near_to(o.facts.area, 40, 3e-3); /* no wall within */
    gtx_close(o.asset);
    o = combine(cube, beside, GTX_COMBINE_SUBTRACT);
    near_to(o.facts.volume, 8, 3e-3);
    gtx_close(o.asset);
    gtx_close(ball);
    gtx_close(other);
    gtx_close(cube);
    gtx_close(beside);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(balls_combine),
        cmocka_unit_test(insides_combine),
        cmocka_unit_test(what_does_not_meet_stays_whole),
        cmocka_unit_test(hollows_face_inwards),
        cmocka_unit_test(surfaces_that_coincide_count_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
