/* gtx view, driven by its script options on a display of the test's own. */
#include "cli/window.h"

static void no_display_is_one_line_and_exit_5(void **state)
{
    (void)state;
    char *display = getenv("DISPLAY");
    char kept[32];
    snprintf(kept, sizeof kept, "%s", display ? display : "");
    unsetenv("DISPLAY");
    expect(gtx("view sphere.gtx"), 5);
    expect_text("gtx view: error[gl]: no display");
    assert_int_equal(strchr(output, '\n') - output + 1, (long)strlen(output));
    expect(gtx("view none.gtx"), 2); /* files are looked at first */
    expect_text("none.gtx: error[read]");
    if (kept[0])
        setenv("DISPLAY", kept, 1);
}

static void every_mode_shows_something_else(void **state)
{
    static const struct {
        const char *keys;
        unsigned least; /* pixels of the model that change */
    } modes[] = {{"p", 3000}, {"n", 3000}, {"b", 300}, {"c", 300}, {"h", 3000}};
    (void)state;
    if (!server)
        skip();
    gtx_image plain = view("sphere.gtx", "t"), text = view("sphere.gtx", ".");
    assert_true(difference(&plain, &text, true) > 300); /* the text is there, */
    assert_int_equal(difference(&plain, &text, false), 0); /* and nowhere else */
    assert_true(pixel(&plain, 160, 120)[0] > 60); /* a lit model in the middle, */
    assert_int_equal(pixel(&plain, 2, 2)[2], 242); /* the background around it */
    for (size_t i = 0; i < sizeof modes / sizeof *modes; ++i) {
        gtx_image other = view("sphere.gtx", modes[i].keys);
        if (difference(&plain, &other, false) < modes[i].least)
            fail_msg("'%s' changes %u pixels", modes[i].keys, difference(&plain, &other, false));
        gtx_image_free(&other);
    }
    gtx_image twice = view("sphere.gtx", "tppnnbbcchhmmmmm");
    assert_int_equal(difference(&plain, &twice, false), 0);
    gtx_image_free(&twice);
    twice = view("sphere.gtx", "tmm"); /* the LOD mesh */
    expect(gtx("render sphere.gtx --camera 30,20,5 --size 320x240 --method lod -o lod.png"), 0);
    gtx_image lod = picture("lod.png");
    assert_int_equal(difference(&lod, &twice, false), 0);
    gtx_image_free(&lod);
    gtx_image_free(&twice);
    gtx_image_free(&plain);
    gtx_image_free(&text);
}

static void levels_take_turns(void **state)
{
    (void)state;
    if (!server)
        skip();
    const char *keys[] = {".", "l", "ll", "lll", "llll", "lllll"};
    gtx_image shown[6];
    for (int i = 0; i < 6; ++i)
        shown[i] = view("sphere.gtx", keys[i]);
    for (int i = 1; i < 4; ++i) { /* coarser and coarser, and the text tells */
        assert_true(difference(&shown[i], &shown[i + 1], false) > 50);
        assert_true(difference(&shown[i], &shown[i + 1], true) > 2);
    }
    assert_int_equal(difference(&shown[0], &shown[5], false), 0);
    for (int i = 1; i < 5; ++i) {
        char command[128];
        snprintf(command, sizeof command, "render sphere.gtx --camera 30,20,5 --size 320x240 "
                 "--level %d -o drawn.png", i - 1);
        expect(gtx("%s", command), 0);
        gtx_image drawn = picture("drawn.png");
        assert_int_equal(difference(&shown[i], &drawn, false), 0);
        gtx_image_free(&drawn);
    }
    expect(gtx("render sphere.gtx --camera 30,20,5 --size 320x240 --method cast "
               "--max-error 1000 -o drawn.png"),
           0); /* the coarsest */
    gtx_image drawn = picture("drawn.png");
    assert_int_equal(difference(&shown[4], &drawn, false), 0);
    gtx_image_free(&drawn);
    for (int i = 0; i < 6; ++i)
        gtx_image_free(&shown[i]);
}

