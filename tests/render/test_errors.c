/* A failed call says no number that nobody has set: whatever the error held, every field is
 * written. What needs no context of geotex.h, edit.h and render.h. */
#define _POSIX_C_SOURCE 200809L
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/fixture.h"

#include <geotex/edit.h>
#include <geotex/render.h>

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static gtx_error error;

static gtx_error *noisy(void)
{
    memset(&error, 0xa5, sizeof error);
    return &error;
}

static void is_whole(const char *call, gtx_result result, gtx_result wanted)
{
    if (result != wanted || error.result != wanted)
        fail_msg("%s: %d and %d, not %d", call, result, error.result, wanted);
    const bool has_rule = wanted == GTX_ERROR_CORRUPT || wanted == GTX_ERROR_NOT_GTX ||
                          wanted == GTX_ERROR_TRUNCATED || wanted == GTX_ERROR_VERSION;
    if (!error.rule != !error.rule_name || (error.rule && !has_rule) ||
        (error.offset && !error.rule) || error.offset > 1 << 20 || error.rule > 999)
        fail_msg("%s: rule %u, offset %llu", call, error.rule, (unsigned long long)error.offset);
    if (error.rule_name)
        assert_true(strlen(error.rule_name) > 2);
    if (error.limit && (wanted != GTX_ERROR_LIMIT || strlen(error.limit) < 3))
        fail_msg("%s: a limit", call);
    const char *end = memchr(error.message, 0, sizeof error.message);
    if (!end || end == error.message || strchr(error.message, (char)0xa5))
        fail_msg("%s: '%.*s'", call, (int)sizeof error.message, error.message);
}

#define FAILS(wanted, call) is_whole(#call, call, GTX_ERROR_##wanted)

static void *no_memory(size_t size, void *user)
{
    (void)size;
    (void)user;
    return NULL;
}
static void no_free(void *memory, size_t size, void *user)
{
    (void)memory;
    (void)size;
    (void)user;
}
static const gtx_allocator none = {.alloc = no_memory, .free = no_free};

static void opening(void **state)
{
    gtx_asset *out, *asset = fixture_flat(0.5, 8);
    void *data;
    size_t size;
    (void)state;
    assert_int_equal(gtx_encode(asset, NULL, &data, &size, NULL), GTX_OK);
    const gtx_open_desc odd = {.reserved = {1}}, small = {.limits = {.texels = 1}};
    const gtx_open_desc poor = {.allocator = &none};
    const gtx_limits few = {.memory = 1}, marked = {.reserved = {0, 1}};
    FAILS(ARGUMENT, gtx_open_memory(NULL, 1, NULL, &out, noisy()));
    FAILS(ARGUMENT, gtx_open_memory(data, size, NULL, NULL, noisy()));
    FAILS(NOT_ZEROED, gtx_open_memory(data, size, &odd, &out, noisy()));
    FAILS(LIMIT, gtx_open_memory(data, size, &small, &out, noisy()));
    FAILS(MEMORY, gtx_open_memory(data, size, &poor, &out, noisy()));
    FAILS(TRUNCATED, gtx_open_memory(data, size - 64, NULL, &out, noisy()));
    FAILS(NOT_GTX, gtx_open_memory("not an asset", 12, NULL, &out, noisy()));
    ((uint8_t *)data)[size / 2] ^= 1;
    FAILS(CORRUPT, gtx_open_memory(data, size, NULL, &out, noisy()));
    FAILS(CORRUPT, gtx_validate(data, size, NULL, NULL, NULL, noisy()));
    FAILS(ARGUMENT, gtx_validate(NULL, size, NULL, NULL, NULL, noisy()));
    FAILS(NOT_ZEROED, gtx_validate(data, size, &marked, NULL, NULL, noisy()));
    FAILS(NOT_GTX, gtx_validate("x", 1, &few, NULL, NULL, noisy()));
    FAILS(READ, gtx_open_file("/nowhere/a.gtx", NULL, &out, noisy()));
    FAILS(READ, gtx_open_file("/", NULL, &out, noisy()));
    FAILS(ARGUMENT, gtx_open_file(NULL, NULL, &out, noisy()));
    free(data);
    gtx_close(asset);
}

static void making(void **state)
{
    gtx_asset *out, *asset = fixture_flat(0.5, 8);
    void *data;
    size_t size;
    (void)state;
    const gtx_encode_desc deep = {.zstd_level = 99}, poor = {.allocator = &none};
    const gtx_encode_desc odd = {.reserved = {0, 0, 1}};
    const gtx_asset_desc empty = {0}, marked = {.reserved = {1}};
    FAILS(ARGUMENT, gtx_encode(NULL, NULL, &data, &size, noisy()));
    FAILS(ARGUMENT, gtx_encode(asset, &deep, &data, &size, noisy()));
    FAILS(NOT_ZEROED, gtx_encode(asset, &odd, &data, &size, noisy()));
    FAILS(MEMORY, gtx_encode(asset, &poor, &data, &size, noisy()));
    FAILS(ARGUMENT, gtx_save_file(asset, NULL, NULL, noisy()));
    FAILS(MEMORY, gtx_save_file(asset, "/nowhere/a.gtx", &poor, noisy()));
    FAILS(WRITE, gtx_save_file(asset, "/nowhere/a.gtx", NULL, noisy()));
    FAILS(ARGUMENT, gtx_create(NULL, &out, noisy()));
    FAILS(ARGUMENT, gtx_create(&empty, &out, noisy()));
    FAILS(NOT_ZEROED, gtx_create(&marked, &out, noisy()));
    gtx_close(asset);
}

