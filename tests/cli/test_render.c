/* What gtx render makes of options: sheets, turns, light, legends, sources beside assets. */
#include "cli/command.h"

#include "image/image.h"

static gtx_image picture(const char *name)
{
    gtx_image image;
    gtx_error error;
    if (gtx_image_read(in_folder(name), &image, &error))
        fail_msg("%s: %s", name, error.message);
    return image;
}

/* Of a command that ends with "-o out.png". */
static gtx_image drawn(const char *arguments)
{
    expect(gtx("render %s -q -o out.png", arguments), 0);
    return picture("out.png");
}

static const uint8_t *pixel(const gtx_image *image, uint32_t x, uint32_t y)
{
    return image->pixels + 4 * ((size_t)y * image->width + x);
}

/* Pixels of two w x h parts, with their corners at (ax, ay) and (bx, by), that are not alike; their
 * labels are left out. */
static unsigned differ(const gtx_image *a, uint32_t ax, uint32_t ay, const gtx_image *b,
                       uint32_t bx, uint32_t by, uint32_t w, uint32_t h)
{
    unsigned count = 0;
    for (uint32_t y = 24; y < h; ++y)
        for (uint32_t x = 0; x < w; ++x) {
            const uint8_t *p = pixel(a, ax + x, ay + y), *q = pixel(b, bx + x, by + y);
            count += abs(p[0] - q[0]) + abs(p[1] - q[1]) + abs(p[2] - q[2]) > 24;
        }
    return count;
}

static void a_sheet_has_the_views_of_single_pictures(void **state)
{
    (void)state;
    gtx_image sheet = drawn("sphere.gtx --sheet 6 --size 240x160 --camera 10,20,3");
    assert_int_equal(sheet.width, 240);
    static const char *const cameras[] = {"10,20,3",  "100,20,3", "190,20,3",
                                          "280,20,3", "10,80,3",  "10,-60,3"};
    for (uint32_t i = 0; i < 6; ++i) {
        char command[128];
        snprintf(command, sizeof command, "sphere.gtx --size 80x80 --camera %s", cameras[i]);
        gtx_image one = drawn(command);
        assert_int_equal(
            differ(&sheet, i % 3 * 80, i / 3 * 80, &one, 0, 0, 80, 80), 0);
        gtx_image_free(&one);
    }
    gtx_image_free(&sheet);
    /* A row for each of several files. */
    sheet = drawn("sphere.gtx flat.obj --sheet 2 --size 160x160");
    gtx_image flat = drawn("flat.obj --size 80x80");
    assert_int_equal(differ(&sheet, 0, 80, &flat, 0, 0, 80, 80), 0);
    assert_true(differ(&sheet, 0, 0, &flat, 0, 0, 80, 80) > 500);
    gtx_image_free(&flat);
    gtx_image_free(&sheet);
    expect(gtx("render sphere.gtx --sheet 64 --size 100x100 -o x.png"), 1);
    expect_text("8 x 8 pictures need a larger --size");
    expect(gtx("render sphere.gtx --sheet 2 --depth x.exr -o x.png"), 1);
    assert_false(exists("x.png"));
}

/* From the same side, and lit alike by the same materials. */
static void the_source_lies_beside(void **state)
{
    (void)state;
    const char *const models[] = {"sphere", "glows"};
    expect(gtx("cook glows.obj -o glows.gtx -q"), 0);
    for (int i = 0; i < 2; ++i) {
        char command[128];
        snprintf(command, sizeof command, "%s.gtx --beside %s.obj --size 200x100", models[i],
                 models[i]);
        gtx_image both = drawn(command);
        assert_true(differ(&both, 0, 0, &both, 100, 0, 100, 100) < 100);
        if (i == 1) { /* what is black but for its own light */
            assert_true(pixel(&both, 150, 50)[1] > 200);
            assert_true(pixel(&both, 150, 50)[0] < 90);
        }
        gtx_image_free(&both);
    }
    expect(gtx("render sphere.gtx --beside sphere.obj -o sphere.obj"), 1);
    expect_text("-o would write over a file that is read");
}

static void a_turn_goes_into_a_gif_or_a_folder(void **state)
{
    (void)state;
    size_t size, frames = 0;
    expect(gtx("render sphere.gtx --turntable turn.gif --frames 5 --rate 5 --size 64x64 "
               "-o first.png"), 0);
    char *gif = slurp("turn.gif", &size);
    assert_memory_equal(gif, "GIF89a", 6);
    for (size_t i = 0; i + 3 < size; ++i)
        frames += !memcmp(gif + i, "\x21\xf9\x04", 3); /* one before each picture */
    assert_int_equal(frames, 5);
    free(gif);
    gtx_image first = picture("first.png"), in_gif = picture("turn.gif");
    assert_true(differ(&first, 0, 0, &in_gif, 0, 0, 64, 64) < 200); /* 256 colours */
    gtx_image_free(&in_gif);

    expect(gtx("render sphere.gtx --turntable turn --frames 4 --size 64x64"), 0);
    gtx_image frame = picture("turn/frame-000.png"), last = picture("turn/frame-003.png");
    assert_int_equal(differ(&first, 0, 0, &frame, 0, 0, 64, 64), 0);
    gtx_image side = drawn("sphere.gtx --camera 300,20,2.8 --size 64x64");
    assert_int_equal(differ(&side, 0, 0, &last, 0, 0, 64, 64), 0);
    assert_true(differ(&first, 0, 0, &last, 0, 0, 64, 64) > 20);
    assert_false(exists("turn/frame-004.png"));
    gtx_image_free(&first);
    gtx_image_free(&frame);
    gtx_image_free(&last);
    gtx_image_free(&side);
    expect(gtx("render sphere.gtx --turntable clear.gif --background none"), 1);
    expect(gtx("render sphere.gtx --turntable clear.gif --frames 720 --size 8192x8192"), 6);
    expect(gtx("render sphere.gtx --turntable sphere.obj -q --frames 2 --size 64x64"), 2);
}

