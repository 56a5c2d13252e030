/* Maps in blocks: what they take, how far their picture is from that of texels, and edits. */
#include "painted.h"

static const struct {
    gtx_compression kind;
    double share;             /* of the bytes of colour, material and emission */
    double least_psnr;        /* of pictures whose maps alone differ; with normals */
} kinds[] = {{GTX_COMPRESS_BC, 0.28, 34},
             {GTX_COMPRESS_ETC2, 0.19, 31},
             {GTX_COMPRESS_BC_SMALL, 0.19, 31}};

enum { KINDS = sizeof kinds / sizeof *kinds };

static gtx_model *model_of(stage *s, const gtx_asset *asset, gtx_compression kind, bool normals)
{
    gtx_error error = {0};
    gtx_model *model = NULL;
    const gtx_model_desc desc = {.compress = kind, .compress_normals = normals};
    must(gtx_model_prepare(asset, &desc, &model, &error), &error);
    const gtx_result result = gtx_model_upload(s->renderer, model, 10000, NULL, &error);
    uint32_t done = 0;
    if (result == GTX_ERROR_UNSUPPORTED) {
        gtx_model_destroy(s->renderer, model);
        return NULL;
    }
    while (!done)
        must(gtx_model_upload(s->renderer, model, 10000, &done, &error), &error);
    return model;
}

static void draw(stage *s, const gtx_model *model, const gtx_view *view)
{
    gtx_instance instance = {.model = model};
    memcpy(instance.transform, identity, sizeof identity);
    stage_draw(s, view, &instance, 1);
}

static double psnr_of(const uint8_t *a, const uint8_t *b)
{
    double sum = 0, count = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        for (int c = 0; c < 3 && a[4 * i + 3]; ++c) {
            sum += (a[4 * i + c] - b[4 * i + c]) * (a[4 * i + c] - b[4 * i + c]);
            count += 1;
        }
        assert_int_equal(a[4 * i + 3], b[4 * i + 3]); /* heights are exact */
    }
    return 10 * log10(255 * 255 * count / sum);
}

static void blocks_look_like_texels(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *plain = fixture_sphere(2, 48, 8);
    gtx_asset *asset = painted(plain, 3, UINT32_MAX, false);
    gtx_camera camera = camera_around(asset);
    gtx_view view = view_of(&camera);
    uint8_t *expected = malloc(sizeof s->color);
    int tried = 0;
    for (int k = 0; k < 2 * KINDS; ++k) {
        const bool normals = k % 2;
        gtx_model *exact = model_of(s, asset, GTX_COMPRESS_NONE, false);
        gtx_model *model = model_of(s, asset, kinds[k / 2].kind, normals);
        for (uint32_t level = 0; model && level < 3; ++level) {
            view.level = level + 1;
            draw(s, exact, &view);
            memcpy(expected, s->color, sizeof s->color);
            draw(s, model, &view);
            const double psnr = psnr_of(expected, s->color);
            print_message("kind %d, normals %d, level %u: %.2f dB\n", (int)kinds[k / 2].kind,
                          normals, level, psnr);
            if (!(psnr > kinds[k / 2].least_psnr))
                fail_msg("%.2f dB by blocks of kind %d at level %u", psnr,
                         (int)kinds[k / 2].kind, level);
        }
        const gtx_model_size all = gtx_model_gpu_size(exact), less = gtx_model_gpu_size(model);
        if (model) {
            assert_true((double)less.color < kinds[k / 2].share * (double)all.color);
            assert_true(normals ? less.geometry < all.geometry : less.geometry == all.geometry);
            tried += 1;
        }
        gtx_model_destroy(s->renderer, model);
        gtx_model_destroy(s->renderer, exact);
    }
    free(expected);
    gtx_close(asset);
    gtx_close(plain);
    assert_true(tried >= 2); /* OpenGL 4.3 and OpenGL ES 3.0 read ETC2 */
}

/* Edits `patch` of the first asset's model, and compares it with the second's. */
static void expect_edited(stage *s, gtx_model *model, const gtx_asset *change, uint32_t patch,
                          gtx_compression kind)
{
    gtx_error error = {0};
    gtx_camera camera = camera_around(change);
    gtx_view view = view_of(&camera);
    uint8_t *before = malloc(sizeof s->color), *expected = malloc(sizeof s->color);
    view.method = GTX_METHOD_CAST;
    gtx_model *whole = model_of(s, change, kind, true);
    draw(s, model, &view);
    memcpy(before, s->color, sizeof s->color);
    must(gtx_model_update(s->renderer, model, change, patch, &error), &error);
    for (view.level = 1; view.level < 4; ++view.level) {
        draw(s, whole, &view);
        memcpy(expected, s->color, sizeof s->color);
        draw(s, model, &view);
        assert_memory_equal(expected, s->color, sizeof s->color);
        assert_true(view.level > 1 || memcmp(before, expected, sizeof s->color));
    }
    const gtx_model_size a = gtx_model_gpu_size(model), b = gtx_model_gpu_size(whole);
    assert_true(a.geometry == b.geometry && (a.color == b.color || kind));
    gtx_model_destroy(s->renderer, whole);
    free(before);
    free(expected);
}

static void edits_are_encoded_anew(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_asset *plain = fixture_sphere(2, 48, 8);
    gtx_asset *asset = painted(plain, 3, UINT32_MAX, false);
    gtx_asset *change = painted(asset, 4, 0, false);
    for (int k = 0; k < KINDS; ++k) {
        gtx_model *model = model_of(s, asset, kinds[k].kind, true);
        if (model)
            expect_edited(s, model, change, 0, kinds[k].kind);
        gtx_model_destroy(s->renderer, model);
    }
    gtx_close(change);
    gtx_close(asset);
    gtx_close(plain);
}

/* A material that is the same everywhere takes a texel, until an edit. */
static void one_material_is_one_texel(void **state)
{
    STAGE_OR_SKIP(state);
    gtx_texture t;
    gtx_asset *plain = fixture_sphere(2, 48, 8);
    gtx_asset *asset = painted(plain, 3, UINT32_MAX, true);
    gtx_asset *repainted = painted(asset, 4, 0, true), *changed = painted(asset, 4, 0, false);
    gtx_model *model = model_of(s, asset, GTX_COMPRESS_NONE, false);
    assert_true(gtx_model_texture(model, GTX_SLOT_MATERIALS, &t));
    assert_true(t.width == 1 && t.height == 1 && t.layers == 1 && t.levels == 1);
    expect_edited(s, model, repainted, 0, GTX_COMPRESS_NONE);
    expect_edited(s, model, changed, 0, GTX_COMPRESS_NONE);
    gtx_model_destroy(s->renderer, model);
    gtx_close(repainted);
    gtx_close(changed);
    gtx_close(asset);
    gtx_close(plain);
}

static void unknown_blocks_are_refused(void **state)
{
    (void)state;
    gtx_asset *asset = fixture_sphere(2, 48, 8);
    gtx_model *model = NULL;
    const gtx_model_desc desc = {.compress = (gtx_compression)4};
    assert_int_equal(gtx_model_prepare(asset, &desc, &model, NULL), GTX_ERROR_ARGUMENT);
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_look_like_texels),
        cmocka_unit_test(edits_are_encoded_anew),
        cmocka_unit_test(one_material_is_one_texel),
        cmocka_unit_test(unknown_blocks_are_refused),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
