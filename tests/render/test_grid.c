/* Height fields drawn as displaced grids: what casting shows, however coarse; no more
 * blocks than are in view; and beside LOD meshes without a hole. */
#include "parts.h"

static int open_for_grids(void **state)
{
    return open_stage_as(state, false);
}

static gtx_view view_from(const gtx_asset *asset, float azimuth, float elevation, float distance)
{
    gtx_camera camera = camera_around(asset);
    camera.azimuth = azimuth;
    camera.elevation = elevation;
    camera.distance = distance;
    gtx_view view = view_of(&camera);
    view.viewport_height = STAGE_HEIGHT;
    return view;
}

static uint64_t triangles_of(stage *s, const gtx_view *view, const subject *shown)
{
    const uint64_t before = s->renderer->planner.grids.drawn;
    draw(s, view, GTX_METHOD_GRID, &shown->instance, 1, &first);
    return s->renderer->planner.grids.drawn - before;
}

/* Triangles over each cell: but for their twist what is cast. */
static void as_cast(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *const assets[] = {fixture_bumpy(8, 0), fixture_bumpy(16, GTX_PATCH_TWO_SIDED),
                                 fixture_sphere(radius, TEXELS, 8),
                                 fixture_sphere_without(radius, TEXELS, 16, 5)};
    for (size_t i = 0; i < sizeof assets / sizeof *assets; ++i) {
        subject shown = subject_open(s, assets[i]);
        for (int turn = 0; turn < 6; ++turn) {
            gtx_view view = view_from(shown.asset, 61.0f * (float)turn, 15.0f * (float)(turn - 2),
                                      turn % 2 ? 2.6f : 3.4f);
            view.level = 1;
            expect_as_cast(s, &view, &shown.instance);
        }
        subject_close(s, &shown);
    }
}

/* Without colours they are lit at their corners, seen from the front or from behind. */
static void lit_at_corners(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *const assets[] = {
        with_lod_meshes(fixture_bumpy(16, GTX_PATCH_TWO_SIDED), NULL, 0, 0, LOD_PLAIN),
        with_lod_meshes(fixture_sphere(radius, TEXELS, 8), NULL, 0, 0, LOD_PLAIN),
        with_lod_meshes(fixture_sphere_without(radius, TEXELS, 16, 5), NULL, 0,
                        GTX_PATCH_TWO_SIDED, LOD_PLAIN)};
    uint32_t met = 0;
    for (size_t i = 0; i < sizeof assets / sizeof *assets; ++i) {
        subject shown = subject_open(s, assets[i]);
        for (int turn = 0; turn < 6; ++turn) {
            gtx_view view = view_from(shown.asset, 61.0f * (float)turn, 15.0f * (float)(turn - 2),
                                      turn % 2 ? 2.6f : 1.7f);
            view.max_error = 0.1f;
            draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &first);
            draw(s, &view, GTX_METHOD_GRID, &shown.instance, 1, &second);
            for (uint32_t looks = 0; looks < GTX_GRID_LOOKS; ++looks)
                met |= (s->renderer->planner.grids.index_count[looks] > 0) << looks;
            const difference d = compare(&first, &second), back = compare(&second, &first);
            if (d.both < 200 || d.holes || back.holes > 4 || d.mean > 2)
                fail_msg("%zu, %d: %ld pixels, %ld and %ld holes, colours differ by %g", i, turn,
                         d.both, d.holes, back.holes, d.mean);
        }
        subject_close(s, &shown);
    }
    for (uint32_t looks = 0; looks < GTX_GRID_LOOKS; looks += 2) /* whole, trimmed, behind */
        assert_true(met >> looks & 1);
}

/* Every pass draws the same depth, bit for bit, whole blocks and trimmed ones. */
static void passes_agree(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = sphere_open(s);
    static const gtx_method methods[2] = {GTX_METHOD_GRID, GTX_METHOD_AUTO};
    for (int i = 0; i < 2; ++i) {
        gtx_view view = standing(i);
        view.pass = GTX_PASS_DEPTH;
        draw(s, &view, methods[i], &shown.instance, 1, &first);
        view.pass = GTX_PASS_FORWARD;
        draw(s, &view, methods[i], &shown.instance, 1, &second);
        assert_memory_equal(first.depth, second.depth, sizeof first.depth);
        assert_true(compare(&first, &second).both > STAGE_PIXELS / 4);
    }
    subject_close(s, &shown);
}

