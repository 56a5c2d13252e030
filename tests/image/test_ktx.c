/* KTX2 images: what the codecs' own transcoder makes of the same files, and files that lie. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/hash.h"
#include "image/image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS_AT = 80, MAX_FILE = 4096 };

/* The texels' hashes are of what basis_transcoder.wasm of three.js 0.187 gives as RGBA32. The first
 * file holds a block of every pattern of every mode of UASTC, of random bits. */
static const struct file {
    const char *name;
    uint32_t width, height;
    uint64_t hash;
} files[] = {{"tests/image/ktx/all_modes.ktx2", 57, 55, 0xfbfbb31fffb24aff},
             {"tests/image/ktx/uastc_zstd.ktx2", 45, 39, 0xb08f9abde5d945b4},
             {"tests/image/ktx/etc1s_alpha.ktx2", 45, 39, 0xdefa456eefdbae3b}};
enum { FILES = sizeof files / sizeof *files };

static size_t read_file(const char *name, uint8_t data[MAX_FILE])
{
    FILE *file = fopen(name, "rb");
    assert_non_null(file);
    const size_t size = fread(data, 1, MAX_FILE, file);
    fclose(file);
    assert_in_range(size, 1, MAX_FILE - 1);
    return size;
}

static void as_the_transcoder_has_it(void **state)
{
    uint8_t data[MAX_FILE];
    (void)state;
    for (int i = 0; i < FILES; ++i) {
        const size_t size = read_file(files[i].name, data);
        uint32_t width, height;
        gtx_image image;
        gtx_error error = {0};
        assert_int_equal(gtx_image_measure(data, size, &width, &height, &error), GTX_OK);
        if (gtx_image_decode(data, size, &image, &error))
            fail_msg("%s: %s", files[i].name, error.message);
        assert_int_equal(image.width, files[i].width);
        assert_int_equal(image.height, files[i].height);
        assert_int_equal(width, image.width);
        assert_int_equal(height, image.height);
        const uint64_t hash = gtx_hash_bytes(image.pixels, 4 * (size_t)width * height);
        if (hash != files[i].hash)
            fail_msg("%s: 0x%016llx", files[i].name, (unsigned long long)hash);
        gtx_image_free(&image);
    }
}

static void put(uint8_t *at, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; ++i)
        at[i] = (uint8_t)(value >> 8 * i);
}

/* A file of 2 x 2 texels, of a format of so many bytes, and the way that rows go ("rd", "ru"). */
static size_t plain_file(uint32_t format, uint32_t bytes, const char *way, uint8_t *data)
{
    static const uint8_t start[] = {0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb,
                                    '\r', '\n', 0x1a, '\n'};
    enum { DFD = LEVELS_AT + 24, KVD = DFD + 44, DATA = KVD + 24 };
    memset(data, 0, DATA);
    memcpy(data, start, sizeof start);
    const uint32_t head[] = {format, 1, 2, 2, 0, 0, 1, 1, 0, DFD, 44, KVD, 22, 0, 0};
    for (size_t i = 0; i < sizeof head / sizeof *head; ++i)
        put(data + 12 + 4 * i, head[i], 4);
    put(data + LEVELS_AT, DATA, 8);
    put(data + LEVELS_AT + 8, 4 * bytes, 8);
    put(data + LEVELS_AT + 16, 4 * bytes, 8);
    put(data + DFD, 44, 4);
    put(data + KVD, 18, 4);
    memcpy(data + KVD + 4, "KTXorientation", 15);
    memcpy(data + KVD + 19, way, 3);
    for (uint32_t i = 0; i < 4 * bytes; ++i)
        data[DATA + i] = (uint8_t)(10 * i + 1);
    return DATA + 4 * bytes;
}