/* Seen from the front: the nearest normal is +Z, blue; the right one +X, the upper one +Y. */
static void normals_have_the_colours_of_their_directions(void **state)
{
    (void)state;
    if (!server)
        skip();
    gtx_image normals = view("sphere.gtx --camera 0,0,5", "nt");
    assert_true(pixel(&normals, 160, 120)[2] > 230);
    assert_true(abs(pixel(&normals, 160, 120)[0] - 128) < 40);
    assert_true(pixel(&normals, 190, 120)[0] > pixel(&normals, 130, 120)[0] + 60);
    assert_true(pixel(&normals, 160, 90)[1] > pixel(&normals, 160, 150)[1] + 60);
    gtx_image mesh = view("sphere.obj --camera 0,0,5", "nt");
    for (int k = 0; k < 3; ++k)
        assert_true(abs(pixel(&normals, 170, 110)[k] - pixel(&mesh, 170, 110)[k]) < 12);
    gtx_image_free(&normals);
    gtx_image_free(&mesh);
}

static void the_window_shows_what_render_draws(void **state)
{
    (void)state;
    if (!server)
        skip();
    gtx_image shown = view("sphere.gtx sphere.obj --method paper", "t");
    expect(gtx("render sphere.gtx sphere.obj --method paper --camera 30,20,5 --size 320x240 "
               "-o drawn.png"), 0);
    gtx_image drawn = picture("drawn.png");
    unsigned all = difference(&shown, &drawn, false) + difference(&shown, &drawn, true);
    assert_true(all < 320 * 240 / 1000);
    gtx_image_free(&shown);
    gtx_image_free(&drawn);
}

static void resized_and_minimised_it_goes_on(void **state)
{
    (void)state;
    if (!server)
        skip();
    expect(gtx("view sphere.gtx --size 320x240 --keys '>...' --frames 5 --screenshot big.png"), 0);
    gtx_image big = picture("big.png");
    assert_int_equal(big.width, 640);
    assert_int_equal(big.height, 480);
    assert_true(pixel(&big, 320, 240)[0] > 60);
    expect(gtx("view sphere.gtx --size 320x240 --keys '<<<<<<<...' --frames 11"), 0);
    expect(gtx("view sphere.gtx --size 320x240 --keys '_..p..._..' --frames 4 "
               "--screenshot back.png"), 0);
    gtx_image back = picture("back.png");
    assert_int_equal(back.width, 320);
    gtx_image_free(&big);
    gtx_image_free(&back);
}

static void screenshots_get_free_names(void **state)
{
    (void)state;
    if (!server)
        skip();
    gtx_image note = view("sphere.gtx", "ss."), plain = view("sphere.gtx", "t");
    gtx_image first = picture("gtx-view-1.png"), second = picture("gtx-view-2.png");
    assert_false(exists("gtx-view-3.png"));
    assert_int_equal(difference(&first, &plain, true), 0); /* no text in them */
    assert_int_equal(difference(&first, &second, false), 0);
    assert_true(difference(&note, &plain, true) > 300);
    gtx_image_free(&note);
    gtx_image_free(&plain);
    gtx_image_free(&first);
    gtx_image_free(&second);
}

/* On the sphere: the ground is below, the sky above; each step shows something else, and F takes
 * all of it back. */
static void it_walks_on_the_asset(void **state)
{
    (void)state;
    if (!server)
        skip();
    gtx_image shown[5];
    const char *keys[] = {"t", "gt", "gwwwwt", "ggwwwwt", "gwwsaegsft"};
    for (int i = 0; i < 5; ++i)
        shown[i] = view("sphere.gtx --camera 30,80,5", keys[i]);
    const uint8_t *sky = pixel(&shown[0], 10, 10);
    for (int i = 1; i < 4; ++i) {
        assert_memory_equal(pixel(&shown[i], 160, 10), sky, 3);
        assert_true(abs(pixel(&shown[i], 160, 230)[0] - sky[0]) > 10);
    }
    assert_true(difference(&shown[1], &shown[2], false) > 300);
    assert_true(difference(&shown[2], &shown[3], false) > 300); /* flying leaves the ground */
    assert_int_equal(difference(&shown[0], &shown[4], false), 0);
    for (int i = 0; i < 5; ++i)
        gtx_image_free(&shown[i]);
}

