/* Memory: every byte goes through the caller's hooks and comes back with its size, running out is
 * a result, and the limit on what opening may take is exact. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/codec.h"
#include "asset/golden.h"
#include "asset/read.h"
#include "common/runners.h"

#include <unistd.h>

/* ---- memory that counts and fails ---- */

typedef struct meter {
    size_t live, peak, blocks, calls, fail_at; /* fail_at: this call and later ones; 0 = never */
} meter;

static void *meter_alloc(size_t size, void *user)
{
    meter *m = user;
    if (++m->calls >= m->fail_at && m->fail_at)
        return NULL;
    size_t *block = need(malloc(size + 16));
    *block = size;
    m->live += size;
    m->peak = m->live > m->peak ? m->live : m->peak;
    ++m->blocks;
    return (char *)block + 16;
}

static void meter_free(void *memory, size_t size, void *user)
{
    meter *m = user;
    size_t *block = (size_t *)((char *)memory - 16);
    assert_int_equal(*block, size);
    m->live -= size;
    --m->blocks;
    free(block);
}

static gtx_allocator hooks(meter *m)
{
    return (gtx_allocator){meter_alloc, meter_free, m};
}

static bool readable(const golden *g)
{
    return !g->zstd_level || gtx_has_zstd();
}

/* ---- every call that allocates ---- */

typedef gtx_result (*attempt_fn)(const gtx_allocator *allocator, const golden *g);

static void golden_path(const golden *g, char out[256])
{
    snprintf(out, 256, GOOD "%s.gtx", g->name);
}

static gtx_result attempt_open(const gtx_allocator *allocator, const golden *g)
{
    bytes file = read_golden(g->name);
    gtx_open_desc desc = {.allocator = allocator};
    gtx_asset *asset;
    gtx_result result = gtx_open_memory(file.data, file.size, &desc, &asset, NULL);
    assert_int_equal(!asset, result != GTX_OK);
    gtx_close(asset);
    free(file.data);
    return result;
}

static gtx_result attempt_open_file(const gtx_allocator *allocator, const golden *g)
{
    char path[256];
    golden_path(g, path);
    gtx_open_desc desc = {.allocator = allocator};
    gtx_asset *asset;
    gtx_result result = gtx_open_file(path, &desc, &asset, NULL);
    assert_int_equal(!asset, result != GTX_OK);
    gtx_close(asset);
    return result;
}

/* As gtx_validate does, but for its memory. */
static gtx_result attempt_validate(const gtx_allocator *allocator, const golden *g)
{
    bytes file = read_golden(g->name);
    gtx_check check = {.keep_going = true};
    const gtx_read_options options = {.allocator = *allocator};
    gtx_asset *asset;
    gtx_result result = gtx_read_asset(&check, &options, file.data, file.size, &asset);
    assert_int_equal(check.broken, 0);
    gtx_close(asset);
    free(file.data);
    return result;
}

static gtx_result attempt_create(const gtx_allocator *allocator, const golden *g)
{
    gtx_asset *asset = NULL;
    gtx_result result = golden_create(g, allocator, &asset, NULL);
    assert_int_equal(!asset, result != GTX_OK);
    gtx_close(asset);
    return result;
}

static gtx_result attempt_encode(const gtx_allocator *allocator, const golden *g)
{
    gtx_asset *asset;
    assert_int_equal(golden_create(g, NULL, &asset, NULL), GTX_OK);
    gtx_encode_desc desc = {.allocator = allocator, .zstd_level = golden_level(g)};
    void *data = NULL;
    size_t size = 0;
    gtx_result result = gtx_encode(asset, &desc, &data, &size, NULL);
    assert_int_equal(!data, result != GTX_OK);
    if (data)
        allocator->free(data, size, allocator->user);
    gtx_close(asset);
    return result;
}

/* What cannot be saved leaves no file behind. */
static gtx_result attempt_save(const gtx_allocator *allocator, const golden *g)
{
    char folder[] = "/tmp/gtx-memory-XXXXXX", path[256];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/a.gtx", folder);
    gtx_asset *asset;
    assert_int_equal(golden_create(g, NULL, &asset, NULL), GTX_OK);
    gtx_encode_desc desc = {.allocator = allocator, .zstd_level = golden_level(g)};
    gtx_result result = gtx_save_file(asset, path, &desc, NULL);
    assert_int_equal(remove(path) == 0, result == GTX_OK);
    assert_int_equal(rmdir(folder), 0);
    gtx_close(asset);
    return result;
}

