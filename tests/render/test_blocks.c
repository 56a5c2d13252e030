/* Height fields whose blocks the GPU displaces: what casting shows, in every pass and by a main of
 * an engine's own, and beside LOD meshes without a hole. */
#include "parts.h"

static int open_on_gpu(void **state)
{
    return open_stage_as(state, true);
}

static gtx_view view_at(const gtx_asset *asset, int turn)
{
    gtx_camera camera = camera_around(asset);
    camera.azimuth = 61.0f * (float)turn;
    camera.elevation = 15.0f * (float)(turn - 2);
    camera.distance = turn % 2 ? 2.6f : 3.4f;
    camera.reversed_z = camera.zero_to_one = turn == 3;
    gtx_view view = view_of(&camera);
    view.viewport_height = STAGE_HEIGHT;
    view.level = 1;
    return view;
}

static void as_cast(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *const assets[] = {fixture_bumpy(8, 0), fixture_bumpy(16, GTX_PATCH_TWO_SIDED),
                                 fixture_sphere(radius, TEXELS, 8),
                                 fixture_sphere_without(radius, TEXELS, 16, 5)};
    uint32_t looks = 0;
    for (size_t i = 0; i < sizeof assets / sizeof *assets; ++i) {
        subject shown = subject_open(s, assets[i]);
        for (int turn = 0; turn < 6; ++turn) {
            gtx_view view = view_at(shown.asset, turn);
            view.level = i < 2 ? 1 : 1 + (uint32_t)turn % 3; /* coarse bumps are mostly twist */
            if (turn == 4) { /* mirrored, and of a transform that keeps no angles */
                shown.instance.transform[0] = -1;
                shown.instance.transform[5] = 0.7f;
            }
            expect_as_cast(s, &view, &shown.instance);
            for (uint32_t k = 0; k < GTX_BLOCK_LOOKS; ++k)
                looks |= (s->renderer->planner.grids.block_count[k] > 0) << k;
        }
        subject_close(s, &shown);
    }
    assert_int_equal(looks, (1 << GTX_BLOCK_LOOKS) - 1);
}

/* Every pass draws the same depth, bit for bit. */
static void passes_agree(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = sphere_open(s);
    static const gtx_pass others[] = {GTX_PASS_DEPTH, GTX_PASS_ID};
    for (int i = 0; i < 2; ++i) {
        gtx_view view = standing((float)i);
        view.pass = others[i];
        draw(s, &view, GTX_METHOD_AUTO, &shown.instance, 1, &first);
        view.pass = GTX_PASS_FORWARD;
        draw(s, &view, GTX_METHOD_AUTO, &shown.instance, 1, &second);
        assert_memory_equal(first.depth, second.depth, sizeof first.depth);
        assert_true(compare(&first, &second).both > STAGE_PIXELS / 4);
    }
    subject_close(s, &shown);
}

/* By a main that does what the stock one does. */
static void by_a_main_of_the_engines_own(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_error error = {0};
    gtx_shading *shading = NULL;
    must(gtx_shading_create(s->renderer, NORMALS_MAIN, &shading, &error), &error);
    subject shown = sphere_open(s);
    for (int i = 0; i < 3; ++i) {
        gtx_view view = standing((float)i);
        draw(s, &view, GTX_METHOD_GRID, &shown.instance, 1, &first);
        view.shading = shading;
        draw(s, &view, GTX_METHOD_GRID, &shown.instance, 1, &second);
        assert_memory_equal(first.depth, second.depth, sizeof first.depth);
        draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &first);
        const difference d = compare(&first, &second);
        assert_int_equal(d.holes, 0);
        assert_true(d.mean < 4);
    }
    gtx_shading_destroy(s->renderer, shading);
    subject_close(s, &shown);
}

/* Near patches by blocks, far ones by LOD meshes of several levels; nothing is cast. */
static void ways_meet_without_a_hole(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = sphere_open(s);
    uint32_t mixed = 0;
    for (int way = 0; way < 26; ++way) {
        gtx_view view = standing((float)way);
        for (int e = 0; e < 6; ++e) {
            view.max_error = 0.3f * powf(1.6f, (float)e);
            draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &first);
            draw(s, &view, GTX_METHOD_AUTO, &shown.instance, 1, &second);
            const gtx_planner *planner = &s->renderer->planner;
            uint32_t met = 0;
            for (int p = 0; p < 6; ++p)
                met |= 1u << planner->plan.ways[p];
            mixed += (met & 1u << GTX_BY_HEIGHT_FIELD) && met >> GTX_BY_LOD;
            const difference d = compare(&first, &second);
            if (view.max_error < 1.5f && d.holes)
                fail_msg("%ld holes: view %d, error %g", d.holes, way, (double)view.max_error);
        }
    }
    assert_true(mixed > 10);
    subject_close(s, &shown);
}

/* Where nothing is displaced, the same view is cast: what blocks take decides. */
static void costs_decide(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_planner *planner = &s->renderer->planner;
    subject shown = subject_open(s, fixture_sphere(radius, TEXELS, 8));
    for (int dear = 0; dear < 2; ++dear) {
        gtx_view view = standing(1);
        planner->costs = (gtx_costs){dear ? 1e9f : 1e-3f, 1, 1, 10, 0};
        draw(s, &view, GTX_METHOD_AUTO, &shown.instance, 1, &first);
        assert_int_equal(planner->plan.count > 0, dear);
    }
    planner->costs = (gtx_costs){0};
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_cast),
        cmocka_unit_test(passes_agree),
        cmocka_unit_test(by_a_main_of_the_engines_own),
        cmocka_unit_test(ways_meet_without_a_hole),
        cmocka_unit_test(costs_decide),
    };
    return cmocka_run_group_tests(tests, open_on_gpu, stage_close);
}