/* Tiles come while frames are drawn; the last one is what render draws. One walks on them. */
static void a_world_is_shown_and_walked_on(void **state)
{
    (void)state;
    if (!server)
        skip();
    write_sphere("big.obj", 40);
    expect(gtx("world plan big.obj -o world --triangles 2k --engine shell -q"), 0);
    char command[256];
    snprintf(command, sizeof command, "sh %s >/dev/null 2>&1", in_folder("world/build.sh"));
    expect(system(command), 0);
    gtx_image shown = view("world", "t"), text = view("world", ".");
    gtx_image walked = view("world --camera 30,80,5", "gwwt"); /* from above it */
    expect(gtx("render world --camera 30,20,5 --size 320x240 -o drawn.png"), 0);
    gtx_image drawn = picture("drawn.png");
    assert_true(difference(&shown, &drawn, false) < 320 * 240 / 1000);
    assert_true(difference(&shown, &text, true) > 1000);
    assert_true(difference(&shown, &walked, false) > 3000);
    assert_true(abs(pixel(&walked, 160, 230)[0] - pixel(&walked, 160, 10)[0]) > 10);
    const char *const drops[] = {"--drop world", "--drop world/", "--drop world/tileset.json",
                                 "sphere.gtx --drop world/tiles.gtw"};
    for (int i = 0; i < 4; ++i) {
        gtx_image dropped = view(drops[i], "t");
        assert_true(difference(&shown, &dropped, false) < 320 * 240 / 1000);
        gtx_image_free(&dropped);
    }
    write_file("world/tiles.gtw", "no index", 8);
    expect(gtx("view sphere.gtx --size 320x240 --frames 2 --drop world"), 3);
    expect_text("world: error[");
    gtx_image_free(&shown);
    gtx_image_free(&text);
    gtx_image_free(&walked);
    gtx_image_free(&drawn);
}

static void grids_are_opened_with_their_legend(void **state)
{
    static const char grid[] = "-996 2 1 1\n0 1 0 1\n2 0 0 0\n0 0 0 0 0 0 0\n5 7\n6 8\n";
    (void)state;
    if (!server)
        skip();
    write_file("a.irap", grid, sizeof grid - 1);
    write_file("short.irap", grid, 40);
    gtx_image bare = view("a.irap", "t"), told = view("a.irap", ".");
    gtx_image dropped = view("--drop a.irap", "t");
    assert_true(pixel(&bare, 160, 120)[2] < 200); /* a surface in the middle */
    assert_int_equal(difference(&bare, &dropped, false), 0);
    const uint8_t *low = pixel(&told, 6, 232), *high = pixel(&told, 160, 232);
    assert_true(low[0] < 80 && low[1] < 20);       /* viridis: violet, */
    assert_true(high[0] > 220 && high[1] > 200);   /* yellow */
    expect(gtx("view short.irap --frames 1"), 3);
    expect_text("short.irap: error[input]");
    expect(gtx("view a.irap --size 320x240 --frames 2 --drop short.irap"), 3);
    gtx_image_free(&bare);
    gtx_image_free(&told);
    gtx_image_free(&dropped);
}

static void drops_are_opened_cooked_cancelled(void **state)
{
    (void)state;
    if (!server)
        skip();
    gtx_image nothing = view("", "t"), opened = view("--drop sphere.gtx", "t");
    assert_true(difference(&nothing, &opened, false) > 3000);
    gtx_image cooked = view("--drop sphere.obj", "t");
    assert_true(difference(&cooked, &opened, false) < 100); /* the default options of cook */
    write_file("broken.obj", "v 0 0 0\nf 1 2 3\n", 16);
    expect(gtx("view sphere.gtx --size 320x240 --frames 2 --drop broken.obj"), 3);
    expect_text("broken.obj: error[");
    expect(gtx("view sphere.gtx --size 320x240 --frames 2 --drop none.obj"), 2);
    write_sphere("large.obj", 250);
    expect(gtx("view sphere.gtx --size 320x240 --frames 3 --drop large.obj --keys '.!'"), 130);
    expect(gtx("view sphere.gtx --size 320x240 --frames 999 --drop large.obj --keys '.!!'"), 130);
    gtx_image_free(&nothing);
    gtx_image_free(&opened);
    gtx_image_free(&cooked);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_display_is_one_line_and_exit_5),
        cmocka_unit_test(every_mode_shows_something_else),
        cmocka_unit_test(levels_take_turns),
        cmocka_unit_test(normals_have_the_colours_of_their_directions),
        cmocka_unit_test(the_window_shows_what_render_draws),
        cmocka_unit_test(resized_and_minimised_it_goes_on),
        cmocka_unit_test(it_walks_on_the_asset),
        cmocka_unit_test(screenshots_get_free_names),
        cmocka_unit_test(a_world_is_shown_and_walked_on),
        cmocka_unit_test(grids_are_opened_with_their_legend),
        cmocka_unit_test(drops_are_opened_cooked_cancelled),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
