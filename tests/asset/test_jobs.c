/* Opening and encoding in a host's jobs: the same asset, bytes or error, however they are run. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/codec.h"
#include "asset/golden.h"
#include "common/runners.h"

#include <glob.h>
#include <string.h>

/* What opening comes to: the error, or the asset as bytes. */
typedef struct outcome {
    gtx_result result;
    gtx_error error;
    void *data;
    size_t size;
} outcome;

static outcome open_with(bytes file, const gtx_jobs *jobs)
{
    outcome out = {0};
    const gtx_open_desc desc = {.jobs = jobs};
    gtx_asset *asset;
    out.result = gtx_open_memory(file.data, file.size, &desc, &asset, &out.error);
    if (!out.result)
        assert_int_equal(gtx_encode(asset, NULL, &out.data, &out.size, NULL), GTX_OK);
    gtx_close(asset);
    return out;
}

/* Returns the runs that one way of opening made. */
static unsigned expect_alike(bytes file, const char *name)
{
    outcome alone = open_with(file, NULL);
    runner_log log = {0, 0};
    for (int i = 0; i < RUNNERS; ++i) {
        const gtx_jobs jobs = runner_of(i, &log);
        outcome other = open_with(file, &jobs);
        if (alone.result != other.result || alone.size != other.size ||
            alone.error.rule != other.error.rule || alone.error.offset != other.error.offset ||
            strcmp(alone.error.message, other.error.message))
            fail_msg("%s: %d, \"%s\" in place of %d, \"%s\"", name, other.result,
                     other.error.message, alone.result, alone.error.message);
        if (alone.size)
            assert_memory_equal(alone.data, other.data, alone.size);
        free(other.data);
    }
    free(alone.data);
    return log.runs;
}

static void test_good(void **state)
{
    (void)state;
    for (int i = 0; i < GOLDEN_COUNT; ++i) {
        bytes file = read_golden(goldens[i].name);
        const bool readable = !goldens[i].zstd_level || gtx_has_zstd();
        assert_int_equal(expect_alike(file, goldens[i].name) > 0, readable);
        free(file.data);
    }
}

static bytes read_path(const char *path)
{
    FILE *file = need(fopen(path, "rb"));
    bytes out = {need(malloc(1 << 20)), 0};
    out.size = fread(out.data, 1, 1 << 20, file);
    fclose(file);
    return out;
}

static void test_bad(void **state)
{
    (void)state;
    glob_t found;
    assert_int_equal(glob(BAD "*", 0, NULL, &found), 0);
    assert_true(found.gl_pathc > 40);
    for (size_t i = 0; i < found.gl_pathc; ++i) {
        bytes file = read_path(found.gl_pathv[i]);
        expect_alike(file, found.gl_pathv[i]);
        free(file.data);
    }
    globfree(&found);
}

/* Several sections at once may be wrong: what the order of the file has first is told. */
static void test_mutated(void **state)
{
    (void)state;
    static const char *const names[] = {"zstd", "zstd-material", "zstd-lod", "lod", "zstd-normals"};
    uint32_t random = 1;
    for (int n = 0; n < 4; ++n) {
        bytes file = read_golden(names[n]);
        for (int turn = 0; turn < 150; ++turn) {
            bytes mutated = {need(malloc(file.size)), file.size};
            memcpy(mutated.data, file.data, file.size);
            const size_t from = GTX_HEADER_SIZE + (size_t)gtx_load_u32(file.data + 28) * 64;
            for (int k = 0; k < 1 + turn % 5; ++k) {
                random = random * 1664525 + 1013904223;
                const size_t at = from + (random >> 8) % (file.size - from);
                mutated.data[at] ^= (uint8_t)(1 + random % 255);
            }
            expect_alike(mutated, names[n]);
            free(mutated.data);
        }
        free(file.data);
    }
}

/* A structure of zeros is none. */
static void test_zeros(void **state)
{
    (void)state;
    bytes file = read_golden("minimal");
    const gtx_jobs none = {0};
    outcome out = open_with(file, &none);
    assert_int_equal(out.result, GTX_OK);
    free(out.data);
    free(file.data);
}

static void test_encoding(void **state)
{
    (void)state;
    if (!gtx_has_zstd())
        skip();
    for (int i = 0; i < GOLDEN_COUNT; ++i) {
        gtx_asset *asset;
        gtx_encode_desc desc = {.zstd_level = 3};
        void *alone, *other;
        size_t size, other_size;
        assert_int_equal(golden_create(&goldens[i], NULL, &asset, NULL), GTX_OK);
        assert_int_equal(gtx_encode(asset, &desc, &alone, &size, NULL), GTX_OK);
        runner_log log = {0, 0};
        for (int k = 0; k < RUNNERS; ++k) {
            const gtx_jobs jobs = runner_of(k, &log);
            desc.jobs = &jobs;
            assert_int_equal(gtx_encode(asset, &desc, &other, &other_size, NULL), GTX_OK);
            assert_int_equal(size, other_size);
            assert_memory_equal(alone, other, size);
            free(other);
        }
        assert_true(log.runs > 0);
        free(alone);
        gtx_close(asset);
    }
}

/* A host that stops half-way, as a cancelled cook does, gets no file. */
static void run_half(uint32_t count, void (*job)(uint32_t, void *), void *data, void *user)
{
    (void)user;
    for (uint32_t i = 0; i < count / 2; ++i)
        job(i, data);
}

static void test_stopped(void **state)
{
    (void)state;
    if (!gtx_has_zstd())
        skip();
    const gtx_jobs jobs = {run_half, NULL};
    const gtx_encode_desc desc = {.jobs = &jobs, .zstd_level = 3};
    gtx_asset *asset;
    void *data = NULL;
    size_t size = 0;
    assert_int_equal(golden_create(&goldens[0], NULL, &asset, NULL), GTX_OK);
    assert_int_equal(gtx_encode(asset, &desc, &data, &size, NULL), GTX_ERROR_MEMORY);
    assert_null(data);
    gtx_close(asset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_good),     cmocka_unit_test(test_bad),
        cmocka_unit_test(test_mutated),  cmocka_unit_test(test_zeros),
        cmocka_unit_test(test_encoding), cmocka_unit_test(test_stopped)};
    return cmocka_run_group_tests_name("jobs", tests, NULL, NULL);
}
