/* PNG and JPEG, whole, cut short and meant to take forever, without OpenImageIO. */
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

#define FOLDER "tests/image/png_jpeg/"
enum { SIDE = 8, MAX_FILE = 8192 };

static char written[] = "/tmp/gtx-png-XXXXXX";

static size_t slurp(const char *path, uint8_t bytes[MAX_FILE])
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    const size_t size = fread(bytes, 1, MAX_FILE, file);
    fclose(file);
    assert_in_range(size, 1, MAX_FILE - 1);
    return size;
}

static gtx_image read_file(const char *path)
{
    gtx_image image = {0};
    gtx_error error = {0};
    if (gtx_image_read(path, &image, &error))
        fail_msg("%s", error.message);
    assert_int_equal(image.width, SIDE);
    assert_int_equal(image.height, SIDE);
    return image;
}

static void assert_near(const uint8_t *rgba, int r, int g, int b, int a, int bound)
{
    const int expected[4] = {r, g, b, a};
    for (int c = 0; c < 4; ++c)
        if (abs(rgba[c] - expected[c]) > bound)
            fail_msg("%d %d %d %d, not %d %d %d %d", rgba[0], rgba[1], rgba[2], rgba[3], r, g, b,
                     a);
}

/* Two bits a pixel, colours by number, of which three have an alpha. */
static void a_palette_becomes_colours(void **state)
{
    static const int colors[4][4] = {
        {255, 0, 0, 255}, {0, 255, 0, 0}, {0, 0, 255, 128}, {9, 9, 9, 255}};
    (void)state;
    gtx_image image = read_file(FOLDER "palette.png");
    for (int i = 0; i < SIDE * SIDE; ++i) {
        const int *c = colors[(i % SIDE + i / SIDE) % 4];
        assert_near(image.pixels + 4 * i, c[0], c[1], c[2], c[3], 0);
    }
    gtx_image_free(&image);
}

static void sixteen_bits_are_kept(void **state)
{
    uint16_t pixels[SIDE * SIDE];
    (void)state;
    for (int i = 0; i < SIDE * SIDE; ++i)
        pixels[i] = (uint16_t)(i * 1040);
    gtx_error error = {0};
    assert_int_equal(gtx_image_write_png16(written, SIDE, SIDE, pixels, &error), GTX_OK);
    gtx_raw_image raw = {0};
    assert_int_equal(gtx_image_read_raw(written, &raw, &error), GTX_OK);
    assert_true(raw.channels == 1 && raw.depth == 2);
    assert_memory_equal(raw.pixels, pixels, sizeof pixels);
    free(raw.pixels);
    gtx_value_image values = {0};
    assert_int_equal(gtx_image_read_values(written, &values, &error), GTX_OK);
    assert_true(values.least == 0 && values.greatest == 65535);
    gtx_image image = read_file(written);
    for (int i = 0; i < SIDE * SIDE; ++i) {
        assert_true(values.values[i] == pixels[i]);
        const int grey = (pixels[i] + 128) / 257;
        assert_near(image.pixels + 4 * i, grey, grey, grey, 255, 0);
    }
    free(values.values);
    gtx_image_free(&image);
}

/* Pixels of x * 31 + y * 4, in a baseline file and in a progressive one. */
static void grey_jpegs(void **state)
{
    static const char *const names[] = {FOLDER "grey.jpg", FOLDER "progressive.jpg"};
    (void)state;
    for (int n = 0; n < 2; ++n) {
        gtx_raw_image raw = {0};
        gtx_image image = read_file(names[n]);
        for (int i = 0; i < SIDE * SIDE; ++i) {
            const int grey = i % SIDE * 31 + i / SIDE * 4;
            assert_near(image.pixels + 4 * i, grey, grey, grey, 255, 12);
        }
        assert_int_equal(gtx_image_read_raw(names[n], &raw, NULL), GTX_OK);
        assert_true(raw.channels == 1 && raw.depth == 1);
        for (int i = 0; i < SIDE * SIDE; ++i)
            assert_int_equal(((uint8_t *)raw.pixels)[i], image.pixels[4 * i]);
        free(raw.pixels);
        gtx_image_free(&image);
    }
}

