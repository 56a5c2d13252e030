/* The public calls of an asset: arguments, accessors, files. */
#include "asset/specimen.h"

#include <signal.h>
#include <sys/resource.h>

static void test_arguments(void **state)
{
    (void)state;
    specimen s;
    make_specimen(&s);
    gtx_asset *asset = NULL;
    gtx_error error;
    assert_int_equal(gtx_create(NULL, &asset, &error), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_create(&s.desc, NULL, &error), GTX_ERROR_ARGUMENT);
    s.desc.reserved[5] = 1;
    assert_int_equal(gtx_create(&s.desc, &asset, &error), GTX_ERROR_NOT_ZEROED);
    s.desc.reserved[5] = 0;
    s.desc.height_bits = 12;
    assert_int_equal(gtx_create(&s.desc, &asset, &error), GTX_ERROR_ARGUMENT);
    s.desc.height_bits = 8;
    s.levels[0] = NULL;
    assert_int_equal(gtx_create(&s.desc, &asset, &error), GTX_ERROR_ARGUMENT);
    s.levels[0] = s.normal;
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_OK);

    gtx_asset *other = asset;
    gtx_open_desc open = {.reserved = {1}};
    assert_int_equal(gtx_open_memory("x", 1, &open, &other, &error), GTX_ERROR_NOT_ZEROED);
    open = (gtx_open_desc){.flags = 2};
    assert_int_equal(gtx_open_memory("x", 1, &open, &other, &error), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_open_memory(NULL, 1, NULL, &other, &error), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_open_memory("x", 1, NULL, NULL, &error), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_open_memory(NULL, 0, NULL, &other, &error), GTX_ERROR_TRUNCATED);
    assert_int_equal(gtx_open_memory("text", 4, NULL, &other, &error), GTX_ERROR_NOT_GTX);
    assert_null(other);
    assert_int_equal(gtx_validate(NULL, 1, NULL, NULL, NULL, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_validate(NULL, 0, NULL, NULL, NULL, NULL), GTX_ERROR_TRUNCATED);

    void *data;
    size_t size;
    gtx_encode_desc encode = {.zstd_level = 20};
    assert_int_equal(gtx_encode(asset, &encode, &data, &size, &error), GTX_ERROR_ARGUMENT);
    encode.zstd_level = -2;
    assert_int_equal(gtx_encode(asset, &encode, &data, &size, &error), GTX_ERROR_ARGUMENT);
    encode = (gtx_encode_desc){.reserved = {0, 0, 0, 0, 7}};
    assert_int_equal(gtx_encode(asset, &encode, &data, &size, &error), GTX_ERROR_NOT_ZEROED);
    encode = (gtx_encode_desc){.zstd_level = 3};
    if (!gtx_has_zstd())
        assert_int_equal(gtx_encode(asset, &encode, &data, &size, &error), GTX_ERROR_UNSUPPORTED);
    assert_int_equal(gtx_save_file(asset, NULL, NULL, &error), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_open_file(NULL, NULL, &other, &error), GTX_ERROR_ARGUMENT);
    gtx_close(asset);
    gtx_close(NULL);
}

static void test_accessors(void **state)
{
    (void)state;
    specimen s;
    make_specimen(&s);
    gtx_asset *asset;
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_OK);
    gtx_info info;
    gtx_get_info(asset, &info);
    assert_true(info.unit == 1);
    assert_int_equal(info.file_size, 0);
    size_t size = 1;
    assert_memory_equal(gtx_map_data(asset, GTX_MAP_HEIGHT, 0, &size), s.height, 256);
    assert_int_equal(size, 256);
    assert_non_null(gtx_map_data(asset, GTX_MAP_NORMAL, 0, NULL));
    assert_null(gtx_map_data(asset, GTX_MAP_HEIGHT, 1, &size));
    assert_int_equal(size, 0);
    assert_null(gtx_map_data(asset, GTX_MAP_NORMAL, 1, NULL));
    assert_null(gtx_map_data(asset, GTX_MAP_COLOR, 0, NULL));
    assert_null(gtx_map_data(asset, (gtx_map)99, 0, NULL));
    assert_null(gtx_meta(asset, &size));
    assert_int_equal(size, 0);
    gtx_close(asset);
}

