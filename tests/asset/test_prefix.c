/* The first bytes of a file, however many: what they show, what they need to show more, and that
 * nothing beyond them is read. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/codec.h"
#include "asset/golden.h"
#include "asset/read.h"
#include "base/alloc.h"

#include <stdlib.h>

/* All that a file may have; once stored, once compressed. */
static const golden every[2] = {
    {"every", 16, 2, 2, 8, EVERY_MAP, false, "{}", 0, false, 0, 0, 3, true},
    {"zstd-every", 64, 2, 4, 16, EVERY_MAP, false, "{}", 3, false, 0, 0, 3, true}};

/* Where entry `i` of a file ends. */
static size_t end_of(bytes file, uint32_t i)
{
    const uint8_t *entry = file.data + GTX_HEADER_SIZE + GTX_ENTRY_SIZE * i;
    return gtx_load_u64(entry + 16) + gtx_load_u64(entry + 24);
}

/* A copy of its own, so that sanitizers see what is read behind it. */
static gtx_result open_prefix(bytes file, size_t size, const gtx_open_desc *desc,
                              gtx_prefix *prefix, gtx_asset **out, gtx_error *error)
{
    uint8_t *copy = need(malloc(size ? size : 1));
    memcpy(copy, file.data, size);
    const gtx_result result = gtx_open_prefix(size ? copy : NULL, size, desc, prefix, out, error);
    free(copy);
    return result;
}

/* A preview is an asset that keeps every rule. */
static void assert_valid(const gtx_asset *asset)
{
    void *data;
    size_t size;
    gtx_error error = {0};
    assert_int_equal(gtx_encode(asset, NULL, &data, &size, NULL), GTX_OK);
    if (gtx_validate(data, size, NULL, NULL, NULL, &error))
        fail_msg("%s", error.message);
    free(data);
}

static void check_golden(const golden *g)
{
    bytes file = golden_encode(g);
    size_t needed = 0;
    uint32_t shown = 0, stages = 0;
    const uint32_t sections = gtx_load_u32(file.data + 28);
    for (size_t size = 0; size <= file.size; ++size) {
        gtx_prefix prefix = {0};
        gtx_asset *asset = NULL;
        gtx_error error = {0};
        gtx_info info = {0};
        if (open_prefix(file, size, NULL, &prefix, &asset, &error))
            fail_msg("%u of %s: %s", (unsigned)size, g->name, error.message);
        const size_t table = GTX_HEADER_SIZE + GTX_ENTRY_SIZE * sections;
        assert_int_equal(prefix.file_size, size < table ? 0 : file.size);
        assert_true(size == file.size ? !prefix.needed : prefix.needed > size);
        assert_in_range(prefix.needed, 0, file.size);
        assert_true(prefix.needed >= needed || size == file.size);
        assert_int_equal(asset != NULL, size == file.size || (g->lods && size >= end_of(file, 0)));
        if (asset)
            gtx_get_info(asset, &info);
        /* More is there exactly where it was said to be. */
        if (prefix.needed != needed) {
            assert_true(size == needed || size == 0);
            needed = prefix.needed;
            stages += asset != NULL;
            if (asset)
                assert_valid(asset);
        }
        if (size < file.size) {
            assert_in_range(info.lod_levels, shown, g->lods);
            shown = info.lod_levels;
            if (size >= end_of(file, g->lods) && asset)
                assert_int_equal(info.lod_levels, g->lods);
        }
        gtx_close(asset);
    }
    assert_int_equal(stages, g->lods ? g->lods + 1 + (g->maps ? 3 * g->mips : 0) : 1);
    free(file.data);
}

static void test_every_length(void **state)
{
    (void)state;
    for (int i = 0; i < GOLDEN_COUNT; ++i)
        if (gtx_has_zstd() || !goldens[i].zstd_level)
            if (!goldens[i].unknown && (goldens[i].lods || goldens[i].side < 64))
                check_golden(&goldens[i]);
    for (int i = 0; i < (gtx_has_zstd() ? 2 : 1); ++i)
        check_golden(&every[i]);
}

/* What is there is what the whole has: LOD meshes to the byte, images at some level. */
static void test_content(void **state)
{
    (void)state;
    bytes file = golden_encode(&every[0]);
    gtx_asset *whole, *part;
    gtx_prefix prefix;
    gtx_lod_mesh a, b;
    assert_int_equal(gtx_open_memory(file.data, file.size, NULL, &whole, NULL), GTX_OK);
    assert_int_equal(open_prefix(file, end_of(file, 2), NULL, &prefix, &part, NULL), GTX_OK);
    assert_int_equal(prefix.needed, end_of(file, 3));
    assert_int_equal(gtx_get_lod_mesh(whole, 1, &a), GTX_OK);
    assert_int_equal(gtx_get_lod_mesh(part, 0, &b), GTX_OK);
    assert_int_equal(a.triangle_count, b.triangle_count);
    assert_memory_equal(a.indices, b.indices, 12 * a.triangle_count);
    assert_memory_equal(a.positions, b.positions, 6 * a.vertex_count);
    gtx_close(part);
    /* The last entry before heights is the finest of emission. */
    assert_int_equal(open_prefix(file, end_of(file, 9), NULL, &prefix, &part, NULL), GTX_OK);
    assert_int_equal(prefix.needed, file.size);
    size_t size, fewer;
    const void *all = gtx_map_data(whole, GTX_MAP_COLOR, 0, &size);
    assert_memory_equal(gtx_map_data(part, GTX_MAP_COLOR, 0, &fewer), all, size);
    assert_int_equal(size, fewer);
    const uint8_t *heights = gtx_map_data(part, GTX_MAP_HEIGHT, 0, &size);
    for (size_t i = 0; i < size; ++i)
        assert_int_equal(heights[i], 0);
    gtx_close(part);
    gtx_close(whole);
    free(file.data);
}