/* Inks that leave 200, 100, 50 and of all 225 in 255. */
static void inks_become_colours(void **state)
{
    (void)state;
    gtx_image image = read_file(FOLDER "cmyk.jpg");
    gtx_raw_image raw = {0};
    assert_near(image.pixels, 176, 88, 44, 255, 0);
    gtx_image_free(&image);
    assert_int_equal(gtx_image_read_raw(FOLDER "cmyk.jpg", &raw, NULL), GTX_OK);
    assert_int_equal(raw.channels, 3);
    free(raw.pixels);
}

/* Rows that are missing in a JPEG are grey; without its header there is no image. */
static void what_is_cut_short(void **state)
{
    static const char *const names[] = {FOLDER "palette.png", FOLDER "grey.jpg",
                                        FOLDER "progressive.jpg", FOLDER "cmyk.jpg"};
    (void)state;
    for (size_t n = 0; n < sizeof names / sizeof *names; ++n) {
        uint8_t bytes[MAX_FILE];
        const size_t size = slurp(names[n], bytes);
        unsigned failed = 0;
        for (size_t cut = 4; cut < size; ++cut) {
            gtx_image image = {0};
            gtx_error error = {0};
            if (gtx_image_decode(bytes, cut, &image, &error)) {
                assert_int_equal(error.result, GTX_ERROR_READ);
                assert_true(error.message[0] && !strchr(error.message, '\n'));
                ++failed;
            }
            gtx_image_free(&image);
        }
        assert_in_range(failed, n ? size / 4 : size - 24, size);
    }
}

/* The last scan of a progressive file over and over, each of which takes a pass over the image. */
static void scans_have_an_end(void **state)
{
    enum { AT = 238, SCAN = 12, MANY = 120 };
    static uint8_t whole[MAX_FILE], bytes[MAX_FILE + MANY * SCAN];
    (void)state;
    const size_t size = slurp(FOLDER "progressive.jpg", whole);
    for (int times = 2; times <= MANY; times += MANY - 2) {
        gtx_image image = {0};
        gtx_error error = {0};
        memcpy(bytes, whole, AT);
        for (int i = 0; i < times; ++i)
            memcpy(bytes + AT + i * SCAN, whole + AT, SCAN);
        memcpy(bytes + AT + times * SCAN, whole + AT + SCAN, size - AT - SCAN);
        const gtx_result result =
            gtx_image_decode(bytes, size + (size_t)(times - 1) * SCAN, &image, &error);
        assert_int_equal(result, times == MANY ? GTX_ERROR_READ : GTX_OK);
        if (times == MANY)
            assert_non_null(strstr(error.message, "scans"));
        gtx_image_free(&image);
    }
}

/* The last: what was read and written until here did not load it. */
static void openimageio_was_not_loaded(void **state)
{
    static char maps[1 << 20];
    (void)state;
    FILE *file = fopen("/proc/self/maps", "r");
    if (!file)
        skip();
    maps[fread(maps, 1, sizeof maps - 1, file)] = 0;
    fclose(file);
    assert_non_null(strstr(maps, "geotex-png-jpeg.so"));
    assert_null(strstr(maps, "OpenImageIO"));
}

static int make_file(void **state)
{
    (void)state;
    const int file = mkstemp(written);
    return file < 0 ? -1 : close(file);
}

static int remove_file(void **state)
{
    (void)state;
    return remove(written);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_palette_becomes_colours), cmocka_unit_test(sixteen_bits_are_kept),
        cmocka_unit_test(grey_jpegs),                cmocka_unit_test(inks_become_colours),
        cmocka_unit_test(what_is_cut_short),         cmocka_unit_test(scans_have_an_end),
        cmocka_unit_test(openimageio_was_not_loaded),
    };
    return cmocka_run_group_tests(tests, make_file, remove_file);
}