static void plain_texels(void **state)
{
    static const struct {
        uint32_t format, bytes;
        uint8_t texel[4]; /* of the first row, the second one */
    } cases[] = {{9, 1, {11, 11, 11, 255}},  {15, 1, {11, 11, 11, 255}},
                 {23, 3, {31, 41, 51, 255}}, {36, 3, {51, 41, 31, 255}},
                 {37, 4, {41, 51, 61, 71}},  {50, 4, {61, 51, 41, 71}}};
    uint8_t data[MAX_FILE];
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i)
        for (int up = 0; up < 2; ++up) {
            const size_t size =
                plain_file(cases[i].format, cases[i].bytes, up ? "ru" : "rd", data);
            gtx_image image;
            gtx_error error = {0};
            if (gtx_image_decode(data, size, &image, &error))
                fail_msg("%u: %s", cases[i].format, error.message);
            assert_memory_equal(image.pixels + (up ? 12 : 4), cases[i].texel, 4);
            gtx_image_free(&image);
        }
}

static void refused(uint8_t *data, size_t size, gtx_result wanted, const char *text)
{
    gtx_image image = {0};
    gtx_error error = {0};
    assert_int_equal(gtx_image_decode(data, size, &image, &error), wanted);
    assert_null(image.pixels);
    if (!strstr(error.message, text))
        fail_msg("'%s' is not in '%s'", text, error.message);
}

static void what_is_no_texture_is_refused_by_name(void **state)
{
    static const struct {
        size_t at;
        uint32_t value;
        gtx_result result;
        const char *text;
    } cases[] = {
        {12, 145, GTX_ERROR_UNSUPPORTED, "this one has Vulkan's format 145"},
        {12, 0, GTX_ERROR_UNSUPPORTED, "model 0"},
        {44, 3, GTX_ERROR_UNSUPPORTED, "scheme 3"},
        {28, 2, GTX_ERROR_UNSUPPORTED, "a volume"},
        {32, 5, GTX_ERROR_UNSUPPORTED, "an array"},
        {36, 6, GTX_ERROR_UNSUPPORTED, "a cube"},
        {20, 0, GTX_ERROR_READ, "what cannot be"},
        {20, 3, GTX_ERROR_READ, "what cannot be"},
        {20, UINT32_MAX, GTX_ERROR_LIMIT, "pixels"},
        {40, 33, GTX_ERROR_READ, "what cannot be"},
        {48, 4000, GTX_ERROR_READ, "what cannot be"},
        {LEVELS_AT, 4000, GTX_ERROR_READ, "what cannot be"},
        {LEVELS_AT + 8, 4, GTX_ERROR_READ, "what cannot be"},
    };
    uint8_t data[MAX_FILE];
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        const size_t size = plain_file(37, 4, "rd", data);
        put(data + cases[i].at, cases[i].value, 4);
        if (cases[i].result == GTX_ERROR_LIMIT)
            put(data + 24, UINT32_MAX, 4);
        refused(data, size, cases[i].result, cases[i].text);
    }
}

/* In memory of its own, for the sanitizers. True if it was refused. */
static int is_refused(const uint8_t *data, size_t size)
{
    gtx_image image;
    uint8_t *copy = malloc(size);
    assert_non_null(copy);
    memcpy(copy, data, size);
    const gtx_result result = gtx_image_decode(copy, size, &image, NULL);
    if (!result)
        gtx_image_free(&image);
    free(copy);
    return result != GTX_OK;
}

/* Ended anywhere; then with any byte another, but for those of the size. */
static void broken_files_do_no_harm(void **state)
{
    uint8_t data[MAX_FILE];
    unsigned refusals = 0, tried = 0;
    (void)state;
    for (int i = 0; i < FILES; ++i) {
        const size_t size = read_file(files[i].name, data);
        for (size_t end = 13; end < size; ++end)
            if (!is_refused(data, end))
                fail_msg("%s: %zu of %zu bytes are enough", files[i].name, end, size);
        for (size_t at = 0; at < size; ++at) {
            if (at < 12 || (at >= 20 && at < 28))
                continue;
            data[at] ^= (uint8_t)(1 + at * 37 % 255);
            ++tried;
            refusals += is_refused(data, size) != 0;
            data[at] ^= (uint8_t)(1 + at * 37 % 255);
        }
    }
    print_message("# %u of %u refused\n", refusals, tried);
    assert_true(refusals > 100 && refusals < tried);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_the_transcoder_has_it),
        cmocka_unit_test(plain_texels),
        cmocka_unit_test(what_is_no_texture_is_refused_by_name),
        cmocka_unit_test(broken_files_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