/* Before the file's patches come, those of the coarsest LOD mesh are boxes around its triangles. */
static void test_sketch(void **state)
{
    (void)state;
    bytes file = golden_encode(&every[0]);
    gtx_asset *whole, *part;
    gtx_prefix prefix;
    gtx_lod_mesh coarsest, mesh;
    assert_int_equal(gtx_open_memory(file.data, file.size, NULL, &whole, NULL), GTX_OK);
    assert_int_equal(open_prefix(file, end_of(file, 0), NULL, &prefix, &part, NULL), GTX_OK);
    assert_int_equal(prefix.needed, end_of(file, 2));
    assert_int_equal(part->info.patch_count, whole->info.patch_count);
    assert_int_equal(gtx_get_lod_mesh(whole, 2, &coarsest), GTX_OK);
    assert_int_equal(gtx_get_lod_mesh(part, 0, &mesh), GTX_OK);
    assert_int_equal(mesh.triangle_count, coarsest.triangle_count);
    assert_memory_equal(mesh.normals, coarsest.normals, 2 * mesh.vertex_count);
    for (uint32_t p = 0; p < part->info.patch_count; ++p) {
        const gtx_patch *patch = &part->patches[p];
        const gtx_patch_frame frame = gtx_patch_frame_of(patch, 8);
        assert_true(patch->axis_z[2] > 0.99f && patch->extent_z < 0.5f); /* as golden ones lie */
        for (uint32_t i = 3 * mesh.first[p]; i < 3 * mesh.first[p + 1]; ++i)
            for (int axis = 0; axis < 2; ++axis) {
                double at = frame.to_grid[axis][3];
                for (int k = 0; k < 3; ++k)
                    at += frame.to_grid[axis][k] *
                          ((double)mesh.origin[k] +
                           (double)mesh.step * mesh.positions[3 * mesh.indices[i] + (uint32_t)k]);
                assert_true(at > -0.51 && at < patch->rect[2 + axis] - 0.49);
            }
    }
    gtx_close(part);
    gtx_close(whole);
    free(file.data);
}

/* Boxes that floats cannot hold are none: the file's own patches are waited for. */
static void test_far_sketch(void **state)
{
    (void)state;
    bytes file = golden_encode(&every[0]);
    const size_t mesh = gtx_load_u64(file.data + GTX_HEADER_SIZE + 16);
    gtx_prefix prefix;
    gtx_asset *part;
    gtx_store_u32(file.data + mesh + 12, 0x7f000000); /* a step of 1.7e38 */
    rehash_sections(file);
    assert_int_equal(open_prefix(file, end_of(file, 0), NULL, &prefix, &part, NULL), GTX_OK);
    assert_null(part);
    assert_int_equal(prefix.needed, end_of(file, 2));
    free(file.data);
}

/* The sections of a kind, in a copy of their own; they lie side by side. */
static gtx_file_part piece_of(bytes file, const char *type)
{
    gtx_file_part piece = {NULL, 0, 0};
    for (uint32_t i = 0; i < gtx_load_u32(file.data + 28); ++i) {
        const uint8_t *entry = file.data + GTX_HEADER_SIZE + GTX_ENTRY_SIZE * i;
        if (memcmp(entry, type, 4))
            continue;
        piece.first = piece.first ? piece.first : gtx_load_u64(entry + 16);
        piece.size = end_of(file, i) - piece.first;
    }
    uint8_t *copy = need(malloc(piece.size));
    memcpy(copy, file.data + piece.first, piece.size);
    piece.bytes = copy;
    return piece;
}

static gtx_result open_pieces(bytes file, size_t size, const gtx_file_part *pieces, gtx_asset **out)
{
    const gtx_read_options options = {.allocator = gtx_allocator_or_default(NULL)};
    gtx_prefix prefix;
    *out = NULL;
    return gtx_read_prefix(NULL, &options, file.data, size, pieces, 2, &prefix, out);
}