/* The coarser it may be the fewer triangles, and never a hole, or an outline that is off by more
 * than a pixel. */
static void coarser_keeps_the_error(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_sphere(radius, TEXELS, 16));
    uint64_t coarse = 0, fine = 0;
    for (int way = 0; way < 8; ++way) {
        gtx_view view = standing((float)way);
        uint64_t last = UINT64_MAX;
        draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &second);
        static const float errors[] = {1e-3f, 0.25f, 0.5f, 1};
        for (int e = 0; e < 4; ++e) {
            view.max_error = errors[e];
            const uint64_t triangles = triangles_of(s, &view, &shown);
            const difference d = compare(&second, &first), back = compare(&first, &second);
            assert_true(triangles && triangles <= last);
            last = triangles;
            assert_int_equal(d.holes, 0);
            assert_int_equal(back.holes, 0); /* nothing beyond a pixel of the outline */
        }
        coarse += last;
        view.max_error = 1e-3f;
        fine += triangles_of(s, &view, &shown);
    }
    assert_true(2 * coarse < fine);
    subject_close(s, &shown);
}

static void only_what_may_be_seen(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = subject_open(s, fixture_sphere(radius, TEXELS, 8));
    gtx_view view = view_from(shown.asset, 20, 30, 3);
    view.level = 1;
    const uint64_t front = triangles_of(s, &view, &shown);
    const uint64_t all = 6 * 2 * (TEXELS - 1) * (TEXELS - 1);
    assert_true(front > all / 4 && front < 6 * all / 10); /* not what faces away */
    view.projection[0] *= 8;
    view.projection[5] *= 8;
    assert_true(triangles_of(s, &view, &shown) < front / 8); /* nor beside the picture */
    for (int k = 0; k < 16; k += 4) /* nor behind the eye */
        view.view[k] *= -1, view.view[k + 2] *= -1;
    assert_int_equal(triangles_of(s, &view, &shown), 0);
    subject_close(s, &shown);
}

/* What lies behind grids is not drawn, and the picture stays the same to the last bit: of a sphere
 * that shows its inside through a hole, and of bumps. Without the viewport's width nothing is
 * hidden. */
static void nothing_shows_that_is_hidden(void **state)
{
    STAGE_OR_SKIP(state);
    if (!s->renderer->planner.tiles.max_texels)
        skip(); /* hidden ones are found where rays are cast by tiles */
    gtx_asset *const open = fixture_sphere_without(radius, TEXELS, 16, 5);
    subject shown = subject_open(
        s, with_lod_meshes(open, NULL, 0, GTX_PATCH_TWO_SIDED, LOD_PLAIN));
    uint64_t all = 0, left = 0;
    for (int turn = 0; turn < 24; ++turn) {
        gtx_view view = turn % 2 ? standing((float)turn)
                                 : view_from(shown.asset, 61.0f * (float)turn,
                                             15.0f * (float)(turn % 11 - 5), 1.4f);
        view.max_error = 0.2f;
        all += triangles_of(s, &view, &shown);
        second = first;
        view.viewport_width = STAGE_WIDTH;
        left += triangles_of(s, &view, &shown);
        assert_memory_equal(first.color, second.color, sizeof first.color);
        assert_memory_equal(first.depth, second.depth, sizeof first.depth);
    }
    subject_close(s, &shown);
    if (!left || 10 * left > 9 * all)
        fail_msg("%llu of %llu triangles", (unsigned long long)left, (unsigned long long)all);
}

/* What a grid's triangle takes decides between grids and rays. A grid beside what is cast hides
 * nothing from rays: rather than a few grids there are none. */
