/* Golden files: what is written today is what was checked in, and reads back as what it was.
 *
 *   test_golden --write   writes tests/golden/good anew and prints the hashes for golden.h */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/codec.h"
#include "asset/golden.h"

#include <inttypes.h>
#include <sys/wait.h>

static gtx_asset *open_bytes(bytes file)
{
    gtx_asset *asset = NULL;
    gtx_error error = {0};
    if (gtx_open_memory(file.data, file.size, NULL, &asset, &error))
        print_error("rule %u at %" PRIu64 ": %s\n", error.rule, error.offset, error.message);
    assert_non_null(asset);
    return asset;
}

/* Skips what this build cannot read. */
static bool readable(const golden *g)
{
    return !g->zstd_level || gtx_has_zstd();
}

static void test_stored_bytes(void **state)
{
    (void)state;
    for (int i = 0; i < GOLDEN_COUNT; ++i) {
        if (goldens[i].zstd_level)
            continue;
        bytes kept = read_golden(goldens[i].name), made = golden_encode(&goldens[i]);
        assert_int_equal(kept.size, made.size);
        assert_memory_equal(kept.data, made.data, kept.size);
        free(kept.data);
        free(made.data);
    }
}

static void test_hashes(void **state)
{
    (void)state;
    for (int i = 0; i < GOLDEN_COUNT; ++i) {
        bytes kept = read_golden(goldens[i].name);
        assert_int_equal(gtx_hash_bytes(kept.data, kept.size), goldens[i].file_hash);
        assert_int_equal(gtx_load_u64(kept.data + 128), goldens[i].content_hash);
        if (readable(&goldens[i])) {
            gtx_asset *asset = open_bytes(kept);
            gtx_info info;
            gtx_get_info(asset, &info);
            assert_int_equal(info.content_hash, goldens[i].content_hash);
            assert_int_equal(info.file_size, kept.size);
            gtx_close(asset);
        }
        free(kept.data);
    }
}

static void assert_same_map(const gtx_asset *a, const gtx_asset *b, gtx_map map, uint32_t level)
{
    size_t size_a, size_b;
    const void *data_a = gtx_map_data(a, map, level, &size_a);
    const void *data_b = gtx_map_data(b, map, level, &size_b);
    assert_int_equal(size_a, size_b);
    assert_int_equal(!data_a, !data_b);
    if (data_a)
        assert_memory_equal(data_a, data_b, size_a);
}

static void test_content(void **state)
{
    (void)state;
    for (int i = 0; i < GOLDEN_COUNT; ++i) {
        const golden *g = &goldens[i];
        if (!readable(g))
            continue;
        bytes kept = read_golden(g->name);
        gtx_asset *read = open_bytes(kept), *made;
        assert_int_equal(golden_create(g, NULL, &made, NULL), GTX_OK);
        gtx_info info;
        gtx_get_info(read, &info);
        assert_int_equal(info.height_bits, g->bits);
        assert_int_equal(info.mip_count, g->mips);
        assert_int_equal(info.page_count, g->pages);
        assert_int_equal(info.version_minor, 7);
        assert_int_equal(info.has_color, (g->maps & COLOR) != 0);
        assert_int_equal(info.has_material, (g->maps & MATERIAL) != 0);
        assert_int_equal(info.has_emission, (g->maps & EMISSION) != 0);
        assert_true(info.emission_scale == (g->maps & EMISSION ? 2.5f : 0));
        assert_int_equal(info.source_triangles, 1234);
        assert_true(info.anchor[0] == 1e7 && info.anchor[1] == -2 && info.unit == 0.5f);
        assert_true(info.bounds_min[2] == -1 && info.bounds_max[0] == 2);
        assert_memory_equal(gtx_patches(read), gtx_patches(made),
                            info.patch_count * sizeof(gtx_patch));
        for (int map = GTX_MAP_HEIGHT; map <= GTX_MAP_EMISSION; ++map)
            for (uint32_t level = 0; level <= g->mips; ++level)
                assert_same_map(read, made, (gtx_map)map, level);
        size_t size;
        const char *meta = gtx_meta(read, &size);
        assert_int_equal(size, g->meta ? strlen(g->meta) : 0);
        if (g->meta)
            assert_memory_equal(meta, g->meta, size);
        else
            assert_null(meta);
        gtx_close(read);
        gtx_close(made);
        free(kept.data);
    }
}