/* Hashes of sections may be trusted; the header's never is. */
static void test_skip_hash(void **state)
{
    (void)state;
    bytes file = read_golden("minimal");
    gtx_open_desc desc = {.flags = GTX_OPEN_SKIP_HASH};
    gtx_asset *asset;
    gtx_error error = {0};
    file.data[704] ^= 1;
    assert_int_equal(gtx_open_memory(file.data, file.size, NULL, &asset, &error),
                     GTX_ERROR_CORRUPT);
    assert_int_equal(error.rule, 210);
    assert_int_equal(gtx_open_memory(file.data, file.size, &desc, &asset, &error), GTX_OK);
    gtx_close(asset);
    file.data[136] ^= 1;
    assert_int_equal(gtx_open_memory(file.data, file.size, &desc, &asset, &error),
                     GTX_ERROR_CORRUPT);
    assert_int_equal(error.rule, 117);
    free(file.data);
}

/* ---- files ---- */

static void path_in(char out[256], const char *folder, const char *name)
{
    snprintf(out, 256, "%s/%s", folder, name);
}

static void test_files(void **state)
{
    (void)state;
    char folder[] = "/tmp/gtx-asset-XXXXXX", path[256], taken[256];
    assert_non_null(mkdtemp(folder));
    path_in(path, folder, "a.gtx");
    path_in(taken, folder, "folder");

    bytes golden_file = read_golden("color");
    gtx_asset *asset, *other;
    gtx_error error = {0};
    assert_int_equal(gtx_open_file(GOOD "color.gtx", NULL, &asset, NULL), GTX_OK);
    const gtx_encode_desc stored = {.zstd_level = -1};
    assert_int_equal(gtx_save_file(asset, path, NULL, NULL), GTX_OK);
    bytes compressed = read_file(path);
    assert_true(!gtx_has_zstd() || compressed.size < golden_file.size);
    free(compressed.data);
    assert_int_equal(gtx_save_file(asset, path, &stored, NULL), GTX_OK); /* over what is there */
    bytes saved = read_file(path);
    assert_int_equal(saved.size, golden_file.size);
    assert_memory_equal(saved.data, golden_file.data, saved.size);

    assert_int_equal(gtx_open_file(folder, NULL, &other, &error), GTX_ERROR_READ);
    assert_string_equal(strstr(error.message, ": "), ": Is a directory");
    assert_int_equal(gtx_open_file("/nowhere/a.gtx", NULL, &other, &error), GTX_ERROR_READ);
    assert_string_equal(error.message, "cannot open /nowhere/a.gtx: No such file or directory");
    assert_int_equal(gtx_save_file(asset, "/nowhere/a.gtx", NULL, &error), GTX_ERROR_WRITE);
    assert_non_null(strstr(error.message, "No such file or directory"));

    /* A folder stands where the file should go: it stays, and nothing else does. */
    assert_int_equal(mkdir(taken, 0700), 0);
    assert_int_equal(gtx_save_file(asset, taken, NULL, &error), GTX_ERROR_WRITE);
    assert_int_equal(rmdir(taken), 0);

    write_file(path, (bytes){saved.data, 0});
    assert_int_equal(gtx_open_file(path, NULL, &other, &error), GTX_ERROR_TRUNCATED);
    assert_null(other);
    remove(path);
    assert_int_equal(rmdir(folder), 0); /* nothing else was left in it */
    free(saved.data);
    free(golden_file.data);
    gtx_close(asset);
}

/* A disk that is full does not cost what was there, nor does what lies under the name that a
 * temporary file might have. */
static void test_full_disk(void **state)
{
    (void)state;
    gtx_asset *asset;
    gtx_error error = {0};
    struct rlimit old;
    char folder[] = "/tmp/gtx-asset-XXXXXX", path[256], other[256];
    assert_non_null(mkdtemp(folder));
    path_in(path, folder, "a.gtx");
    path_in(other, folder, "a.gtx.tmp");
    write_file(path, (bytes){(uint8_t *)"old", 3});
    write_file(other, (bytes){(uint8_t *)"mine", 4});
    assert_int_equal(gtx_open_file(GOOD "color.gtx", NULL, &asset, NULL), GTX_OK);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
    signal(SIGXFSZ, SIG_IGN);
    const struct rlimit small = {64, old.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    const gtx_result saved = gtx_save_file(asset, path, NULL, &error);
    setrlimit(RLIMIT_FSIZE, &old);
    assert_int_equal(saved, GTX_ERROR_WRITE);
    assert_non_null(strstr(error.message, ": File too large"));
    bytes kept = read_file(path), mine = read_file(other);
    assert_true(kept.size == 3 && !memcmp(kept.data, "old", 3));
    assert_true(mine.size == 4 && !memcmp(mine.data, "mine", 4));
    free(kept.data);
    free(mine.data);
    gtx_close(asset);
    remove(path);
    remove(other);
    assert_int_equal(rmdir(folder), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_arguments),
        cmocka_unit_test(test_accessors),
        cmocka_unit_test(test_skip_hash),
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_full_disk),
    };
    return cmocka_run_group_tests_name("api", tests, NULL, NULL);
}
