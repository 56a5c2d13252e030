/* What `make install` puts where, and strangers' programs built against it alone. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CORE_HEADERS "geotex.h edit.h solid.h view.h frame.h rays.h render.h stream.h"

static char folder[] = "/tmp/gtx-install-XXXXXX";
static bool staged;

/* Runs a shell command with $STAGE set to the folder; true when it succeeds. */
static bool shell(const char *command)
{
    int status = system(command);
    if (status)
        print_message("%s\n  ended with status %d\n", command, status);
    return status == 0;
}

static void need_stage(void)
{
    if (!staged)
        skip(); /* only what is released is installed, and only make knows how */
}

static int set_up(void **state)
{
    (void)state;
    const char *config = getenv("GTX_CONFIG"), *build = getenv("GTX_BUILD");
    if (!mkdtemp(folder))
        return -1;
    setenv("STAGE", folder, 1);
    char path[64];
    snprintf(path, sizeof path, "%s/model.obj", folder);
    FILE *model = fopen(path, "w");
    if (!model)
        return -1;
    fputs("v 0 0 0\nv 1 0 0\nv 1 1 0.2\nv 0 1 0\nf 1 2 3 4\n", model);
    fclose(model);
    staged = build && config && !strcmp(config, "release") &&
             shell("make -s build=\"$GTX_BUILD\" PREFIX=\"$STAGE/usr\" DESTDIR= install");
    return !staged && build && config && !strcmp(config, "release") ? -1 : 0;
}

static int tear_down(void **state)
{
    (void)state;
    return shell("rm -rf \"$STAGE\"") ? 0 : -1;
}

static void exactly_the_listed_files_are_installed(void **state)
{
    (void)state;
    need_stage();
    assert_true(shell("cd \"$STAGE/usr\" && find . ! -type d | sed 's,^./,,' | LC_ALL=C sort "
                      "> \"$STAGE/found\""));
    /* What needs Vulkan's headers and glslang, GDAL or NetCDF is there where they are. */
    assert_true(shell("none=$(test -e \"$STAGE/usr/lib/libgeotex-vulkan.so\" || "
                      "echo ^lib.*-vulkan); "
                      "grid=$(test -e \"$STAGE/usr/lib/geotex/geotex-grid.so\" || "
                      "echo geotex-grid); "
                      "netcdf=$(test -e \"$STAGE/usr/lib/geotex/geotex-netcdf\" || "
                      "echo geotex-netcdf); "
                      "LC_ALL=C sort lib/package/files | grep -v \"${none:-^$}\" | "
                      "grep -v \"${grid:-^$}\" | grep -v \"${netcdf:-^$}\" | "
                      "diff - \"$STAGE/found\" >&2"));
}

static void nothing_is_left_unfilled(void **state)
{
    (void)state;
    need_stage();
    assert_true(shell("! grep -rn '@[A-Z_]*@' \"$STAGE\"/usr/lib/pkgconfig "
                      "\"$STAGE\"/usr/lib/cmake \"$STAGE\"/usr/share/man"));
    assert_true(shell("for verb in cook horizons info validate filter combine render compare "
                      "bench; do grep -q \"^.SS gtx $verb\" "
                      "\"$STAGE\"/usr/share/man/man1/gtx.1 || exit 1; done"));
}

static void libraries_export_what_headers_declare(void **state)
{
    (void)state;
    need_stage();
    assert_true(shell(
        "cd \"$STAGE/usr\" && "
        "for pair in 'libgeotex.so " CORE_HEADERS "' 'libgeotex-cook.so cook.h export.h grid.h' "
        "'libgeotex-vulkan.so vulkan.h'; "
        "do set -- $pair; so=$1; shift; test -e lib/$so || continue; "
        "(cd include/geotex && cat \"$@\") | "
        "grep -o 'gtx_[a-z_]*(' | tr -d '(' | sort -u > \"$STAGE/declared\"; "
        "nm -D --defined-only lib/$so | awk '$3 ~ /^gtx_/ {print $3}' | sort "
        "> \"$STAGE/exported\"; "
        "grep -vxF -f \"$STAGE/declared\" \"$STAGE/exported\" && exit 1; "
        "nm -D --defined-only lib/$so | awk '$3 !~ /^gtx_/ {print; bad = 1} END {exit bad}' "
        "|| exit 1; "
        "done; exit 0"));
    /* and the other way: every GTX_API function is there */
    assert_true(shell(
        "cd \"$STAGE/usr\" && "
        "for pair in 'libgeotex.so " CORE_HEADERS "' 'libgeotex-cook.so cook.h export.h grid.h' "
        "'libgeotex-vulkan.so vulkan.h'; "
        "do set -- $pair; so=$1; shift; test -e lib/$so || continue; "
        "nm -D --defined-only lib/$so | awk '{print $3}' > "
        "\"$STAGE/exported\"; (cd include/geotex && cat \"$@\") | tr '\\n' ' ' | "
        "grep -o 'GTX_API [^;(]*(' | grep -o 'gtx_[a-z_]*($' | tr -d '(' > \"$STAGE/declared\"; "
        "test -s \"$STAGE/declared\" || exit 1; "
        "grep -vxF -f \"$STAGE/exported\" \"$STAGE/declared\" && exit 1; done; exit 0"));
}

