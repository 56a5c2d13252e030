/* LOD meshes lit at their vertices, and levels that are as near to the source as height fields. */
#include "pictures.h"

#include "asset/patch.h"
#include "base/alloc.h"
#include "frame/model.h"
#include "frame/pipelines.h"

static subject open_sphere(stage *s, lod_looks looks, uint16_t flags)
{
    gtx_asset *sphere = flags ? fixture_sphere_without(radius, TEXELS, 8, 1 << 4)
                              : fixture_sphere(radius, TEXELS, 8);
    return subject_open(s, with_lod_as(sphere, radius, LOD_LEVELS, flags, looks));
}

/* Draws of a frame: by lit LOD meshes, by others, and by height fields. */
typedef struct drawn {
    int lit, mapped, fields, backs;
} drawn;

static void count_draw(const gtx_frame_draw *draw, void *user)
{
    drawn *d = user;
    const gtx_technique technique = gtx_pipeline_technique(draw->pipeline);
    d->lit += technique == TECHNIQUE_LOD_LIT;
    d->mapped += technique == TECHNIQUE_LOD || technique == TECHNIQUE_LOD_FRONT;
    d->fields += draw->vertices != GTX_BUFFER_LOD_VERTICES;
    d->backs += draw->cull != GTX_CULL_BACK;
}

static drawn draws_of(const gtx_model *model, const gtx_view *view)
{
    drawn d = {0, 0, 0, 0};
    gtx_planner *planner = NULL;
    gtx_frame frame;
    gtx_error error = {0};
    gtx_instance instance = {.model = model};
    memcpy(instance.transform, identity, sizeof identity);
    must(gtx_planner_create(NULL, &planner, &error), &error);
    must(gtx_frame_begin(planner, view, &instance, 1, &frame, &error), &error);
    gtx_frame_draws(planner, count_draw, &d);
    gtx_planner_destroy(planner);
    return d;
}

/* From outside and, where a face is missing, at backs; as it is and mirrored. */
static void light_is_what_rays_find(void **state)
{
    STAGE_OR_SKIP(state);
    for (int i = 0; i < 8; ++i) {
        subject shown = open_sphere(s, LOD_PLAIN, i & 1 ? GTX_PATCH_TWO_SIDED : 0);
        gtx_camera camera = camera_around(shown.asset);
        camera.target[0] = camera.target[1] = camera.target[2] = 0;
        camera.azimuth = i & 1 ? 10 : 40;
        camera.elevation = i & 1 ? 5 : 30;
        camera.reversed_z = i >> 2;
        shown.instance.transform[0] = i & 2 ? -1 : 1;
        shown.instance.tint[0] = shown.instance.tint[3] = 1;
        shown.instance.tint[1] = 0.4f;
        gtx_view view = view_of(&camera);
        view.level = 0;
        draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &first);
        draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &second);
        const difference d = compare(&first, &second);
        assert_true(covers(&second, STAGE_WIDTH / 2, STAGE_HEIGHT / 2));
        assert_true(d.both > 5000 && d.mean < 1.5);
        view.method = GTX_METHOD_LOD;
        assert_int_equal(draws_of(shown.model, &view).lit, 1); /* both sides at once */
        assert_int_equal(draws_of(shown.model, &view).mapped, 0);
        subject_close(s, &shown);
    }
}

/* An engine's own main finds the same normals by rays, at vertices, and in displaced grids. */
static void own_mains_find_normals(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_error error = {0};
    gtx_shading *shading;
    must(gtx_shading_create(s->renderer, NORMALS_MAIN, &shading, &error), &error);
    for (int i = 0; i < 8; ++i) {
        subject shown = open_sphere(s, LOD_PLAIN, i & 1 ? GTX_PATCH_TWO_SIDED : 0);
        gtx_camera camera = camera_around(shown.asset);
        camera.azimuth = i & 1 ? 10 : 40;
        shown.instance.transform[0] = i & 2 ? -1 : 1;
        gtx_view view = view_of(&camera);
        view.level = 0;
        view.shading = shading;
        draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &first);
        draw(s, &view, i & 4 ? GTX_METHOD_GRID : GTX_METHOD_LOD, &shown.instance, 1, &second);
        const difference d = compare(&first, &second);
        /* The rim of the LOD mesh is a pixel off: 3.3 of a mean. */
        assert_true(d.both > 5000 && d.mean < (i == 1 || i == 3 ? 5 : 1.5));
        subject_close(s, &shown);
    }
    gtx_shading_destroy(s->renderer, shading);
}

