/* Exports in programs that know nothing of assets, those that are installed: three.js, Blender and
 * Godot draw them, and the validator of Khronos has nothing to say. */
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

static char folder[] = "/tmp/gtx-outside-XXXXXX";
static char said[16384];

/* Returns the exit status; `said` is what the command printed. */
static int run(const char *command)
{
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    said[fread(said, 1, sizeof said - 1, pipe)] = 0;
    return pclose(pipe);
}

/* The share of a picture that is not its background. */
static double drawn(const char *name)
{
    char path[128];
    gtx_image image;
    gtx_error error = {0};
    size_t count = 0;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (gtx_image_read(path, &image, &error))
        fail_msg("%s: %s", name, error.message);
    const size_t pixels = (size_t)image.width * image.height;
    for (size_t i = 0; i < pixels; ++i) {
        int most = 0;
        for (size_t c = 0; c < 3; ++c) {
            const int difference = abs(image.pixels[4 * i + c] - image.pixels[c]);
            most = difference > most ? difference : most;
        }
        count += most > 12;
    }
    gtx_image_free(&image);
    return (double)count / (double)pixels;
}

static void each_draws_it(void **state)
{
    static const struct {
        const char *line, *picture;
    } pictures[] = {{"ok three none", "three_none.png"},
                    {"ok three meshopt", "three_meshopt.png"},
                    {"ok three draco", "three_draco.png"},
                    {"ok three ktx2", "three_ktx2.png"},
                    {"ok blender", "blender.png"},
                    {"ok godot", "godot.png"}};
    char command[1024];
    (void)state;
    assert_non_null(mkdtemp(folder));
    snprintf(command, sizeof command,
             "{ m=\"${GTX_NODE_MODULES:-$GTX_BUILD/web/app/node_modules}\"; d=%s; "
             "\"$GTX_OUT/samples/sculpt\" --triangles 20000 $d/a.glb && "
             "\"$GTX\" cook -q $d/a.glb -o $d/a.gtx && "
             "sh tests/export/outside/run.sh \"$GTX\" $d/a.gtx $d $([ -d \"$m\" ] && echo \"$m\"); "
             "} 2>&1", folder);
    const int status = run(command);
    print_message("%s", said);
    assert_int_equal(status, 0);
    for (size_t i = 0; i < sizeof pictures / sizeof *pictures; ++i) {
        if (!strstr(said, pictures[i].line))
            continue;
        const double share = drawn(pictures[i].picture);
        print_message("# %s: %.1f %% of the picture\n", pictures[i].picture, 100 * share);
        assert_true(share > 0.1 && share < 0.7);
    }
    snprintf(command, sizeof command, "rm -rf %s", folder);
    assert_int_equal(run(command), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_draws_it)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
