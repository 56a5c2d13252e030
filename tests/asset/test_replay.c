/* Broken bytes by the thousand: cut files, flipped bits. The library and the decoder of the
 * specification must agree on what is a file and what is not. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/codec.h"
#include "asset/golden.h"
#include "asset/lod.h"

#define GTX_DECODE_NO_MAIN
#ifndef GTX_ZSTD
#define NO_ZSTD
#endif
#include "../../format/gtx_decode.c"

#include <glob.h>

/* ---- library and decoder on the same bytes ---- */

/* Opens a copy of exactly `size` bytes, so that a step too far is caught. */
static gtx_result open_copy(bytes file, gtx_asset **out, gtx_error *error)
{
    uint8_t *copy = need(malloc(file.size ? file.size : 1));
    memcpy(copy, file.data, file.size);
    gtx_result result = gtx_open_memory(copy, file.size, NULL, out, error);
    gtx_result verdict = gtx_validate(copy, file.size, NULL, NULL, NULL, NULL);
    assert_int_equal(result, verdict);
    free(copy);
    return result;
}

static void assert_round_trip(const gtx_asset *asset)
{
    void *data, *again;
    size_t size, again_size;
    gtx_asset *copy;
    assert_int_equal(gtx_encode(asset, NULL, &data, &size, NULL), GTX_OK);
    assert_int_equal(gtx_open_memory(data, size, NULL, &copy, NULL), GTX_OK);
    assert_int_equal(gtx_encode(copy, NULL, &again, &again_size, NULL), GTX_OK);
    assert_int_equal(size, again_size);
    assert_memory_equal(data, again, size);
    gtx_close(copy);
    free(data);
    free(again);
}

/* Opens the bytes, compares with the decoder; true when they are a file. */
static bool try_bytes(bytes file, gtx_error *error)
{
    static struct file decoded;
    gtx_asset *asset = NULL;
    gtx_result result = open_copy(file, &asset, error);
    unsigned rule = decode(file.data, file.size, &decoded);
    release(&decoded);
    if (result == GTX_ERROR_MEMORY || result == GTX_ERROR_LIMIT || rule == NO_MEMORY)
        return false; /* a matter of the machine */
    if ((result == GTX_OK) != (rule == 0))
        print_error("library: rule %u, %s; decoder: rule %u\n", error->rule,
                    result ? error->message : "accepted", rule);
    assert_int_equal(result == GTX_OK, rule == 0);
    if (asset)
        assert_round_trip(asset);
    gtx_close(asset);
    return result == GTX_OK;
}

static bool readable(const golden *g)
{
    return !g->zstd_level || gtx_has_zstd();
}

static void test_goldens_agree(void **state)
{
    (void)state;
    for (int i = 0; i < GOLDEN_COUNT; ++i) {
        if (!readable(&goldens[i]))
            continue;
        bytes file = read_golden(goldens[i].name);
        static struct file decoded;
        gtx_asset *asset;
        assert_int_equal(gtx_open_memory(file.data, file.size, NULL, &asset, NULL), GTX_OK);
        assert_int_equal(decode(file.data, file.size, &decoded), 0);
        for (uint32_t s = 0; s < decoded.section_count; ++s) {
            const struct section *section = &decoded.section[s];
            if (!section->bytes)
                continue;
            gtx_section_kind kind = gtx_section_kind_of((const uint8_t *)section->type);
            assert_memory_equal(section->bytes, gtx_asset_data(asset, kind, section->level),
                                section->size);
        }
        release(&decoded);
        gtx_close(asset);
        free(file.data);
    }
}

/* A bad file breaks one rule, so that the decoder has no choice of which to name. */
static void test_bad_agree(void **state)
{
    (void)state;
    glob_t paths;
    assert_int_equal(glob(BAD "*.gtx", 0, NULL, &paths), 0);
    for (size_t i = 0; i < paths.gl_pathc; ++i) {
        const char *name = paths.gl_pathv[i] + strlen(BAD);
        if (strstr(name, "zstd") && !gtx_has_zstd())
            continue;
        bytes file = read_file(paths.gl_pathv[i]);
        static struct file decoded;
        unsigned rule = decode(file.data, file.size, &decoded);
        release(&decoded);
        if (rule != strtoul(name, NULL, 10))
            print_error("%s: decoder: rule %u\n", name, rule);
        assert_int_equal(rule, strtoul(name, NULL, 10));
        free(file.data);
    }
    globfree(&paths);
}

