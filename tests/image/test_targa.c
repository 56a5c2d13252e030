/* TGA images of every kind, and what files that lie about themselves come to. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include <cmocka.h>

#include "image/image.h"

#include <string.h>

enum { HEADER = 18, WIDTH = 2, HEIGHT = 2 };

/* The lower left pixel is first; below is red and half transparent, above are blue and green. */
typedef struct kind {
    const char *name;
    uint8_t type, bits, attributes;
    uint8_t palette[6];   /* two colours of 24 bits, numbered from 1, or zeros */
    uint8_t size, bytes[16];
    uint8_t expected[4][4];   /* the image's rows from the top */
} kind;

static const kind kinds[] = {
    {"24 bits", 2, 24, 0, {0}, 12, {0, 0, 255, 0, 0, 255, 255, 0, 0, 0, 255, 0},
     {{0, 0, 255, 255}, {0, 255, 0, 255}, {255, 0, 0, 255}, {255, 0, 0, 255}}},
    {"24 bits, from the top right", 2, 24, 0x30, {0}, 12,
     {0, 0, 255, 0, 0, 255, 255, 0, 0, 0, 255, 0},
     {{255, 0, 0, 255}, {255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}}},
    {"32 bits", 2, 32, 8, {0}, 16, {0, 0, 255, 9, 0, 0, 255, 9, 255, 0, 0, 7, 0, 255, 0, 7},
     {{0, 0, 255, 7}, {0, 255, 0, 7}, {255, 0, 0, 9}, {255, 0, 0, 9}}},
    {"32 bits, opaque", 10, 32, 0, {0}, 5, {0x83, 1, 2, 3, 4},
     {{3, 2, 1, 255}, {3, 2, 1, 255}, {3, 2, 1, 255}, {3, 2, 1, 255}}},
    {"16 bits", 2, 16, 1, {0}, 8, {0x00, 0xfc, 0x00, 0x7c, 0x1f, 0x80, 0xe0, 0x83},
     {{0, 0, 255, 255}, {0, 255, 0, 255}, {255, 0, 0, 255}, {255, 0, 0, 0}}},
    {"grey", 3, 8, 0, {0}, 4, {1, 2, 3, 4},
     {{3, 3, 3, 255}, {4, 4, 4, 255}, {1, 1, 1, 255}, {2, 2, 2, 255}}},
    {"runs across rows", 11, 8, 0, {0}, 4, {0x82, 5, 0x00, 6},
     {{5, 5, 5, 255}, {6, 6, 6, 255}, {5, 5, 5, 255}, {5, 5, 5, 255}}},
    {"a run past the end", 11, 8, 0, {0}, 2, {0xff, 5},
     {{5, 5, 5, 255}, {5, 5, 5, 255}, {5, 5, 5, 255}, {5, 5, 5, 255}}},
    {"palette", 9, 8, 0, {3, 2, 1, 6, 5, 4}, 5, {0x80, 1, 0x82, 2, 0},
     {{4, 5, 6, 255}, {4, 5, 6, 255}, {1, 2, 3, 255}, {4, 5, 6, 255}}},
};

static size_t file_of(const kind *k, uint8_t file[64])
{
    const int colors = k->palette[0] ? 2 : 0;
    const uint8_t header[HEADER] = {1, colors > 0, k->type, 1, 0, (uint8_t)colors, 0, 24, 0, 0, 0,
                                    0, WIDTH, 0, HEIGHT, 0, k->bits, k->attributes};
    memcpy(file, header, HEADER);
    file[HEADER] = 'i'; /* the file's own name for itself, a byte long */
    memcpy(file + HEADER + 1, k->palette, (size_t)(3 * colors));
    memcpy(file + HEADER + 1 + 3 * colors, k->bytes, k->size);
    return (size_t)(HEADER + 1 + 3 * colors) + k->size;
}

static void every_kind(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; ++i) {
        uint8_t file[64];
        const size_t size = file_of(&kinds[i], file);
        gtx_image image = {0};
        gtx_error error = {0};
        uint32_t width, height;
        assert_int_equal(gtx_image_measure(file, size, &width, &height, &error), GTX_OK);
        assert_true(width == WIDTH && height == HEIGHT);
        if (gtx_image_decode(file, size, &image, &error))
            fail_msg("%s: %s", kinds[i].name, error.message);
        if (memcmp(image.pixels, kinds[i].expected, sizeof kinds[i].expected))
            fail_msg("%s", kinds[i].name);
        gtx_image_free(&image);
    }
}

static void what_is_not_there(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; ++i) {
        uint8_t file[64];
        const size_t size = file_of(&kinds[i], file);
        const size_t needed = size - !strcmp(kinds[i].name, "palette"); /* a byte follows it */
        for (size_t cut = HEADER; cut < needed; ++cut) {
            gtx_image image = {0};
            gtx_error error = {0};
            assert_int_equal(gtx_image_decode(file, cut, &image, &error), GTX_ERROR_READ);
            assert_non_null(strstr(error.message, "too early"));
            assert_null(image.pixels);
        }
    }
}

static void colours_that_a_palette_lacks(void **state)
{
    (void)state;
    for (uint8_t number = 0; number < 5; ++number) {
        kind k = kinds[sizeof kinds / sizeof *kinds - 1];
        uint8_t file[64];
        gtx_image image = {0};
        gtx_error error = {0};
        k.bytes[1] = number;
        const size_t size = file_of(&k, file);
        const int there = number == 1 || number == 2;
        assert_int_equal(gtx_image_decode(file, size, &image, &error),
                         there ? GTX_OK : GTX_ERROR_READ);
        if (!there)
            assert_non_null(strstr(error.message, "palette lacks"));
        gtx_image_free(&image);
    }
}

/* 65535 x 65535 pixels in a few bytes: nothing of that size is taken. */
static void claims_are_not_believed(void **state)
{
    (void)state;
    uint8_t file[64];
    const size_t size = file_of(&kinds[6], file);
    for (int large = 0; large < 2; ++large) {
        memset(file + 12, 0xff, large ? 4 : 2);
        file[15] = large ? 0xff : 0x0f;
        gtx_image image = {0};
        gtx_error error = {0};
        assert_int_equal(gtx_image_decode(file, size, &image, &error), GTX_ERROR_READ);
        assert_non_null(strstr(error.message, large ? "size" : "too early"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind),
        cmocka_unit_test(what_is_not_there),
        cmocka_unit_test(colours_that_a_palette_lacks),
        cmocka_unit_test(claims_are_not_believed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
