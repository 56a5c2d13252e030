/* Maps in blocks: what they take, how far their picture is from that of texels, and edits. */
#include "painted.h"

#include "asset/blocks.h"
#include "base/bytes.h"

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

static gtx_model *prepared(const gtx_asset *asset, gtx_model_desc desc)
{
    gtx_error error = {0};
    gtx_model *model = NULL;
    must(gtx_model_prepare(asset, &desc, &model, &error), &error);
    return model;
}

/* Whether all textures of two models are the same. */
static bool same_textures(const gtx_model *a, const gtx_model *b)
{
    bool same = true;
    for (int slot = 0; slot < GTX_SLOT_COUNT; ++slot) {
        gtx_texture s, t;
        assert_int_equal(gtx_model_texture(a, (gtx_slot)slot, &s),
                         gtx_model_texture(b, (gtx_slot)slot, &t));
        assert_true(s.format == t.format && s.levels == t.levels && s.width == t.width);
        for (uint32_t k = 0; k < s.levels; ++k) {
            const size_t wide = s.width >> k, high = s.height >> k;
            const size_t blocks = (wide + 3) / 4 * ((high + 3) / 4);
            const size_t size = s.layers * (s.block_size ? blocks * s.block_size
                                                         : wide * high * s.texel_size);
            same = same && !memcmp(s.texels[k], t.texels[k], size);
        }
    }
    return same;
}

static gtx_asset *reopened(const void *file, size_t size)
{
    gtx_error error = {0};
    gtx_asset *asset = NULL;
    must(gtx_open_memory(file, size, NULL, &asset, &error), &error);
    return asset;
}

/* Of one kind in an asset that may have blocks of others: kept by a file, taken from it, and not
 * where the section is damaged. */
static void expect_kept(gtx_asset *asset, const gtx_asset *plain, gtx_model_desc desc)
{
    gtx_error error = {0};
    void *file;
    size_t size;
    gtx_info info;
    must(gtx_add_blocks(asset, &desc, &error), &error);
    gtx_get_info(asset, &info);
    must(gtx_encode(asset, &(gtx_encode_desc){.zstd_level = -1}, &file, &size, &error), &error);
    must(gtx_validate(file, size, NULL, NULL, NULL, &error), &error);
    gtx_model *encoded = prepared(plain, desc);
    gtx_asset *again = reopened(file, size);
    assert_true(again->blocks && again->info.content_hash == info.content_hash);
    for (int borrow = 0; borrow < 2; ++borrow) {
        desc.borrow = (uint32_t)borrow;
        gtx_model *kept = prepared(again, desc);
        assert_true(same_textures(encoded, kept));
        gtx_model_free(kept);
    }
    desc.borrow = 0;
    memset(again->blocks + again->blocks_size / 2, 0, again->blocks_size / 2); /* really these? */
    gtx_model *other = prepared(again, desc);
    assert_false(same_textures(encoded, other));
    gtx_model_free(other);
    gtx_close(again);

    uint8_t *at = file;
    while (memcmp(at, "BLKS", 4) != 0)
        at += 64;
    ((uint8_t *)file)[gtx_load_u64(at + 16) + gtx_load_u64(at + 24) - 40] ^= 1;
    again = reopened(file, size);
    assert_null(again->blocks);
    other = prepared(again, desc);
    assert_true(same_textures(encoded, other));
    gtx_model_free(other);
    gtx_model_free(encoded);
    gtx_close(again);
    free(file);
}

static void files_keep_blocks(void **state)
{
    (void)state;
    gtx_asset *sphere = fixture_sphere(2, 48, 8);
    gtx_asset *plain = painted(sphere, 3, UINT32_MAX, false);
    gtx_asset *asset = painted(sphere, 3, UINT32_MAX, false);
    for (int k = 0; k < 2 * KINDS; ++k)
        expect_kept(asset, plain, (gtx_model_desc){.compress = kinds[k / 2].kind,
                                                   .compress_normals = (uint32_t)k % 2});
    const size_t all = asset->blocks_size;
    assert_int_equal(gtx_add_blocks(asset, &(gtx_model_desc){.compress = GTX_COMPRESS_BC}, NULL),
                     GTX_OK);
    assert_int_equal(asset->blocks_size, all); /* each once */
    assert_int_equal(gtx_add_blocks(asset, &(gtx_model_desc){0}, NULL), GTX_ERROR_ARGUMENT);
    gtx_asset *edited = painted(asset, 4, 0, false);
    assert_null(edited->blocks);
    gtx_close(edited);
    gtx_close(asset);
    gtx_close(plain);
    gtx_close(sphere);
}

/* A section that says what cannot be is none: nothing is read beyond it. */
static void senseless_sections_are_none(void **state)
{
    (void)state;
    gtx_block_map maps[GTX_MAX_BLOCK_MAPS];
    gtx_asset *sphere = fixture_sphere(2, 48, 8);
    gtx_asset *asset = painted(sphere, 3, UINT32_MAX, false);
    const gtx_model_desc desc = {.compress = GTX_COMPRESS_BC, .compress_normals = 1};
    assert_int_equal(gtx_add_blocks(asset, &desc, NULL), GTX_OK);
    uint8_t *bytes = asset->blocks;
    const size_t size = asset->blocks_size;
    assert_int_equal(gtx_blocks_load(&asset->info, bytes, size, maps), 4);
    for (size_t less = 0; less < size; less += less < 80 ? 1 : 1000)
        assert_int_equal(gtx_blocks_load(&asset->info, bytes, less, maps), 0);
    for (size_t i = 0; i < 36; ++i)
        for (uint8_t flip = 1; flip; flip = (uint8_t)(flip << 1)) {
            bytes[i] ^= flip;
            const uint32_t count = gtx_blocks_load(&asset->info, bytes, size, maps);
            assert_true(count == 0 || gtx_blocks_size(&asset->info, maps, count) == size);
            bytes[i] ^= flip;
        }
    gtx_close(asset);
    gtx_close(sphere);
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
        cmocka_unit_test(files_keep_blocks),
        cmocka_unit_test(senseless_sections_are_none),
        cmocka_unit_test(unknown_blocks_are_refused),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