/* Builds tests/consumer/consumer.c with a compiler line and runs it. */
static void consume(const char *build)
{
    char command[1024];
    need_stage();
    snprintf(command, sizeof command,
             "export PKG_CONFIG_PATH=\"$STAGE/usr/lib/pkgconfig\" "
             "LD_LIBRARY_PATH=\"$STAGE/usr/lib\"; "
             "%s && rm -f \"$STAGE/out.gtx\" && "
             "\"$STAGE/consumer\" \"$STAGE/model.obj\" \"$STAGE/out.gtx\" | grep -q 'hit at [01]'",
             build);
    assert_true(shell(command));
}

static void pkg_config_shared(void **state)
{
    (void)state;
    consume("${CC:-cc} -std=c11 -Wall -Wextra -Werror tests/consumer/consumer.c "
            "-o \"$STAGE/consumer\" $(pkg-config --cflags --libs geotex-cook)");
    consume("${CXX:-c++} -x c++ -std=c++11 -Wall -Wextra -Werror tests/consumer/consumer.c "
            "-o \"$STAGE/consumer\" $(pkg-config --cflags --libs geotex-cook)");
}

static void pkg_config_static(void **state)
{
    (void)state;
    consume("mkdir -p \"$STAGE/only\" && cp \"$STAGE\"/usr/lib/*.a \"$STAGE/only\" && "
            "${CC:-cc} -std=c11 tests/consumer/consumer.c -o \"$STAGE/consumer\" -L\"$STAGE/only\" "
            "$(pkg-config --static --cflags --libs geotex-cook | sed 's|-L[^ ]*/usr/lib ||') && "
            "! readelf -d \"$STAGE/consumer\" | grep -q geotex");
}

static void cmake_finds_it(void **state)
{
    (void)state;
    need_stage();
    if (system("command -v cmake >/dev/null"))
        skip();
    assert_true(shell("cmake -S tests/consumer -B \"$STAGE/cmake\" "
                      "-DCMAKE_PREFIX_PATH=\"$STAGE/usr\" -DCMAKE_C_COMPILER_LAUNCHER= "
                      ">\"$STAGE/cmake.log\" 2>&1 && cmake --build \"$STAGE/cmake\" "
                      ">>\"$STAGE/cmake.log\" 2>&1 || { cat \"$STAGE/cmake.log\"; exit 1; }"));
    assert_true(shell("for p in shared_c shared_cpp static_c static_cpp; do "
                      "\"$STAGE/cmake/$p\" \"$STAGE/model.obj\" \"$STAGE/$p.gtx\" || exit 1; "
                      "done"));
}

/* The installed command finds its image module, and draws without a display. */
static void the_installed_command_works(void **state)
{
    (void)state;
    need_stage();
    assert_true(shell("cd / && \"$STAGE/usr/bin/gtx\" cook -q \"$STAGE/model.obj\" "
                      "-o \"$STAGE/m.gtx\""));
    assert_true(shell("cd / && \"$STAGE/usr/bin/gtx\" render \"$STAGE/m.gtx\" -o \"$STAGE/m.png\" "
                      "--size 64x64 && test -s \"$STAGE/m.png\""));
}

static void uninstalling_removes_all(void **state)
{
    (void)state;
    need_stage();
    assert_true(shell("make -s build=\"$GTX_BUILD\" PREFIX=\"$STAGE/gone\" DESTDIR= install && "
                      "make -s build=\"$GTX_BUILD\" PREFIX=\"$STAGE/gone\" DESTDIR= uninstall && "
                      "test -z \"$(find \"$STAGE/gone\" ! -type d)\""));
}

static void the_tarball_is_reproducible(void **state)
{
    (void)state;
    need_stage();
    if (system("git rev-parse HEAD >/dev/null 2>&1"))
        skip();
    assert_true(shell("make -s build=\"$STAGE/a\" dist >/dev/null && "
                      "(umask 077; TZ=Asia/Tokyo LC_ALL=C make -s build=\"$STAGE/b\" dist "
                      ">/dev/null) && "
                      "cmp \"$STAGE\"/a/*.tar.gz \"$STAGE\"/b/*.tar.gz"));
    assert_true(shell("cd \"$STAGE\" && tar xzf a/*.tar.gz && cd geotex-* && "
                      "make -s build=out out/release/libgeotex.a >/dev/null"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exactly_the_listed_files_are_installed),
        cmocka_unit_test(nothing_is_left_unfilled),
        cmocka_unit_test(libraries_export_what_headers_declare),
        cmocka_unit_test(pkg_config_shared),
        cmocka_unit_test(pkg_config_static),
        cmocka_unit_test(cmake_finds_it),
        cmocka_unit_test(the_installed_command_works),
        cmocka_unit_test(uninstalling_removes_all),
        cmocka_unit_test(the_tarball_is_reproducible),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
