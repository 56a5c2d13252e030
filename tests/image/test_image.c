/* Images: written and read back, and the errors of files that are not images. */
#define _POSIX_C_SOURCE 200809L
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include <cmocka.h>

#include "image/image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char directory[] = "/tmp/geotex-image-XXXXXX";

static const char *in_directory(const char *name)
{
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    return path;
}

static int make_directory(void **state)
{
    (void)state;
    return mkdtemp(directory) ? 0 : -1;
}

static int remove_directory(void **state)
{
    (void)state;
    static const char *const files[] = {"a.png", "z.exr", "text.png", "empty.png"};
    for (size_t i = 0; i < sizeof files / sizeof *files; ++i)
        remove(in_directory(files[i]));
    return rmdir(directory); /* fails when a temporary file was left behind */
}

static void fill(uint8_t *pixels, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        pixels[i] = (uint8_t)(i * 37 + i / 7);
}

static void png_of_every_channel_count(void **state)
{
    (void)state;
    enum { W = 33, H = 17 };
    static const uint32_t channels[] = {1, 3, 4};
    uint8_t pixels[4 * W * H];
    gtx_error error = {0};
    fill(pixels, sizeof pixels);
    for (int k = 0; k < 3; ++k) {
        const uint32_t n = channels[k];
        gtx_image image;
        assert_int_equal(gtx_image_write_png(in_directory("a.png"), W, H, n, pixels, &error),
                         GTX_OK);
        assert_int_equal(gtx_image_read(in_directory("a.png"), &image, &error), GTX_OK);
        assert_int_equal(image.width, W);
        assert_int_equal(image.height, H);
        for (int i = 0; i < W * H; ++i)
            for (uint32_t c = 0; c < 4; ++c) {
                const uint32_t from = n == 1 ? 0 : c;
                const int expected = c < 3 || n == 4 ? pixels[(uint32_t)i * n + from] : 255;
                assert_int_equal(image.pixels[4 * i + (int)c], expected);
            }
        gtx_image_free(&image);
        assert_null(image.pixels);
    }
}

static void the_same_from_memory(void **state)
{
    (void)state;
    uint8_t pixels[4 * 8 * 8], bytes[4096];
    gtx_image image;
    gtx_error error = {0};
    fill(pixels, sizeof pixels);
    assert_int_equal(gtx_image_write_png(in_directory("a.png"), 8, 8, 4, pixels, &error), GTX_OK);
    FILE *file = fopen(in_directory("a.png"), "rb");
    assert_non_null(file);
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    assert_int_equal(gtx_image_decode(bytes, size, &image, &error), GTX_OK);
    assert_memory_equal(image.pixels, pixels, sizeof pixels);
    gtx_image_free(&image);
    uint32_t width = 0, height = 0;
    assert_int_equal(gtx_image_measure(bytes, size, &width, &height, &error), GTX_OK);
    assert_true(width == 8 && height == 8);
    assert_int_equal(gtx_image_measure(bytes, 20, &width, &height, &error), GTX_ERROR_READ);
    assert_null(strchr(error.message, '\n'));
    assert_int_equal(gtx_image_measure("geotex", 6, &width, &height, &error), GTX_ERROR_READ);
    assert_int_equal(gtx_image_measure(bytes, 0, &width, &height, NULL), GTX_ERROR_ARGUMENT);
    for (size_t cut = 1; cut < size; cut += 7) { /* truncated: an error, or rows that are missing */
        if (gtx_image_decode(bytes, cut, &image, &error) == GTX_OK)
            gtx_image_free(&image);
        else
            assert_int_equal(error.result, GTX_ERROR_READ);
    }
    assert_int_equal(gtx_image_decode("geotex", 6, &image, &error), GTX_ERROR_READ);
}

static void depth_as_exr(void **state)
{
    (void)state;
    const float z[6] = {0, 0.25f, 1, 2, 3, 1e30f};
    char start[8] = "";
    gtx_error error = {0};
    assert_int_equal(gtx_image_write_exr(in_directory("z.exr"), 3, 2, z, &error), GTX_OK);
    FILE *file = fopen(in_directory("z.exr"), "rb");
    assert_non_null(file);
    assert_int_equal(fread(start, 1, 4, file), 4);
    fclose(file);
    assert_memory_equal(start, "\x76\x2f\x31\x01", 4);
    gtx_image image;
    assert_int_equal(gtx_image_read(in_directory("z.exr"), &image, &error), GTX_OK);
    assert_int_equal(image.width * image.height, 6);
    gtx_image_free(&image);
}