/* Where vertices do not say all, maps are looked up. */
static void colors_are_looked_up(void **state)
{
    STAGE_OR_SKIP(state);
    static const lod_looks looks[] = {LOD_COLORED, LOD_SHINY, LOD_EVEN};
    for (int i = 0; i < 3; ++i) {
        subject shown = open_sphere(s, looks[i], GTX_PATCH_TWO_SIDED);
        gtx_camera camera = camera_around(shown.asset);
        gtx_view view = view_of(&camera);
        view.method = GTX_METHOD_LOD;
        view.level = 0;
        assert_int_equal(draws_of(shown.model, &view).lit, 0);
        assert_true(draws_of(shown.model, &view).mapped > 0);
        subject_close(s, &shown);
    }
}

/* A sphere without a face: from behind it no back is drawn, and nothing is missing; from before it
 * and from within they are. */
static void backs_are_left_out_where_none_shows(void **state)
{
    STAGE_OR_SKIP(state);
    for (int i = 0; i < 6; ++i) {
        subject shown = open_sphere(s, i & 1 ? LOD_PLAIN : LOD_COLORED, GTX_PATCH_TWO_SIDED);
        gtx_camera camera = camera_around(shown.asset);
        camera.target[0] = camera.target[1] = camera.target[2] = 0;
        camera.azimuth = i / 2 == 1 ? 10 : 190;
        camera.elevation = i / 2 == 1 ? 5 : -5;
        camera.distance = i / 2 == 2 ? 0.5f : camera.distance;
        gtx_view view = view_of(&camera);
        view.level = 1;
        view.method = GTX_METHOD_LOD;
        assert_int_equal(draws_of(shown.model, &view).backs > 0, i / 2 > 0);
        draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &first);
        draw(s, &view, GTX_METHOD_LOD, &shown.instance, 1, &second);
        const difference d = compare(&first, &second);
        if (i / 2 == 0) {
            assert_true(d.both > 5000 && d.either - d.both < 200);
            assert_true(d.mean < 1);
        }
        subject_close(s, &shown);
    }
}

/* A level within 1.7 texels is drawn where the view allows a hundredth of its error; one that may
 * be farther away is not. */
static void exact_levels_are_drawn_however_near(void **state)
{
    STAGE_OR_SKIP(state);
    static lod_level made;
    for (int i = 0; i < 2; ++i) {
        gtx_asset *sphere = fixture_sphere(radius, TEXELS, 8);
        const gtx_patch *patch = gtx_patches(sphere);
        make_lod_level(patch, 6, radius, 16, &made);
        made.lod.error = (i ? 1.6f : 1.8f) * patch->extent_x / patch->rect[2];
        subject shown = subject_open(s, with_lod_meshes(sphere, &made.lod, 1, 0, LOD_PLAIN));
        gtx_camera camera = camera_around(shown.asset);
        camera.distance = 1.6f;
        gtx_view view = view_of(&camera);
        view.method = GTX_METHOD_AUTO;
        view.viewport_height = STAGE_HEIGHT;
        view.max_error = made.lod.error * STAGE_HEIGHT / 400;
        const drawn d = draws_of(shown.model, &view);
        assert_int_equal(d.lit > 0, i);
        assert_int_equal(d.fields > 0, !i);
        subject_close(s, &shown);
    }
}

/* Where what faces the eye is picked: what has many pixels, each of which would look maps up, is
 * drawn by the finest level instead of one of few triangles. */