/* Every allocation fails in turn: a clear result, and nothing is left. Returns the allocations
 * that success takes. */
static size_t exhaust(attempt_fn attempt, const golden *g)
{
    for (size_t fail_at = 1;; ++fail_at) {
        meter m = {.fail_at = fail_at};
        gtx_allocator allocator = hooks(&m);
        gtx_result result = attempt(&allocator, g);
        assert_int_equal(m.blocks, 0);
        assert_int_equal(m.live, 0);
        if (m.calls < fail_at) {
            assert_int_equal(result, GTX_OK);
            return m.calls;
        }
        assert_int_equal(result, GTX_ERROR_MEMORY);
    }
}

static void test_exhaustion(void **state)
{
    (void)state;
    for (int i = 0; i < GOLDEN_COUNT; ++i) {
        const golden *g = &goldens[i];
        if (!readable(g))
            continue;
        /* An asset, its records, a section each, and which texels are taken. */
        size_t levels = 1 + (g->maps & COLOR ? 1 : 0) + (g->maps & MATERIAL ? 1 : 0) +
                        (g->maps & EMISSION ? 1 : 0);
        size_t created = 2 + 2 + levels * g->mips + g->lods + (g->meta ? 1 : 0) + 1;
        assert_int_equal(exhaust(attempt_create, g), created);
        assert_in_range(exhaust(attempt_open, g), created, created + 2);
        assert_in_range(exhaust(attempt_validate, g), created, created + 2);
        assert_in_range(exhaust(attempt_open_file, g), created + 1, created + 3);
        size_t encoded = exhaust(attempt_encode, g); /* the file, and all that compressing takes */
        assert_int_equal(encoded, g->zstd_level ? 2 : 1);
        assert_int_equal(exhaust(attempt_save, g), encoded);
    }
}

/* ---- limits ---- */

typedef gtx_result (*open_fn)(const golden *g, const gtx_open_desc *desc, gtx_asset **out,
                              gtx_error *error);

static gtx_result open_golden_memory(const golden *g, const gtx_open_desc *desc, gtx_asset **out,
                                     gtx_error *error)
{
    bytes file = read_golden(g->name);
    gtx_result result = gtx_open_memory(file.data, file.size, desc, out, error);
    free(file.data);
    return result;
}

static gtx_result open_golden_file(const golden *g, const gtx_open_desc *desc, gtx_asset **out,
                                   gtx_error *error)
{
    char path[256];
    golden_path(g, path);
    return gtx_open_file(path, desc, out, error);
}

/* What opening takes is said before, and is all that it takes. */
static void check_limit(const golden *g, open_fn open, const gtx_jobs *jobs, size_t most_calls)
{
    meter m = {0};
    gtx_allocator allocator = hooks(&m);
    gtx_open_desc desc = {.allocator = &allocator, .jobs = jobs};
    gtx_asset *asset;
    assert_int_equal(open(g, &desc, &asset, NULL), GTX_OK);
    gtx_close(asset);
    size_t peak = m.peak;
    desc.limits.memory = peak;
    assert_int_equal(open(g, &desc, &asset, NULL), GTX_OK);
    gtx_close(asset);
    for (desc.limits.memory = peak - 1; desc.limits.memory > 0; desc.limits.memory /= 2) {
        m = (meter){0};
        gtx_error error = {0};
        assert_int_equal(open(g, &desc, &asset, &error), GTX_ERROR_LIMIT);
        assert_null(asset);
        assert_int_equal(error.result, GTX_ERROR_LIMIT);
        assert_int_equal(error.rule, 0);
        assert_string_equal(error.limit, "memory");
        assert_in_range(m.calls, 0, most_calls);
        assert_int_equal(m.blocks, 0);
    }
}

static void test_memory_limit(void **state)
{
    (void)state;
    runner_log log;
    const gtx_jobs jobs = runner_of(0, &log);
    for (int i = 0; i < GOLDEN_COUNT; ++i) {
        if (!readable(&goldens[i]))
            continue;
        check_limit(&goldens[i], open_golden_memory, NULL, 0);
        check_limit(&goldens[i], open_golden_file, NULL, 1); /* the bytes of the file */
        check_limit(&goldens[i], open_golden_memory, &jobs, 0);
    }
}