static void errors_say_what_is_wrong(void **state)
{
    (void)state;
    const uint8_t pixel[4] = {0};
    gtx_image image;
    gtx_error error = {0};
    assert_int_equal(gtx_image_read(in_directory("none.png"), &image, &error), GTX_ERROR_READ);
    assert_non_null(strstr(error.message, "none.png"));
    assert_int_equal(gtx_image_write_png(in_directory("no/a.png"), 1, 1, 4, pixel, &error),
                     GTX_ERROR_WRITE);
    assert_int_equal(gtx_image_write_png(in_directory("a.png"), 1, 1, 2, pixel, &error),
                     GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_image_write_png(in_directory("a.png"), 0, 1, 4, pixel, &error),
                     GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_image_write_png(NULL, 1, 1, 4, pixel, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_image_read(NULL, &image, NULL), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_image_decode(pixel, 0, &image, NULL), GTX_ERROR_ARGUMENT);
    FILE *file = fopen(in_directory("text.png"), "wb");
    fputs("not an image", file);
    fclose(file);
    assert_int_equal(gtx_image_read(in_directory("text.png"), &image, &error), GTX_ERROR_READ);
    fclose(fopen(in_directory("empty.png"), "wb"));
    assert_int_equal(gtx_image_read(in_directory("empty.png"), &image, &error), GTX_ERROR_READ);
    gtx_image_free(NULL);
}

static void put(uint8_t *at, uint32_t value, int bytes)
{
    for (int i = 0; i < bytes; ++i)
        at[i] = (uint8_t)(value >> 8 * i);
}

/* Their reader would write and read past its rows. */
static void no_bmp_of_runs(void **state)
{
    (void)state;
    enum { PALETTE = 54, RUNS = PALETTE + 2 * 4, SIZE = RUNS + 8 };
    static const uint8_t runs[8] = {64, 0, 0, 0, 64, 1, 0, 1};
    for (uint32_t bits = 8; bits <= 32; bits *= 2) {
        uint8_t bmp[SIZE] = "BM";
        const uint32_t fields[][3] = {{2, SIZE, 4}, {10, RUNS, 4}, {14, 40, 4}, {18, 64, 4},
                                      {22, 2, 4},   {26, 1, 2},    {28, bits, 2}, {30, 1, 4},
                                      {34, 8, 4},   {46, 2, 4},    {PALETTE + 4, 0xffffff, 4}};
        for (size_t i = 0; i < sizeof fields / sizeof *fields; ++i)
            put(bmp + fields[i][0], fields[i][1], (int)fields[i][2]);
        memcpy(bmp + RUNS, runs, sizeof runs);
        gtx_image image = {0};
        gtx_error error = {0};
        assert_int_equal(gtx_image_decode(bmp, sizeof bmp, &image, &error), GTX_ERROR_READ);
        assert_non_null(strstr(error.message, "runs"));
    }
}

/* A strip that a TIFF tells of, of a hundred gigabytes for an image of 16 pixels. */
static void strips_are_no_larger_than_the_image(void **state)
{
    (void)state;
    static const uint32_t tags[][2] = {{256, 4}, {257, 4}, {258, 8}, {259, 8}, {262, 1},
                                       {273, 200}, {277, 1}, {278, 0}, {279, 24}};
    enum { TAGS = sizeof tags / sizeof *tags };
    for (int huge = 0; huge < 2; ++huge) {
        uint8_t tiff[224] = {'I', 'I', 42, 0, 8, 0, 0, 0, TAGS};
        /* 16 times 0 as zlib writes it */
        static const uint8_t packed[] = {0x78, 0x9c, 0x63, 0x60, 0x40, 0x05, 0, 0, 0x10, 0, 1};
        for (size_t i = 0; i < TAGS; ++i) {
            put(tiff + 10 + 12 * i, tags[i][0], 2);
            put(tiff + 12 + 12 * i, 4, 2);
            put(tiff + 14 + 12 * i, 1, 4);
            put(tiff + 18 + 12 * i, tags[i][0] == 278 ? (huge ? 0x70000000u : 4) : tags[i][1], 4);
        }
        memcpy(tiff + 200, packed, sizeof packed);
        gtx_image image = {0};
        gtx_error error = {0};
        const gtx_result result = gtx_image_decode(tiff, sizeof tiff, &image, &error);
        assert_int_equal(result, huge ? GTX_ERROR_READ : GTX_OK);
        if (huge)
            assert_non_null(strstr(error.message, "size"));
        gtx_image_free(&image);
    }
}

/* 64 rows would be taken at once, 2 GB, for the four that there are. */
static void rows_are_not_too_long(void **state)
{
    (void)state;
    uint8_t bmp[102] = "BM";
    const uint32_t fields[][3] = {{2, sizeof bmp, 4}, {10, 54, 4}, {14, 40, 4}, {18, 8388611, 4},
                                  {22, 4, 4},         {26, 1, 2},  {28, 24, 2}};
    for (size_t i = 0; i < sizeof fields / sizeof *fields; ++i)
        put(bmp + fields[i][0], fields[i][1], (int)fields[i][2]);
    uint32_t width, height;
    gtx_error error = {0};
    assert_int_equal(gtx_image_measure(bmp, sizeof bmp, &width, &height, &error), GTX_ERROR_READ);
    assert_non_null(strstr(error.message, "size"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(png_of_every_channel_count), cmocka_unit_test(the_same_from_memory),
        cmocka_unit_test(depth_as_exr),               cmocka_unit_test(errors_say_what_is_wrong),
        cmocka_unit_test(no_bmp_of_runs),
        cmocka_unit_test(strips_are_no_larger_than_the_image),
        cmocka_unit_test(rows_are_not_too_long),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