/* The inverse of every filter, also of those that the encoder does not choose. */
static void test_filters_agree(void **state)
{
    (void)state;
    const struct file pages = {.pages = 2};
    for (uint32_t texel = 1; texel <= 4; ++texel) {
        for (uint32_t filter = 0; filter < 4; ++filter) {
            const gtx_map_shape shape = {2, 7, 5, texel};
            size_t size = (size_t)gtx_shape_size(shape);
            struct section section = {.filter = filter, .size = size, .width = 7, .height = 5,
                                      .texel = texel, .bytes = need(malloc(size))};
            uint8_t coded[280], out[280];
            for (size_t i = 0; i < size; ++i)
                section.bytes[i] = coded[i] = (uint8_t)(i * i * 13 + 7 * i);
            gtx_filter_undo(shape, filter, coded, out);
            assert_int_equal(undo_filter(&pages, &section), 0);
            assert_memory_equal(section.bytes, out, size);
            free(section.bytes);
        }
    }
}

/* Steps made of noise: the two undo them alike, and go nowhere else. */
static void test_steps_agree(void **state)
{
    (void)state;
    uint64_t seed = 7;
    for (uint32_t round = 0; round < 3000; ++round) {
        uint32_t patches = round % 4, vertices = round / 4 % 30, triangles = round / 120;
        const uint32_t flags = round % 3 ? 0 : GTX_LOD_NORMALS;
        size_t size = (size_t)(gtx_lod_size(patches, vertices, triangles) +
                               gtx_lod_normals_size(flags, vertices));
        uint8_t *coded = need(malloc(size)), *out = need(malloc(size));
        struct section section = {.type = "LODM", .size = size, .bytes = need(malloc(size))};
        for (size_t i = 0; i < size; ++i) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            /* Words that mean something, now and then one that does not. */
            coded[i] = (uint8_t)(seed >> 62 || i % 4 ? (seed >> 40) % (seed >> 61 ? 3 : 20)
                                                     : seed >> 50);
        }
        gtx_store_u32(coded + 20, vertices + (round % 50 == 49));
        gtx_store_u32(coded + 24, triangles + 100 * (round % 70 == 69));
        gtx_store_u32(coded + 28, flags);
        memcpy(section.bytes, coded, size);
        bool undone = gtx_lod_filter_undo(coded, size, out);
        assert_int_equal(undone, undo_steps(&section) == 0);
        if (undone)
            assert_memory_equal(section.bytes, out, size);
        free(section.bytes);
        free(coded);
        free(out);
    }
}

static void test_truncation(void **state)
{
    (void)state;
    static const char *const names[] = {"minimal", "unknown"};
    for (int i = 0; i < 2; ++i) {
        bytes file = read_golden(names[i]);
        for (size_t size = 0; size < file.size; ++size) {
            gtx_error error = {0};
            assert_false(try_bytes((bytes){file.data, size}, &error));
            assert_int_equal(error.result, GTX_ERROR_TRUNCATED);
        }
        free(file.data);
    }
}

typedef enum repair {
    NO_REPAIR, REPAIR_HEADER, REPAIR_ALL
} repair;

/* Flips every `step`-th bit of [from, to), repairs hashes; returns how many results are files. */
static uint32_t flip(const char *name, size_t from, size_t to, size_t step, repair how)
{
    bytes file = read_golden(name);
    uint8_t *original = need(malloc(file.size));
    memcpy(original, file.data, file.size);
    uint32_t accepted = 0;
    for (size_t bit = 8 * from; bit < 8 * to && bit < 8 * file.size; bit += step) {
        file.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
        if (how == REPAIR_HEADER && gtx_load_u32(file.data + 28) <= GTX_MAX_SECTIONS)
            rehash_header(file, true);
        else if (how == REPAIR_ALL)
            rehash_sections(file);
        gtx_error error = {0};
        accepted += try_bytes(file, &error);
        memcpy(file.data, original, file.size);
    }
    free(original);
    free(file.data);
    return accepted;
}

