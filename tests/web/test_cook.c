/* The cooker in a real Chromium, where `make web-cook web-test` has built and installed it:
 * cook.mjs runs the checks, of models that the command has cooked, too. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>

static int run(const char *command)
{
    const int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* A ball with dents and vertex colours: as text, numbers of all lengths among it. */
static void write_ball(const char *path, int around, int high)
{
    const double pi = acos(-1.);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\n"
                  "property float y\nproperty float z\nproperty uchar red\n"
                  "property uchar green\nproperty uchar blue\nelement face %d\n"
                  "property list uchar int vertex_indices\nend_header\n",
            around * (high - 1) + 2, 2 * around * (high - 1));
    for (int j = 1; j < high; ++j)
        for (int i = 0; i < around; ++i) {
            const double u = 2 * pi * i / around, v = pi * j / high;
            const double r = 1 + .05 * sin(7 * u) * pow(sin(v), 4) * sin(9 * v);
            fprintf(file, "%.9g %.17g %.6e %d %d %d\n", r * sin(v) * cos(u), r * cos(v),
                    r * sin(v) * sin(u), 128 + i % 128, 255 - j, 40);
        }
    fprintf(file, "0 1 0 255 255 255\n0 -1 0 0 0 0\n");
    const int north = around * (high - 1), south = north + 1;
    for (int i = 0; i < around; ++i) {
        const int k = (i + 1) % around, last = around * (high - 2);
        fprintf(file, "3 %d %d %d\n3 %d %d %d\n", north, k, i, south, last + i, last + k);
        for (int j = 0; j < high - 2; ++j) {
            const int a = around * j, b = a + around;
            fprintf(file, "3 %d %d %d\n3 %d %d %d\n", a + i, a + k, b + k, a + i, b + k, b + i);
        }
    }
    assert_int_equal(fclose(file), 0);
}

static void a_page_cooks_what_the_command_does(void **state)
{
    char ball[4096];
    (void)state;
    if (run("command -v node >/dev/null && command -v \"${CHROMIUM:-chromium}\" >/dev/null && "
            "[ -f \"$GTX_BUILD/web/app/node_modules/geotex/cooker.wasm\" ]"))
        skip();
    assert_int_equal(run("mkdir -p \"$GTX_BUILD/web/cooked\" \"$GTX_BUILD/web/pictures\""), 0);
    snprintf(ball, sizeof ball, "%s/web/cooked/ball.ply", getenv("GTX_BUILD"));
    write_ball(ball, 120, 60);
    assert_int_equal(run("cd \"$GTX_BUILD/web/cooked\" && head -c 200000 ball.ply >short.ply && "
                         "echo 'no model' >notes.txt && gzip -c ball.ply >packed.ply.gz && "
                         "\"$GTX_OUT/samples/sculpt\" --triangles 20000 sculpt.glb >/dev/null && "
                         "for m in ball.ply packed.ply.gz sculpt.glb; do "
                         "\"$GTX\" cook -q $m -o $m.gtx || exit 1; done && "
                         "\"$GTX\" cook -q ball.ply -o ball.ply.options.gtx --partition layers "
                         "--resolution 96 --lod-levels 2 --height-bits 16"), 0);
    assert_int_equal(run("node tests/web/cook.mjs \"$GTX_BUILD/web/app\" \"$GTX_BUILD/web/cooked\" "
                         "\"$GTX_BUILD/web/pictures\" ball.ply packed.ply.gz sculpt.glb >&2"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_page_cooks_what_the_command_does)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
