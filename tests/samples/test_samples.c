/* Every sample runs without a window, and its picture is the one that was looked at.
 *
 * GTX_UPDATE_GOLDEN=1 writes tests/golden/samples anew: look at each before keeping it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "image/image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static char folder[] = "/tmp/gtx-samples-XXXXXX";

/* Runs a shell command with $S the samples' folder and $T a temporary one; returns its exit
 * code. */
static int run(const char *format, ...)
{
    char command[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static int set_up(void **state)
{
    (void)state;
    char samples[4096];
    if (!getenv("GTX_OUT") || !mkdtemp(folder))
        return -1;
    snprintf(samples, sizeof samples, "%s/samples", getenv("GTX_OUT"));
    setenv("S", samples, 1);
    setenv("T", folder, 1);
    return run("$S/sculpt --triangles 20000 $T/lod.glb >/dev/null && "
               "$S/cook_from_c $T/lod.glb $T/lod.gtx >$T/cook.log");
}

static int tear_down(void **state)
{
    (void)state;
    return run("rm -r $T");
}

static void cooking_says_how_far_it_is(void **state)
{
    (void)state;
    assert_int_equal(run("grep -q ' 50 %%' $T/cook.log && grep -q 'patches' $T/cook.log"), 0);
    assert_int_equal(run("$S/cook_from_c $T/nothing.glb $T/no.gtx 2>/dev/null"), 1);
}

/* All that an eye in the middle sees is wall: neither is it culled, nor is there a gap. */
static void halls_and_caves_are_around_the_eye(void **state)
{
    (void)state;
    assert_int_equal(run("echo '0 0 0  1 0 0' >$T/hall.path; "
                         "echo '13.4 1.1 4.1  7 0.5 10' >$T/cave.path"), 0);
    for (int i = 0; i < 2; ++i) {
        setenv("SHAPE", i ? "cave" : "hall", 1);
        assert_int_equal(run("$S/sculpt --shape $SHAPE --triangles 20000 $T/hall.glb >/dev/null && "
                             "$GTX cook $T/hall.glb -q -o $T/hall.gtx && "
                             "$GTX bench $T/hall.gtx $T/hall.glb --path $T/$SHAPE.path -q --json "
                             "--sizes 32x32 --methods mesh,cast >$T/hall.json"), 0);
        assert_int_equal(run("test $(grep -c '\"pixels\": 1024' $T/hall.json) = 2"), 0);
    }
    assert_int_equal(run("$S/sculpt --shape none $T/no.glb 2>/dev/null"), 1);
    assert_int_equal(run("$S/sculpt --shape hall 2>/dev/null"), 1);
    assert_int_equal(run("$S/sculpt --shape cave --triangles 20000 - >$T/cave.raw && "
                         "$GTX world plan - -o $T/cave -q <$T/cave.raw && "
                         "grep -q '\"triangles\": 22' $T/cave/plan.json"), 0);
}

/* 3 x 3 nodes, the middle one without data: a square of 100 x 100 cells, as low there as the lowest
 * node. */
static void a_terrain_goes_through_the_nodes_of_its_grid(void **state)
{
    (void)state;
    assert_int_equal(run("printf -- '-996 3 10 10\\n0 20 0 20\\n3 0 0 0\\n0 0 0 0 0 0 0\\n"
                         "5 5 5 5 9999900 5 5 5 5\\n' >$T/flat.irap && "
                         "$S/sculpt --terrain $T/flat.irap --triangles 20000 - >$T/flat.raw && "
                         "test $(wc -c <$T/flat.raw) = 720000 && "
                         "$GTX world plan - -o $T/flat -q <$T/flat.raw && "
                         "grep -q '\"triangles\": 20000' $T/flat/plan.json"), 0);
    assert_int_equal(run("test \"$(od -A n -t f4 -v -w36 $T/flat.raw | awk '{"
                         "for (i = 1; i < 9; i += 3) {"
                         " if ($i > east) east = $i; if (-$(i + 2) > north) north = -$(i + 2);"
                         " if ($(i + 1) != 5) other = 1 }}"
                         "END { print east, north, other + 0 }')\" = '20 20 0'"), 0);
    assert_int_equal(run("$S/sculpt --terrain $T/flat.irap $T/no.glb 2>/dev/null"), 1);
    assert_int_equal(run("$S/sculpt --terrain $T/no.irap - 2>/dev/null"), 2);
}

static void an_interrupt_leaves_nothing_behind(void **state)
{
    (void)state;
    assert_int_equal(run("$S/sculpt --triangles 400000 $T/large.glb >/dev/null"), 0);
    assert_int_equal(run("timeout --preserve-status -s INT 0.3 $S/cook_from_c $T/large.glb "
                         "$T/large.gtx >/dev/null 2>&1"), 130);
    assert_int_equal(run("ls $T/large.gtx* 2>/dev/null"), 2);
}

static void an_asset_is_printed(void **state)
{
    (void)state;
    assert_int_equal(run("$S/open_asset $T/lod.gtx | grep -q 'patches on 1 pages'"), 0);
    assert_int_equal(run("$S/open_asset $T/lod.glb 2>/dev/null"), 1);
}

/* Drivers round differently: a picture may differ a little everywhere and much in few places. */
static void assert_alike(const gtx_image *a, const gtx_image *b)
{
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    const size_t count = (size_t)a->width * a->height;
    size_t sum = 0, far = 0;
    for (size_t i = 0; i < count; ++i) {
        int most = 0;
        for (int c = 0; c < 3; ++c) {
            const int d = abs(a->pixels[4 * i + (size_t)c] - b->pixels[4 * i + (size_t)c]);
            sum += (size_t)d;
            most = d > most ? d : most;
        }
        far += most > 40;
    }
    if (far * 100 > count || sum > 6 * count)
        fail_msg("%zu of %zu pixels are far off, mean difference %.2f", far, count,
                 (double)sum / (3.0 * (double)count));
}

static void draws_picture_of(const char *name, const char *what)
{
    char golden[256], picture[256];
    gtx_image expected, found;
    snprintf(golden, sizeof golden, "tests/golden/samples/%s.png", name);
    snprintf(picture, sizeof picture, "%s/%s.png", folder, name);
    assert_int_equal(run("$S/%s %s --headless %s --size 240x160", name, what, picture), 0);
    if (getenv("GTX_UPDATE_GOLDEN"))
        assert_int_equal(run("cp %s %s", picture, golden), 0);
    assert_int_equal(gtx_image_read(golden, &expected, NULL), GTX_OK);
    assert_int_equal(gtx_image_read(picture, &found, NULL), GTX_OK);
    assert_alike(&expected, &found);
    gtx_image_free(&expected);
    gtx_image_free(&found);
}

static void draws_its_picture(void **state)
{
    draws_picture_of(*state, "$T/lod.gtx");
}

/* By draws that an engine submits itself, as by render.h. */
static void an_engine_submits_the_same_picture(void **state)
{
    (void)state;
    assert_int_equal(run("for s in rhi smallest_engine; do "
                         "$S/$s $T/lod.gtx --headless $T/$s.png --size 240x160 || exit 1; done; "
                         "cmp $T/rhi.png $T/smallest_engine.png"), 0);
}

static void horizons_are_made_and_drawn(void **state)
{
    (void)state;
    draws_picture_of("horizons", "own");
    assert_int_equal(run("$S/horizons $T/nowhere --headless $T/x.png 2>/dev/null"), 1);
}

/* Pixels of sky below those of the ground. */
static void assert_no_hole(const char *name)
{
    char path[256];
    gtx_image image;
    snprintf(path, sizeof path, "%s/%s.png", folder, name);
    assert_int_equal(gtx_image_read(path, &image, NULL), GTX_OK);
    for (uint32_t x = 0; x < image.width; ++x) {
        uint32_t y = image.height;
        while (y > 0 && memcmp(image.pixels + 4 * ((y - 1) * image.width + x), image.pixels, 3))
            --y;
        assert_in_range(y, 1, image.height / 2); /* the skyline */
        while (y > 0 && !memcmp(image.pixels + 4 * ((y - 1) * image.width + x), image.pixels, 3))
            --y;
        assert_int_equal(y, 0);
    }
    gtx_image_free(&image);
}

/* Hills in tiles, which are read on a walk over them. */
static void a_world_is_walked_through(void **state)
{
    (void)state;
    assert_int_equal(
        run("awk 'BEGIN { n = 121; print -996, n, 1, 1; print 0, n - 1, 0, n - 1; print n, 0, 0, 0;"
            " print 0, 0, 0, 0, 0, 0, 0; for (j = 0; j < n; j++) for (i = 0; i < n; i++)"
            " print 3 * sin(i / 9 + 1.3 * sin(j / 11)) * cos(j / 8) +"
            " sin(i / 2.3) * cos(j / 2.9) * (1 + sin(i / 17)) / 1.6 }' >$T/hills.irap && "
            "$GTX world plan $T/hills.irap -o $T/hills -q --triangles 4k --engine shell && "
            "sh $T/hills/build.sh 2>$T/hills.log"), 0);
    draws_picture_of("world", "$T/hills >$T/walk.log");
    assert_no_hole("world");
    assert_int_equal(run("grep -q '^600 frames' $T/walk.log && "
                         "grep -q '27 beginnings' $T/walk.log"), 0);
    assert_int_equal(run("$S/world $T/nowhere --headless $T/x.png 2>/dev/null"), 1);
}

static void misuse_is_one_line(void **state)
{
    const char *name = *state;
    assert_int_equal(run("$S/%s 2>$T/err; test $? = 1 && grep -q ^usage $T/err", name), 0);
    assert_int_equal(run("$S/%s $T/lod.glb --headless $T/x.png 2>$T/err; test $? = 1 && "
                         "test $(wc -l <$T/err) = 1 && ! test -e $T/x.png", name), 0);
    assert_int_equal(run("$S/%s $T/lod.gtx --headless $T/x.png --size 0x9 2>/dev/null", name), 1);
}

/* Without a window and, where Xvfb is, in one: there the validation layer has nothing to say. */
static void vulkan_draws_into_windows(void **state)
{
    (void)state;
    if (run("test -x $S/vulkan_window") ||
        !run("$S/vulkan_window $T/lod.gtx --headless $T/no-window.png 2>&1 | "
             "grep -q 'is no Vulkan'"))
        skip();
    draws_picture_of("vulkan_window", "$T/lod.gtx");
    assert_int_equal(run("$S/vulkan_window $T/nothing.gtx --headless $T/none.png 2>/dev/null"), 1);
    assert_int_equal(run("DISPLAY= WAYLAND_DISPLAY= $S/vulkan_window $T/lod.gtx --frames 1 "
                         "2>/dev/null"), 1);
    if (run("command -v Xvfb >/dev/null"))
        skip();
    assert_int_equal(
        run("Xvfb -displayfd 1 -screen 0 640x480x24 >$T/display 2>/dev/null & server=$!; "
            "for i in $(seq 100); do test -s $T/display && break; sleep 0.1; done; "
            "DISPLAY=:$(cat $T/display) WAYLAND_DISPLAY= $S/vulkan_window $T/lod.gtx "
            "--size 240x160 --frames 4; result=$?; kill $server; wait $server; exit $result"), 0);
}

int main(void)
{
#define PICTURE(name) cmocka_unit_test_prestate(draws_its_picture, name)
#define MISUSE(name) cmocka_unit_test_prestate(misuse_is_one_line, name)
    static char smallest[] = "smallest_engine", instances[] = "instances", picking[] = "picking",
                mixed[] = "mixed_scene", gbuffer[] = "engine_gbuffer", shadows[] = "shadows",
                rays[] = "ray_shadows", implicit[] = "implicit", filters[] = "filters",
                lighting[] = "engine_lighting",
                cellular[] = "cellular", footprints[] = "footprints", rhi[] = "rhi";
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cooking_says_how_far_it_is),
        cmocka_unit_test(halls_and_caves_are_around_the_eye),
        cmocka_unit_test(a_terrain_goes_through_the_nodes_of_its_grid),
        cmocka_unit_test(an_interrupt_leaves_nothing_behind),
        cmocka_unit_test(an_asset_is_printed),
        PICTURE(smallest),
        PICTURE(instances),
        PICTURE(picking),
        PICTURE(mixed),
        PICTURE(gbuffer),
        PICTURE(shadows),
        PICTURE(lighting),
        PICTURE(rays),
        PICTURE(implicit),
        cmocka_unit_test(an_engine_submits_the_same_picture),
        cmocka_unit_test(horizons_are_made_and_drawn),
        PICTURE(filters),
        PICTURE(cellular),
        PICTURE(footprints),
        cmocka_unit_test(a_world_is_walked_through),
        cmocka_unit_test(vulkan_draws_into_windows),
        MISUSE(rhi), MISUSE(smallest),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