static void light_and_background_are_as_asked(void **state)
{
    (void)state;
    gtx_image plain = drawn("sphere.gtx --camera 0,0,3 --size 80x80 --light 0,0,0");
    gtx_image behind = drawn("sphere.gtx --camera 0,0,3 --size 80x80 --light 180,0,0");
    gtx_image around = drawn("sphere.gtx --camera 0,0,3 --size 80x80 --light 180,0,1");
    gtx_image right = drawn("sphere.gtx --camera 0,0,3 --size 80x80 --light 90,0,0");
    assert_true(pixel(&plain, 40, 40)[0] > 200);
    assert_true(pixel(&behind, 40, 40)[0] < 20);
    assert_true(pixel(&around, 40, 40)[0] > 200);
    assert_true(pixel(&right, 58, 40)[0] > pixel(&right, 22, 40)[0] + 100);
    assert_int_equal(pixel(&plain, 2, 2)[3], 255);
    gtx_image red = drawn("sphere.gtx --camera 0,0,3 --size 80x80 --light 0,0,0 "
                          "--light-color ff0000 --background none");
    assert_int_equal(pixel(&red, 40, 40)[0], pixel(&plain, 40, 40)[0]);
    assert_int_equal(pixel(&red, 40, 40)[1], 0);
    assert_int_equal(pixel(&red, 40, 40)[3], 255);
    assert_int_equal(pixel(&red, 2, 2)[3], 0);
    gtx_image green = drawn("sphere.obj --size 80x80 --background 00ff10");
    assert_memory_equal(pixel(&green, 2, 2), "\0\xff\x10\xff", 4);
    static const char *const bad[] = {"--background red", "--light-color 12345",
                                      "--light-color none", "--light 0,0,2"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        expect(gtx("render sphere.gtx %s -o x.png", bad[i]), 1);
    gtx_image_free(&plain);
    gtx_image_free(&behind);
    gtx_image_free(&around);
    gtx_image_free(&right);
    gtx_image_free(&red);
    gtx_image_free(&green);
}

static void legends_tell_what_colours_mean(void **state)
{
    (void)state;
    /* Normals: a square for each of six, the last one in the last line. */
    gtx_image normals = drawn("sphere.gtx --camera 0,0,3 --size 120x120 --show normals --legend");
    static const uint8_t squares[6][3] = {{255, 128, 128}, {0, 128, 128}, {128, 255, 128},
                                          {128, 0, 128},   {128, 128, 255}, {128, 128, 0}};
    for (uint32_t i = 0; i < 6; ++i)
        assert_memory_equal(pixel(&normals, 8, 120 - 4 - 10 * (6 - i) + 4), squares[i], 3);
    assert_true(pixel(&normals, 60, 60)[2] > 230); /* and so is the sphere */
    gtx_image patches = drawn("sphere.gtx --size 120x120 --show patches");
    gtx_image plain = drawn("sphere.gtx --size 120x120 --legend"); /* nothing to tell */
    gtx_image bare = drawn("sphere.gtx --size 120x120");
    assert_true(differ(&patches, 0, 0, &bare, 0, 0, 120, 120) > 1000);
    assert_int_equal(differ(&plain, 0, 0, &bare, 0, 0, 120, 120), 0);
    gtx_image_free(&normals);
    gtx_image_free(&patches);
    gtx_image_free(&plain);
    gtx_image_free(&bare);

    /* Colours of height grids: from what the asset says of itself. */
    static const char grid[] = "-996 2 1 1\n0 1 0 1\n2 0 0 0\n0 0 0 0 0 0 0\n5 7\n6 8\n";
    write_file("a.irap", grid, sizeof grid - 1);
    expect(gtx("horizons a.irap -o grid.gtx -q"), 0);
    gtx_image map = drawn("grid.gtx --size 120x120 --legend");
    const uint8_t *low = pixel(&map, 5, 112), *high = pixel(&map, 62, 112);
    assert_true(low[0] < 80 && low[1] < 20);    /* viridis: violet, */
    assert_true(high[0] > 230 && high[1] > 210);     /* yellow */
    gtx_image_free(&map);
}

static int set_stage(void **state)
{
    if (set_up(state))
        return 1;
    static const char flat[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    static const char glow[] = "newmtl m\nKd 0 0 0\nKe 0 1 0\n";
    char command[256];
    write_file("flat.obj", flat, sizeof flat - 1);
    write_file("glow.mtl", glow, sizeof glow - 1);
    snprintf(command, sizeof command,
             "cd %s && { echo 'mtllib glow.mtl'; sed '0,/^f/s/^f/usemtl m\\nf/' sphere.obj; } "
             ">glows.obj", folder);
    return system(command) != 0;
}

static void drawing_is_possible(void **state)
{
    (void)state;
    if (gtx("render sphere.gtx --size 64x64 -o x.png") == 5) {
        print_message("no OpenGL here\n");
        exit(0);
    }
    assert_int_equal(remove(in_folder("x.png")), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(drawing_is_possible),
        cmocka_unit_test(a_sheet_has_the_views_of_single_pictures),
        cmocka_unit_test(the_source_lies_beside),
        cmocka_unit_test(a_turn_goes_into_a_gif_or_a_folder),
        cmocka_unit_test(light_and_background_are_as_asked),
        cmocka_unit_test(legends_tell_what_colours_mean),
    };
    return cmocka_run_group_tests(tests, set_stage, tear_down);
}
