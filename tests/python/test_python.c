/* The wheel in a fresh virtual environment: pip installs it without a network, and what it holds
 * is tested by the unit tests beside this file. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

static char folder[] = "/tmp/gtx-python-XXXXXX";

/* Runs a shell command with $T the test's folder; returns its exit code. */
static int run(const char *format, const char *name)
{
    char command[1024];
    snprintf(command, sizeof command, format, name);
    const int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* Sanitizers need to be loaded before Python is, and its own memory is none of ours. */
static int set_up(void **state)
{
    static int possible = 1;
    const char *config = getenv("GTX_CONFIG");
    if (!mkdtemp(folder))
        return -1;
    setenv("T", folder, 1);
    setenv("PYTHON", "/usr/bin/python3", 0);
    if (!config || strcmp(config, "release") != 0 ||
        run("$PYTHON -c 'import cffi, numpy, ensurepip' 2>/dev/null && "
            "test -f $GTX_OUT/python/.wheel%s", "") != 0)
        return 0;
    *state = &possible;
    return run("$PYTHON -m venv --system-site-packages $T/venv && "
               "$T/venv/bin/pip --disable-pip-version-check --quiet install --no-index --no-deps "
               "$(cat $GTX_OUT/python/.wheel)%s >&2", "");
}

static int tear_down(void **state)
{
    (void)state;
    return run("rm -r %s", folder);
}

/* -I: neither the folder that this runs in nor the user's own packages are looked into. */
static void passes(void **state, const char *name)
{
    if (!*state)
        skip();
    assert_int_equal(run("$T/venv/bin/python -I -W error tests/python/%s.py >&2", name), 0);
}

static void assets_are_arrays(void **state)
{
    passes(state, "assets");
}

static void rays_come_in_batches(void **state)
{
    passes(state, "rays");
}

static void models_are_cooked(void **state)
{
    passes(state, "cooking");
}

static void maps_are_drawn_by_the_sample(void **state)
{
    if (!*state || run("$T/venv/bin/python -c 'import matplotlib%s' 2>/dev/null", "") != 0)
        skip();
    assert_int_equal(run("MPLCONFIGDIR=$T $T/venv/bin/python samples/python_maps.py "
                         "tests/golden/good/%s.gtx $T/maps.png && test -s $T/maps.png", "color"),
                     0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(assets_are_arrays),
        cmocka_unit_test(rays_come_in_batches),
        cmocka_unit_test(models_are_cooked),
        cmocka_unit_test(maps_are_drawn_by_the_sample),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