static void casting(void **state)
{
    gtx_caster *caster;
    gtx_scene *scene;
    gtx_asset *asset = fixture_flat(0.5, 8);
    (void)state;
    const gtx_caster_desc odd = {.reserved = {1}}, deep = {.level = 8}, poor = {.allocator = &none};
    const gtx_scene_instance bare = {.caster = NULL};
    FAILS(ARGUMENT, gtx_caster_create(NULL, NULL, &caster, noisy()));
    FAILS(NOT_ZEROED, gtx_caster_create(asset, &odd, &caster, noisy()));
    FAILS(ARGUMENT, gtx_caster_create(asset, &deep, &caster, noisy()));
    FAILS(MEMORY, gtx_caster_create(asset, &poor, &caster, noisy()));
    FAILS(ARGUMENT, gtx_scene_create(NULL, 1, NULL, &scene, noisy()));
    FAILS(ARGUMENT, gtx_scene_create(&bare, 1, NULL, &scene, noisy()));
    FAILS(MEMORY, gtx_scene_create(NULL, 0, &none, &scene, noisy()));
    gtx_close(asset);
}

static void editing(void **state)
{
    gtx_edit *edit, *other;
    gtx_asset *out, *asset = fixture_flat(0.5, 8);
    (void)state;
    const gtx_edit_desc odd = {.reserved = {1}}, poor = {.allocator = &none};
    const gtx_edit_blur still = {0}, marked = {.radius = 1, .reserved = {1}};
    const gtx_edit_blur wide = {.radius = 1e6f};
    const gtx_edit_stamp_desc bare = {0};
    const uint32_t outside[4] = {0, 0, 4000, 1};
    const float height = 0;
    FAILS(ARGUMENT, gtx_edit_begin(NULL, NULL, &other, noisy()));
    FAILS(NOT_ZEROED, gtx_edit_begin(asset, &odd, &other, noisy()));
    FAILS(MEMORY, gtx_edit_begin(asset, &poor, &other, noisy()));
    assert_int_equal(gtx_edit_begin(asset, NULL, &edit, NULL), GTX_OK);
    FAILS(ARGUMENT, gtx_edit_gaussian(edit, NULL, noisy()));
    FAILS(ARGUMENT, gtx_edit_gaussian(edit, &still, noisy()));
    FAILS(NOT_ZEROED, gtx_edit_gaussian(edit, &marked, noisy()));
    FAILS(LIMIT, gtx_edit_gaussian(edit, &wide, noisy()));
    FAILS(ARGUMENT, gtx_edit_high_boost(edit, NULL, 1, noisy()));
    FAILS(ARGUMENT, gtx_edit_pattern(edit, NULL, 1, 1, noisy()));
    FAILS(ARGUMENT, gtx_edit_apply(edit, NULL, NULL, noisy()));
    FAILS(ARGUMENT, gtx_edit_stamp(edit, NULL, noisy()));
    FAILS(ARGUMENT, gtx_edit_stamp(edit, &bare, noisy()));
    FAILS(ARGUMENT, gtx_edit_set_heights(edit, 0, outside, &height, noisy()));
    FAILS(ARGUMENT, gtx_edit_set_heights(edit, 9, outside, &height, noisy()));
    FAILS(ARGUMENT, gtx_edit_finish(NULL, &out, noisy()));
    FAILS(ARGUMENT, gtx_edit_refresh(NULL, NULL, NULL, NULL, noisy()));
    gtx_edit_end(edit);
    gtx_close(asset);
}

static void drawing(void **state)
{
    gtx_renderer *renderer;
    gtx_model *model;
    gtx_shading *shading;
    gtx_rays *rays;
    gtx_asset *asset = fixture_flat(0.5, 8);
    (void)state;
    const gtx_renderer_desc empty = {0};
    const gtx_model_desc poor = {.allocator = &none}, odd = {.reserved = {1}};
    FAILS(ARGUMENT, gtx_renderer_create(NULL, &renderer, noisy()));
    FAILS(ARGUMENT, gtx_renderer_create(&empty, &renderer, noisy()));
    FAILS(ARGUMENT, gtx_model_prepare(NULL, NULL, &model, noisy()));
    FAILS(MEMORY, gtx_model_prepare(asset, &poor, &model, noisy()));
    FAILS(NOT_ZEROED, gtx_model_prepare(asset, &odd, &model, noisy()));
    FAILS(ARGUMENT, gtx_model_upload(NULL, NULL, 0, NULL, noisy()));
    FAILS(ARGUMENT, gtx_model_create(NULL, asset, &model, noisy()));
    FAILS(ARGUMENT, gtx_model_update(NULL, NULL, asset, 0, noisy()));
    FAILS(ARGUMENT, gtx_shading_create(NULL, "", &shading, noisy()));
    FAILS(ARGUMENT, gtx_draw(NULL, NULL, NULL, 0, noisy()));
    FAILS(ARGUMENT, gtx_rays_create(NULL, NULL, &rays, noisy()));
    FAILS(ARGUMENT, gtx_rays_place(NULL, NULL, NULL, 0, noisy()));
    FAILS(ARGUMENT, gtx_rays_update(NULL, NULL, 0, asset, 0, noisy()));
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(opening), cmocka_unit_test(making),
                                       cmocka_unit_test(casting), cmocka_unit_test(editing),
                                       cmocka_unit_test(drawing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