/* Heights and normals from behind a beginning: it has the file's normals, and no heights. */
static void test_pieces(void **state)
{
    (void)state;
    for (int i = 0; i < (gtx_has_zstd() ? 2 : 1); ++i) {
        bytes file = golden_encode(&every[i]);
        const gtx_file_part pieces[2] = {piece_of(file, "HGHT"), piece_of(file, "NRML")};
        const size_t size = end_of(file, 3);
        gtx_asset *whole, *part;
        assert_int_equal(gtx_open_memory(file.data, file.size, NULL, &whole, NULL), GTX_OK);
        assert_int_equal(open_pieces(file, size, pieces, &part), GTX_OK);
        assert_int_equal(part->info.mip_count, whole->info.mip_count);
        assert_int_equal(part->info.lod_levels, 3);
        const size_t texels = gtx_page_texels(whole, 0) * whole->info.page_count;
        for (uint32_t k = 0; k < whole->info.mip_count; ++k)
            assert_memory_equal(part->normal[k], whole->normal[k], 2 * (texels >> 2 * k));
        const size_t bytes_each = whole->info.height_bits / 8;
        for (size_t t = 0; t < texels; ++t) {
            const uint8_t *code = whole->height + bytes_each * t;
            assert_int_equal(part->marks[t], code[0] || code[bytes_each - 1]);
            assert_int_equal(part->height[t], 0);
        }
        gtx_close(part);
        /* A piece that ends early is none: normals follow from the LOD mesh. */
        for (int cut = 0; cut < 2; ++cut) {
            gtx_file_part fewer[2] = {pieces[0], pieces[1]};
            --fewer[cut].size;
            assert_int_equal(open_pieces(file, size, fewer, &part), GTX_OK);
            assert_null(part->marks);
            gtx_close(part);
        }
        ((uint8_t *)(uintptr_t)pieces[1].bytes)[pieces[1].size / 2] ^= 0x11;
        assert_int_equal(open_pieces(file, size, pieces, &part), GTX_ERROR_CORRUPT);
        gtx_close(whole);
        free((void *)(uintptr_t)pieces[0].bytes);
        free((void *)(uintptr_t)pieces[1].bytes);
        free(file.data);
    }
}

/* A wrong byte ends in an error, or in an asset that keeps the rules. */
static void flip_bytes(uint32_t entry)
{
    bytes file = golden_encode(&every[0]);
    const size_t size = end_of(file, entry);
    uint32_t refused = 0;
    for (size_t at = 0; at < size; ++at) {
        file.data[at] ^= 0x11;
        if (at % 2)
            rehash_header(file, false);
        gtx_prefix prefix;
        gtx_asset *asset;
        gtx_error error = {0};
        const gtx_result result = open_prefix(file, size, NULL, &prefix, &asset, &error);
        assert_int_equal(result, error.result);
        assert_true(!result || !asset);
        if (asset)
            assert_valid(asset);
        refused += result != GTX_OK;
        gtx_close(asset);
        file.data[at] ^= 0x11;
        rehash_header(file, false);
    }
    assert_true(refused > size / 2);
    free(file.data);
}

static void test_flips(void **state)
{
    (void)state;
    flip_bytes(0);
    flip_bytes(6);
}

/* ---- memory ---- */

typedef struct scarce {
    uint32_t left;                /* calls that succeed */
    uint64_t bytes;
} scarce;

static void *take(size_t size, void *user)
{
    scarce *s = user;
    if (!s->left)
        return NULL;
    --s->left;
    s->bytes += size;
    return malloc(size);
}

static void give(void *memory, size_t size, void *user)
{
    ((scarce *)user)->bytes -= memory ? size : 0;
    free(memory);
}

static void open_with_little(bytes file, size_t size)
{
    gtx_result result = GTX_ERROR_MEMORY;
    for (uint32_t calls = 0; result; ++calls) {
        scarce s = {.left = calls};
        const gtx_allocator hooks = {take, give, &s};
        const gtx_open_desc desc = {.allocator = &hooks};
        gtx_prefix prefix;
        gtx_asset *asset;
        assert_in_range(calls, 0, 100);
        result = open_prefix(file, size, &desc, &prefix, &asset, NULL);
        assert_int_equal(result, asset ? GTX_OK : GTX_ERROR_MEMORY);
        gtx_close(asset);
        assert_int_equal(s.bytes, 0);
    }
}

static void test_memory(void **state)
{
    (void)state;
    bytes file = golden_encode(&every[0]);
    open_with_little(file, end_of(file, 0));
    open_with_little(file, end_of(file, 6));
    gtx_open_desc desc = {.limits.memory = 1000};
    gtx_prefix prefix;
    gtx_asset *asset;
    gtx_error error = {0};
    assert_int_equal(open_prefix(file, end_of(file, 6), &desc, &prefix, &asset, &error),
                     GTX_ERROR_LIMIT);
    assert_string_equal(error.limit, "memory");
    assert_int_equal(gtx_open_prefix(file.data, 9, NULL, NULL, &asset, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_open_prefix(NULL, 9, NULL, &prefix, &asset, NULL), GTX_ERROR_ARGUMENT);
    free(file.data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_length), cmocka_unit_test(test_content),
        cmocka_unit_test(test_sketch), cmocka_unit_test(test_far_sketch),
        cmocka_unit_test(test_pieces), cmocka_unit_test(test_flips), cmocka_unit_test(test_memory)};
    return cmocka_run_group_tests_name("prefix", tests, NULL, NULL);
}
