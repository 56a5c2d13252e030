/* Edits of assets that shaders cast rays into: as if the set had been made of the edited ones. */
#include "floor.h"

#include <geotex/edit.h>

/* The second asset of a set, whose cells have the 16 bits of the first, stands on the floor. */
typedef struct update {
    gtx_asset *other;
    gtx_rays *rays;
    gtx_ray_instance instance;
    GLuint program;
    uint8_t *before;          /* the floor's colours */
} update;

static gtx_rays *rays_of(gtx_renderer *renderer, const update *u, const gtx_asset *asset)
{
    const gtx_asset *const list[] = {u->other, asset};
    const gtx_rays_desc desc = {.assets = list, 2, .max_instances = 1};
    gtx_rays *rays;
    gtx_error error = {0};
    must(gtx_rays_create(renderer, &desc, &rays, &error), &error);
    must(gtx_rays_place(renderer, rays, &u->instance, 1, &error), &error);
    return rays;
}

static update update_begin(stage *s, gtx_renderer *renderer, const gtx_asset *asset)
{
    update u = {.other = fixture_flat(0.5, 16), .instance = {.asset = 1}};
    memcpy(u.instance.transform, identity, sizeof identity);
    u.program = make_floor(s);
    u.rays = rays_of(renderer, &u, asset);
    u.before = malloc(sizeof s->color);
    draw_floor(s, u.rays, u.program);
    memcpy(u.before, s->color, sizeof s->color);
    return u;
}

static void update_end(stage *s, gtx_renderer *renderer, update *u)
{
    gtx_rays_bind(s->renderer, NULL, 0);
    gtx_rays_destroy(renderer, u->rays);
    gtx_close(u->other);
    s->gl.DeleteProgram(u->program);
    free(u->before);
}

/* The floor has changed, and is as if the set had been made of the edited asset. */
static void expect_rays_of(stage *s, gtx_renderer *renderer, const update *u,
                           const gtx_asset *edited)
{
    uint8_t *expected = malloc(sizeof s->color);
    gtx_rays *fresh = rays_of(renderer, u, edited);
    draw_floor(s, fresh, u->program);
    memcpy(expected, s->color, sizeof s->color);
    assert_memory_not_equal(u->before, s->color, sizeof s->color);
    draw_floor(s, u->rays, u->program);
    assert_memory_equal(expected, s->color, sizeof s->color);
    gtx_rays_destroy(renderer, fresh);
    free(expected);
}

/* A hill at the sphere's side throws its shadow. */
static void edits_are_seen(void **state)
{
    STAGE_OR_SKIP(state);
    static const gtx_edit_stamp_desc stamp = {.centre = {0, 1, 0}, .radius = 0.6f,
                                              .direction = {0, -1, 0}, .depth = -0.4f};
    gtx_error error = {0};
    gtx_asset *sphere = fixture_sphere(1, 48, 8);
    update u = update_begin(s, s->renderer, sphere);
    gtx_edit *edit;
    const gtx_asset *live;
    const uint32_t *patches;
    uint32_t count;
    must(gtx_edit_begin(sphere, NULL, &edit, &error), &error);
    must(gtx_edit_stamp(edit, &stamp, &error), &error);
    must(gtx_edit_refresh(edit, &live, &patches, &count, &error), &error);
    assert_true(count >= 1 && count < 6);
    for (uint32_t i = 0; i < count; ++i)
        must(gtx_rays_update(s->renderer, u.rays, 1, live, patches[i], &error), &error);
    must(gtx_rays_place(s->renderer, u.rays, &u.instance, 1, &error), &error);
    expect_rays_of(s, s->renderer, &u, live);
    update_end(s, s->renderer, &u);
    gtx_edit_end(edit);
    gtx_close(sphere);
}

static void one_height(const gtx_patch *patch, double x, double y, const void *user,
                       fixture_texel *out)
{
    (void)patch, (void)x, (void)y;
    out->height = *(const double *)user;
    out->trim = -3;
    out->normal[2] = 1;
}