/* A file of a few kilobytes that claims pages of gigabytes is refused without trying. */
static void test_bomb(void **state)
{
    (void)state;
    bytes file = read_golden("zstd");
    gtx_store_u32(file.data + 60, 16384);
    gtx_store_u32(file.data + 64, 16384);
    uint32_t count = gtx_load_u32(file.data + 28);
    for (uint32_t i = 0; i < count; ++i) {
        uint8_t *entry = file.data + GTX_HEADER_SIZE + GTX_ENTRY_SIZE * i;
        if (gtx_section_is_image(gtx_section_kind_of(entry)))
            gtx_store_u64(entry + 32, gtx_load_u64(entry + 32) * 65536);
    }
    rehash_header(file, true);
    meter m = {0};
    gtx_allocator allocator = hooks(&m);
    gtx_open_desc desc = {.allocator = &allocator};
    gtx_asset *asset;
    gtx_error error = {0};
    assert_int_equal(gtx_open_memory(file.data, file.size, &desc, &asset, &error),
                     GTX_ERROR_CORRUPT);
    assert_int_equal(error.rule, 213);
    assert_int_equal(m.calls, 0);
    free(file.data);
}

/* A file whose table holds and whose sections would decode to `pages` x 1 GiB. */
static bytes make_large(uint32_t pages)
{
    gtx_info info = {.patch_count = 1, .page_count = pages, .page_width = 16384,
                     .page_height = 16384, .mip_count = 1, .height_bits = 8, .unit = 1};
    static const gtx_section_kind kinds[] = {GTX_SECTION_PATCHES, GTX_SECTION_HEIGHT,
                                             GTX_SECTION_TRIM, GTX_SECTION_NORMAL};
    gtx_section sections[4];
    uint64_t end = GTX_HEADER_SIZE + 4 * GTX_ENTRY_SIZE;
    for (int i = 0; i < 4; ++i) {
        sections[i] = gtx_section_describe(&info, kinds[i], 0);
        sections[i].scheme = GTX_SCHEME_ZSTD;
        sections[i].stored_size = sections[i].size / 32768 + 1;
        sections[i].offset = end;
        end = gtx_align64(end + sections[i].stored_size);
    }
    bytes file = {need(calloc(end, 1)), end};
    gtx_header_store(file.data, &info, sections, 4, end);
    return file;
}

/* Without a limit of the caller's own there is one all the same, for validation too. */
static void test_default_limit(void **state)
{
    (void)state;
    if (!gtx_has_zstd())
        skip();
    bytes file = make_large(4);
    meter m = {0};
    gtx_allocator allocator = hooks(&m);
    gtx_open_desc desc = {.allocator = &allocator};
    gtx_asset *asset;
    gtx_error error = {0};
    assert_int_equal(gtx_open_memory(file.data, file.size, &desc, &asset, &error),
                     GTX_ERROR_LIMIT);
    assert_int_equal(m.calls, 0);
    error = (gtx_error){0};
    assert_int_equal(gtx_validate(file.data, file.size, NULL, NULL, NULL, &error), GTX_ERROR_LIMIT);
    assert_int_equal(error.result, GTX_ERROR_LIMIT);
    free(file.data);
}

/* ---- nothing beside the hooks ---- */

/* The objects of libgeotex ask libc for no memory but through base/alloc. */
static void test_objects(void **state)
{
    (void)state;
    if (!getenv("GTX_OUT"))
        skip();
    static const char *const rooms[] = {"asset", "derive", "trace", "stream"};
    for (int i = 0; i < 4; ++i) {
        char command[1024], line[256];
        snprintf(command, sizeof command, "nm -u '%s'/lib/%s/*.o 2>/dev/null", getenv("GTX_OUT"),
                 rooms[i]);
        FILE *names = need(popen(command, "r"));
        while (fgets(line, sizeof line, names)) {
            const char *name = strrchr(line, ' ');
            static const char *const calls[] = {"malloc", "calloc", "realloc", "free", "strdup",
                                                "aligned_alloc", "posix_memalign"};
            for (size_t k = 0; name && k < sizeof calls / sizeof calls[0]; ++k)
                if (!strncmp(name + 1, calls[k], strlen(calls[k])) &&
                    name[1 + strlen(calls[k])] == '\n')
                    fail_msg("lib/%s calls %s", rooms[i], calls[k]);
        }
        pclose(names);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exhaustion),    cmocka_unit_test(test_memory_limit),
        cmocka_unit_test(test_bomb),          cmocka_unit_test(test_default_limit),
        cmocka_unit_test(test_objects),
    };
    return cmocka_run_group_tests_name("memory", tests, NULL, NULL);
}
