/* The npm package in a real Chromium, where it could be built and installed: browser.mjs runs the
 * checks. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>

static int run(const char *command)
{
    const int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
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
    assert_int_equal(run("node tests/web/browser.mjs \"$GTX_BUILD/web/app\" "
                         "\"$GTX_BUILD/web/sculpt.gtx\" \"$GTX_BUILD/web/pictures\" >&2"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_package_works_in_a_browser)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