/* A height field of more texels than a layer of the textures has. */
static gtx_asset *wide_field(double height)
{
    const double corner[3] = {-1.2, -1, 0};
    fixture_patch patch = {fixture_frame(corner, 1200, 1000, 0.002, 1), one_height, &height};
    patch.frame.flags = GTX_PATCH_TWO_SIDED;
    return fixture_build(&patch, 1, 8, 1);
}

/* Heights and outline of a strip across the whole height field. */
static void large_patches_are_seen(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_error error = {0};
    gtx_asset *field = wide_field(0.2), *edited = wide_field(0.8);
    const gtx_patch *p = &gtx_patches(edited)[0];
    gtx_info info;
    gtx_get_info(edited, &info);
    uint8_t *trim = (uint8_t *)(uintptr_t)gtx_map_data(edited, GTX_MAP_TRIM, 0, NULL);
    for (uint32_t y = 0; y < p->rect[3]; ++y)
        memset(trim + (size_t)(p->rect[1] + y) * info.page_width + p->rect[0] + 500, 255, 200);
    update u = update_begin(s, s->renderer, field);
    must(gtx_rays_update(s->renderer, u.rays, 1, edited, 0, &error), &error);
    must(gtx_rays_place(s->renderer, u.rays, &u.instance, 1, &error), &error);
    expect_rays_of(s, s->renderer, &u, edited);
    update_end(s, s->renderer, &u);
    gtx_close(field);
    gtx_close(edited);
}

/* What has failed has changed nothing, and can be done again. */
static void updates_without_memory(void **state)
{
    STAGE_OR_SKIP(state);
    counter c = {-1, 0};
    const gtx_allocator hooks = {counted_alloc, counted_free, &c};
    const gtx_renderer_desc own = {.load = gtx_offscreen_load, .allocator = &hooks};
    gtx_renderer *renderer;
    gtx_error error = {0};
    gtx_asset *sphere = fixture_sphere(1, 48, 8), *large = fixture_sphere(1.3, 48, 8);
    must(gtx_renderer_create(&own, &renderer, &error), &error);
    update u = update_begin(s, renderer, sphere);
    for (uint32_t patch = 0; patch < 6; ++patch) {
        gtx_result result = GTX_ERROR_MEMORY;
        for (long n = 0; result; ++n) {
            c.until_failure = n;
            result = gtx_rays_update(renderer, u.rays, 1, large, patch, &error);
            assert_true(result == GTX_OK ? n > 2 : result == GTX_ERROR_MEMORY);
        }
    }
    gtx_result result = GTX_ERROR_MEMORY;
    for (long n = 0; result; ++n) {
        c.until_failure = n;
        result = gtx_rays_place(renderer, u.rays, &u.instance, 1, &error);
        assert_true(result == GTX_OK ? n > 3 : result == GTX_ERROR_MEMORY);
    }
    c.until_failure = -1;
    expect_rays_of(s, renderer, &u, large);
    update_end(s, renderer, &u);
    gtx_renderer_destroy(renderer);
    assert_int_equal(c.bytes, 0);
    gtx_close(sphere);
    gtx_close(large);
}

static void others_are_refused(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *sphere = fixture_sphere(1, 48, 8);
    gtx_asset *other = fixture_sphere(1, 56, 8), *deep = fixture_sphere(1, 48, 16);
    update u = update_begin(s, s->renderer, sphere);
    const struct {
        gtx_rays *rays;
        const gtx_asset *asset;
        uint32_t index, patch;
    } bad[] = {{u.rays, other, 1, 0}, {u.rays, deep, 1, 0},  {u.rays, sphere, 1, 6},
               {u.rays, sphere, 0, 0}, {u.rays, sphere, 2, 0}, {u.rays, NULL, 1, 0},
               {NULL, sphere, 1, 0}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        assert_int_equal(gtx_rays_update(s->renderer, bad[i].rays, bad[i].index, bad[i].asset,
                                         bad[i].patch, NULL), GTX_ERROR_ARGUMENT);
    update_end(s, s->renderer, &u);
    gtx_close(sphere);
    gtx_close(other);
    gtx_close(deep);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edits_are_seen),
        cmocka_unit_test(large_patches_are_seen),
        cmocka_unit_test(updates_without_memory),
        cmocka_unit_test(others_are_refused),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