static void the_lit_level_is_drawn_where_it_takes_less(void **state)
{
    STAGE_OR_SKIP(state);
    subject shown = open_sphere(s, LOD_PLAIN, 0);
    gtx_lod_level *finest = shown.model->lods.levels;
    gtx_camera camera = camera_around(shown.asset);
    shown.model->bare = true; /* height fields are none of its ways */
    for (int i = 0; i < 4; ++i) {
        const bool picked = i & 1, large = i & 2;
        gtx_view view = view_of(&camera);
        view.method = GTX_METHOD_LOD;
        view.level = 0;
        view.viewport_height = (large ? 10 : 1) * STAGE_HEIGHT;
        view.max_error = large ? 500 : 50; /* of the coarsest level */
        if (picked)
            finest->faces = gtx_alloc_array(&shown.model->allocator, finest->triangle_count,
                                            sizeof *finest->faces);
        const drawn d = draws_of(shown.model, &view);
        assert_int_equal(d.lit, picked && large);
        assert_int_equal(d.mapped, !(picked && large));
        gtx_free_array(&shown.model->allocator, finest->faces, finest->triangle_count,
                       sizeof *finest->faces);
        finest->faces = NULL;
    }
    shown.model->bare = false;
    subject_close(s, &shown);
}

/* Coarser levels of a whole model by the normals of their vertices, where the host asks for it. */
static void coarse_levels_are_lit_where_asked(void **state)
{
    STAGE_OR_SKIP(state);
    static lod_level made[2];
    static uint8_t codes[2][2 * LOD_MAX_VERTICES];
    gtx_lod_mesh lods[2];
    gtx_asset *sphere = fixture_sphere(radius, TEXELS, 8);
    for (uint32_t k = 0; k < 2; ++k) {
        gtx_lod_mesh *lod = &made[k].lod;
        make_lod_level(gtx_patches(sphere), 6, radius, LOD_FINEST >> k, &made[k]);
        for (uint32_t v = 0; v < lod->vertex_count; ++v) {
            float n[3];
            for (uint32_t c = 0; c < 3; ++c)
                n[c] = lod->origin[c] + lod->step * made[k].positions[3 * v + c];
            gtx_encode_octahedral(n, codes[k] + 2 * v);
        }
        lod->normals = codes[k];
        lod->flags |= GTX_LOD_NORMALS;
        lods[k] = *lod;
    }
    subject shown = subject_open(s, with_lod_meshes(sphere, lods, 2, 0, LOD_PLAIN));
    gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    view.method = GTX_METHOD_LOD;
    view.level = 2;
    assert_int_equal(draws_of(shown.model, &view).lit, 0);
    const gtx_model_desc desc = {.light_vertices = 1};
    gtx_instance lit = shown.instance;
    gtx_model *model;
    gtx_error error = {0};
    uint32_t done;
    must(gtx_model_prepare(shown.asset, &desc, &model, &error), &error);
    must(gtx_model_upload(s->renderer, model, 0, &done, &error), &error);
    lit.model = model;
    assert_int_equal(draws_of(model, &view).lit, 1);
    assert_int_equal(draws_of(model, &view).mapped, 0);
    draw(s, &view, GTX_METHOD_CAST, &shown.instance, 1, &first);
    draw(s, &view, GTX_METHOD_LOD, &lit, 1, &second);
    const difference d = compare(&first, &second);
    assert_true(d.both > 5000 && d.mean < 1.5);
    gtx_model_destroy(s->renderer, model);
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_is_what_rays_find),
        cmocka_unit_test(own_mains_find_normals),
        cmocka_unit_test(colors_are_looked_up),
        cmocka_unit_test(backs_are_left_out_where_none_shows),
        cmocka_unit_test(exact_levels_are_drawn_however_near),
        cmocka_unit_test(the_lit_level_is_drawn_where_it_takes_less),
        cmocka_unit_test(coarse_levels_are_lit_where_asked),
    };
    return cmocka_run_group_tests(tests, open_stage, stage_close);
}