/* What was skipped on reading is not there on writing. */
static void test_round_trip(void **state)
{
    (void)state;
    bytes plain = read_golden("minimal");
    for (int i = 0; i < GOLDEN_COUNT; ++i) {
        const golden *g = &goldens[i];
        if (!readable(g))
            continue;
        bytes kept = read_golden(g->name);
        gtx_asset *asset = open_bytes(kept);
        gtx_encode_desc desc = {.zstd_level = golden_level(g)};
        void *data;
        size_t size;
        assert_int_equal(gtx_encode(asset, &desc, &data, &size, NULL), GTX_OK);
        if (g->zstd_level) { /* the bytes are those of one zstd version, the content is not */
            gtx_asset *again = open_bytes((bytes){data, size});
            gtx_info info;
            gtx_get_info(again, &info);
            assert_int_equal(info.content_hash, g->content_hash);
            gtx_close(again);
        } else {
            bytes right = g->unknown ? plain : kept;
            assert_int_equal(size, right.size);
            assert_memory_equal(data, right.data, size);
        }
        gtx_close(asset);
        free(data);
        free(kept.data);
    }
    free(plain.data);
}

static void count_issue(const gtx_issue *issue, void *user)
{
    print_error("rule %u %s: %s\n", issue->rule, issue->name, issue->message);
    ++*(int *)user;
}

static void test_valid(void **state)
{
    (void)state;
    for (int i = 0; i < GOLDEN_COUNT; ++i) {
        if (!readable(&goldens[i]))
            continue;
        bytes kept = read_golden(goldens[i].name);
        int issues = 0;
        assert_int_equal(gtx_validate(kept.data, kept.size, NULL, count_issue, &issues, NULL),
                         GTX_OK);
        assert_int_equal(issues, 0);
        free(kept.data);
    }
}

static int run_decoder(const char *path)
{
    char command[512];
    snprintf(command, sizeof command, "'%s/gtx_decode' %s >/dev/null 2>&1",
             getenv("GTX_OUT"), path);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* The decoder of the specification as a program. */
static void test_decoder(void **state)
{
    (void)state;
    if (!getenv("GTX_OUT"))
        skip();
    for (int i = 0; i < GOLDEN_COUNT; ++i) {
        char path[256];
        snprintf(path, sizeof path, GOOD "%s.gtx", goldens[i].name);
        assert_int_equal(run_decoder(path), readable(&goldens[i]) ? 0 : 5);
    }
    assert_int_equal(run_decoder(BAD "302-patch-axis-unit.gtx"), 3);
    assert_int_equal(run_decoder(BAD "118-truncated.gtx"), 3);
    assert_int_equal(run_decoder("tests/golden"), 2);
    assert_int_equal(run_decoder("nowhere.gtx"), 2);
}

/* A compressed file without zstd is refused as unsupported, not as broken. */
static void test_without_zstd(void **state)
{
    (void)state;
    if (gtx_has_zstd())
        skip();
    bytes kept = read_golden("zstd");
    gtx_asset *asset = NULL;
    assert_int_equal(gtx_open_memory(kept.data, kept.size, NULL, &asset, NULL),
                     GTX_ERROR_UNSUPPORTED);
    assert_null(asset);
    free(kept.data);
}

static int write_goldens(void)
{
    for (int i = 0; i < GOLDEN_COUNT; ++i) {
        char path[256];
        snprintf(path, sizeof path, GOOD "%s.gtx", goldens[i].name);
        bytes made = golden_encode(&goldens[i]);
        write_file(path, made);
        printf("%s: 0x%016" PRIx64 ", 0x%016" PRIx64 "\n", goldens[i].name,
               gtx_load_u64(made.data + 128), gtx_hash_bytes(made.data, made.size));
        free(made.data);
    }
    return 0;
}

int main(int argc, char **argv)
{
    if (argc > 1 && !strcmp(argv[1], "--write"))
        return write_goldens();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stored_bytes), cmocka_unit_test(test_hashes),
        cmocka_unit_test(test_content),      cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_valid),        cmocka_unit_test(test_decoder),
        cmocka_unit_test(test_without_zstd),
    };
    return cmocka_run_group_tests_name("golden", tests, NULL, NULL);
}
