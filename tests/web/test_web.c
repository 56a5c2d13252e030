/* The npm package in a real Chromium, where it could be built and installed: browser.mjs runs the
 * checks. */
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

/* A torus of 67,600 triangles, in the folder of the tests; its material has waves of normals. */
static void write_torus(const char *folder)
{
    enum { AROUND = 260, ACROSS = 130, SIDE = 256 };
    char path[1024];
    snprintf(path, sizeof path, "%s/torus.obj", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "mtllib torus.mtl\nusemtl waves\n");
    for (int i = 0; i <= AROUND; ++i)
        for (int j = 0; j <= ACROSS; ++j) {
            const double a = 2 * acos(-1) * (i % AROUND) / AROUND;
            const double b = 2 * acos(-1) * (j % ACROSS) / ACROSS, r = 1 + 0.4 * cos(b);
            fprintf(file, "v %.6f %.6f %.6f\nvt %.6f %.6f\n", r * cos(a), r * sin(a), 0.4 * sin(b),
                    4.0 * i / AROUND, 1.0 * j / ACROSS);
        }
    for (int i = 0; i < AROUND; ++i)
        for (int j = 1; j <= ACROSS; ++j) {
            const int k = i * (ACROSS + 1) + j, l = k + ACROSS + 1;
            fprintf(file, "f %d/%d %d/%d %d/%d %d/%d\n", k, k, l, l, l + 1, l + 1, k + 1, k + 1);
        }
    fclose(file);
    snprintf(path, sizeof path, "%s/torus.mtl", folder);
    file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "newmtl waves\nnorm waves.tga\n");
    fclose(file);
    snprintf(path, sizeof path, "%s/waves.tga", folder);
    file = fopen(path, "wb");
    assert_non_null(file);
    const unsigned char head[18] = {[2] = 2, [13] = SIDE >> 8, [15] = SIDE >> 8, [16] = 24};
    fwrite(head, 1, sizeof head, file);
    for (int i = 0; i < SIDE * SIDE; ++i) {
        const double tilt = 0.5 * sin(2 * acos(-1) * (i % SIDE) / 16);
        const unsigned char texel[3] = {(unsigned char)(128 + 127 * cos(tilt)), 128,
                                        (unsigned char)(128 + 127 * sin(tilt))};
        fwrite(texel, 1, sizeof texel, file);
    }
    fclose(file);
}

static void the_package_works_in_a_browser(void **state)
{
    (void)state;
    if (run("command -v node >/dev/null && command -v \"${CHROMIUM:-chromium}\" >/dev/null && "
            "[ -f \"$GTX_BUILD/web/app/.built\" ]"))
        skip();
    assert_int_equal(run("cd \"$GTX_BUILD/web\" && \"$GTX_OUT/samples/sculpt\" --triangles 100000 "
                         "sculpt.glb >/dev/null && \"$GTX\" cook -q sculpt.glb -o sculpt.gtx"), 0);
    assert_int_equal(run("cd \"$GTX_BUILD/web\" && rm -rf world && \"$GTX_OUT/samples/sculpt\" "
                         "--triangles 30000 small.glb >/dev/null && \"$GTX\" cook -q small.glb "
                         "-o small.gtx && \"$GTX\" world plan small.glb -q -o world --triangles "
                         "10000 --engine shell && sh world/build.sh"), 0);
    char folder[1000];
    snprintf(folder, sizeof folder, "%s/web", getenv("GTX_BUILD"));
    write_torus(folder);
    assert_int_equal(run("cd \"$GTX_BUILD/web\" && \"$GTX\" cook -q torus.obj -o relief.gtx && "
                         "grep -v mtl torus.obj >smooth.obj && \"$GTX\" cook -q smooth.obj "
                         "-o smooth.gtx"), 0);
    assert_int_equal(run("node tests/web/browser.mjs \"$GTX_BUILD/web/app\" "
                         "\"$GTX_BUILD/web/sculpt.gtx\" \"$GTX_BUILD/web/pictures\" >&2"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_package_works_in_a_browser)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