static size_t table_end(const char *name)
{
    bytes file = read_golden(name);
    size_t end = GTX_HEADER_SIZE + (size_t)GTX_ENTRY_SIZE * gtx_load_u32(file.data + 28);
    free(file.data);
    return end;
}

/* Not one flipped bit of header, table or content goes unnoticed. */
static void test_flips(void **state)
{
    (void)state;
    assert_int_equal(flip("minimal", 0, SIZE_MAX / 8, 1, NO_REPAIR), 0);
    assert_int_equal(flip("color", 0, SIZE_MAX / 8, 5, NO_REPAIR), 0);
    assert_int_equal(flip("emission", 0, SIZE_MAX / 8, 3, NO_REPAIR), 0);
    assert_int_equal(flip("lod", 0, SIZE_MAX / 8, 3, NO_REPAIR), 0);
    assert_int_equal(flip("unknown", 0, table_end("unknown"), 1, NO_REPAIR), 0);
}

/* With hashes made right again the other rules are on their own. Some bits are free: may_flags,
 * the anchor, the unit, the number of source triangles... */
static void test_repaired_flips(void **state)
{
    (void)state;
    static const char *const names[] = {"minimal", "two-pages", "unknown", "color",
                                        "material", "emission", "lod",
                                        "zstd", "zstd-material", "zstd-lod", "zstd-normals"};
    for (int i = 0; i < (gtx_has_zstd() ? 10 : 7); ++i) {
        uint32_t accepted = flip(names[i], 0, table_end(names[i]), 1, REPAIR_HEADER);
        assert_in_range(accepted, 100, 1000);
    }
}

static void test_repaired_content(void **state)
{
    (void)state;
    assert_in_range(flip("minimal", 448, 448 + 128 + 64, 1, REPAIR_ALL), 100, 1200);
    assert_in_range(flip("two-pages", 448, 448 + 512, 3, REPAIR_ALL), 150, 1000);
    assert_in_range(flip("lod", 704, 960, 1, REPAIR_ALL), 100, 1000);
    assert_in_range(flip("color", 3648, SIZE_MAX / 8, 1, REPAIR_ALL), 50, 200); /* META */
}

/* A zstd frame has a few bits that do not matter to what it decodes to. */
static void test_compressed_flips(void **state)
{
    (void)state;
    if (!gtx_has_zstd())
        skip();
    assert_in_range(flip("zstd", table_end("zstd"), SIZE_MAX / 8, 7, NO_REPAIR), 0, 50);
}

/* Bytes changed at random, several at once, with the hashes made right. */
static void test_random_changes(void **state)
{
    (void)state;
    uint64_t seed = 1;
    for (uint32_t round = 0; round < 2000; ++round) {
        bytes file = read_golden(goldens[round % GOLDEN_COUNT].name);
        if (readable(&goldens[round % GOLDEN_COUNT])) {
            size_t table = GTX_HEADER_SIZE + GTX_ENTRY_SIZE * gtx_load_u32(file.data + 28);
            for (int i = 0; i < 3; ++i) {
                seed = seed * 6364136223846793005u + 1442695040888963407u;
                size_t at = 28 + (size_t)(seed >> 33) % (table - 28);
                file.data[at] = (uint8_t)(seed >> 20);
            }
            if (gtx_load_u32(file.data + 28) <= GTX_MAX_SECTIONS)
                rehash_header(file, true);
            gtx_error error = {0};
            try_bytes(file, &error);
        }
        free(file.data);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_goldens_agree),    cmocka_unit_test(test_bad_agree),
        cmocka_unit_test(test_filters_agree),    cmocka_unit_test(test_steps_agree),
        cmocka_unit_test(test_truncation),
        cmocka_unit_test(test_flips),            cmocka_unit_test(test_repaired_flips),
        cmocka_unit_test(test_repaired_content), cmocka_unit_test(test_compressed_flips),
        cmocka_unit_test(test_random_changes),
    };
    return cmocka_run_group_tests_name("replay", tests, NULL, NULL);
}