static void few_grids_are_none(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_planner *planner = &s->renderer->planner;
    const gtx_costs usual = planner->costs;
    subject shown = subject_open(s, fixture_sphere(radius, TEXELS, 8));
    for (int way = 0; way < 3; ++way) {
        gtx_view view = view_from(shown.asset, 29 * (float)way, 25, 3);
        by_tiles(&view);
        uint32_t cast[96], count = 0, changed = 0;
        for (float triangle = 1e-3f; triangle < 1e6f; triangle *= 1.25f) {
            planner->costs = (gtx_costs){100, 25, 5500, 75, triangle};
            draw(s, &view, GTX_METHOD_AUTO, &shown.instance, 1, &first);
            cast[count] = planner->plan.count;
            changed += count && cast[count] != cast[count - 1];
            assert_true(!count || cast[count] >= cast[count - 1]);
            ++count;
        }
        const uint32_t all = cast[count - 1];
        for (uint32_t i = 0; i < count; ++i)
            if (cast[i] < all && 4 * cast[i] > 3 * all)
                fail_msg("view %d: %u of %u patches are cast, the others grids", way, cast[i], all);
        assert_true(changed > 0);
        assert_true(all >= 3);
    }
    planner->costs = usual;
    subject_close(s, &shown);
}

/* Near patches by height fields, far ones by LOD meshes of several levels. */
static void ways_meet_without_a_hole(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = sphere_open(s);
    uint32_t mixed = 0, levels = 0;
    for (int way = 0; way < 26; ++way) {
        gtx_view view = standing((float)way);
        for (int e = 0; e < 12; ++e) {
            view.max_error = 0.3f * powf(1.6f, (float)e);
            draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &first);
            draw(s, &view, GTX_METHOD_AUTO, &shown.instance, 1, &second);
            const uint8_t *ways = s->renderer->planner.plan.ways;
            uint32_t met = 0;
            for (int p = 0; p < 6; ++p)
                met |= 1u << ways[p];
            mixed += (met & 1u << GTX_BY_HEIGHT_FIELD) && met >> GTX_BY_LOD;
            levels += (met >> GTX_BY_LOD & ((met >> GTX_BY_LOD) - 1)) != 0;
            const difference d = compare(&first, &second);
            if (view.max_error < 1.5f && d.holes)
                fail_msg("%ld holes: view %d, error %g", d.holes, way, (double)view.max_error);
        }
    }
    assert_true(mixed > 20);
    assert_true(levels > 20);
    subject_close(s, &shown);
}

/* Patches in standing views that are drawn by an LOD mesh of more than 400 triangles a patch: the
 * two finest levels. */
static uint32_t by_many_triangles(stage *s, uint16_t flags, bool tiles)
{
    gtx_asset *sphere = fixture_sphere(radius, TEXELS, 8);
    subject shown = subject_open(s, with_lod_as(sphere, radius, LOD_LEVELS, flags, LOD_COLORED));
    uint32_t count = 0;
    for (int way = 0; way < 8; ++way) {
        gtx_view view = standing((float)way);
        view.viewport_width = tiles ? STAGE_WIDTH : 0;
        for (view.max_error = 0.3f; view.max_error < 20; view.max_error *= 1.6f) {
            draw(s, &view, GTX_METHOD_AUTO, &shown.instance, 1, &first);
            const uint8_t *ways = s->renderer->planner.plan.ways;
            for (int p = 0; p < 6; ++p)
                count += ways[p] == GTX_BY_LOD || ways[p] == GTX_BY_LOD + 1;
        }
    }
    subject_close(s, &shown);
    return count;
}

static void two_sided_patches_take_few_triangles(void **state)
{
    STAGE_OR_SKIP(state);
    if (!s->renderer->planner.tiles.max_texels)
        skip();
    assert_true(by_many_triangles(s, 0, true) > 0);
    assert_true(by_many_triangles(s, GTX_PATCH_TWO_SIDED, false) > 0);
    assert_int_equal(by_many_triangles(s, GTX_PATCH_TWO_SIDED, true), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_cast),
        cmocka_unit_test(lit_at_corners),
        cmocka_unit_test(passes_agree),
        cmocka_unit_test(coarser_keeps_the_error),
        cmocka_unit_test(only_what_may_be_seen),
        cmocka_unit_test(nothing_shows_that_is_hidden),
        cmocka_unit_test(few_grids_are_none),
        cmocka_unit_test(ways_meet_without_a_hole),
        cmocka_unit_test(two_sided_patches_take_few_triangles),
    };
    return cmocka_run_group_tests(tests, open_for_grids, stage_close);
}
