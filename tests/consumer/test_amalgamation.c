/* The runtime as sources in a stranger's own build: one file, or a folder of CMake's. Rays hit as
 * those of the library do. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

static char folder[] = "/tmp/gtx-dropped-XXXXXX";

static bool shell(const char *command)
{
    int status = system(command);
    if (status)
        print_message("%s\n  ended with status %d\n", command, status);
    return status == 0;
}

/* $RUNTIME holds what a program linked with the library says of $ASSET. */
static int set_up(void **state)
{
    (void)state;
    if (!getenv("GTX_OUT") || !mkdtemp(folder))
        return -1;
    setenv("DROP", folder, 1);
    return shell("ls tests/golden/good/*.gtx | head -1 >\"$DROP/asset\" && "
                 "${CC:-cc} $GTX_FLAGS -Wall -Wextra -Wpedantic -Werror -Iinclude "
                 "tests/consumer/runtime.c \"$GTX_OUT/libgeotex.a\" $GTX_LIBS "
                 "-o \"$DROP/linked\" && "
                 "\"$DROP/linked\" $(cat \"$DROP/asset\") >\"$DROP/expected\" && "
                 "grep -q '^[0-9.]* [0-9.-]* ' \"$DROP/expected\"") ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    return shell("rm -rf \"$DROP\"") ? 0 : -1;
}

/* Sources by C compilers, headers by C++ ones. */
static void one_file_compiles_anywhere(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {
        {"gcc", "g++"}, {"clang", "clang++"},
        {"x86_64-w64-mingw32-gcc", "x86_64-w64-mingw32-g++"}, {"gcc-11", "g++-11"}};
    unsigned compiled = 0;
    assert_true(shell("printf '#include \"geotex_vulkan.h\"\\nint main() { gtx_vk *vk; return "
                      "gtx_vk_create(nullptr, &vk, nullptr) != GTX_ERROR_ARGUMENT; }\\n' "
                      ">\"$DROP/vulkan.cpp\""));
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; ++i) {
        setenv("C_COMPILER", pairs[i][0], 1);
        setenv("CXX_COMPILER", pairs[i][1], 1);
        if (system("command -v $C_COMPILER $CXX_COMPILER >/dev/null"))
            continue;
        assert_true(shell("$C_COMPILER -std=c11 -O1 -Wall -Wextra -Wpedantic -Werror "
                          "-c \"$GTX_BUILD/amalgamation/geotex.c\" -o \"$DROP/geotex.o\""));
        assert_true(shell("$CXX_COMPILER -x c++ -std=c++17 -Wall -Wextra -Wpedantic -Werror "
                          "-DDROPPED -I\"$GTX_BUILD/amalgamation\" -c tests/consumer/runtime.c "
                          "-o \"$DROP/runtime.o\" && $CXX_COMPILER \"$DROP/runtime.o\" "
                          "\"$DROP/geotex.o\" -lm -o \"$DROP/dropped\""));
        assert_true(shell("$C_COMPILER --version | head -1"));
        /* The face of Vulkan beside it, whose headers lie where those of the system do. */
        assert_true(shell("test ! -e \"$GTX_BUILD/amalgamation/geotex_vulkan.c\" || { "
                          "$C_COMPILER -std=c11 -O0 -Wall -Wextra -Wpedantic -Werror "
                          "-idirafter /usr/include -c "
                          "\"$GTX_BUILD/amalgamation/geotex_vulkan.c\" -o \"$DROP/vulkan.o\" && "
                          "$CXX_COMPILER -std=c++17 -Wall -Wextra -Wpedantic -Werror "
                          "-idirafter /usr/include -I\"$GTX_BUILD/amalgamation\" "
                          "\"$DROP/vulkan.cpp\" \"$DROP/vulkan.o\" \"$DROP/geotex.o\" -lm "
                          "-o \"$DROP/by_vulkan\"; }"));
        if (i == 0)
            assert_true(shell("test ! -e \"$DROP/by_vulkan\" || \"$DROP/by_vulkan\""));
        ++compiled;
    }
    assert_true(compiled > 0);
}

static void one_file_casts_as_the_library(void **state)
{
    (void)state;
    assert_true(shell("${CC:-cc} $GTX_FLAGS -O1 -std=c11 $GTX_DEFINES -ffp-contract=off -DDROPPED "
                      "-I\"$GTX_BUILD/amalgamation\" \"$GTX_BUILD/amalgamation/geotex.c\" "
                      "tests/consumer/runtime.c $GTX_LIBS -o \"$DROP/dropped\" && "
                      "\"$DROP/dropped\" $(cat \"$DROP/asset\") | diff - \"$DROP/expected\" >&2"));
}

static void cmake_takes_the_sources(void **state)
{
    (void)state;
    if (system("command -v cmake >/dev/null"))
        skip();
    assert_true(shell("cmake -S tests/consumer/fetched -B \"$DROP/cmake\" >\"$DROP/log\" 2>&1 && "
                      "cmake --build \"$DROP/cmake\" -j2 >>\"$DROP/log\" 2>&1 || "
                      "{ cat \"$DROP/log\"; exit 1; }"));
    assert_true(shell("\"$DROP/cmake/fetched\" $(cat \"$DROP/asset\") | "
                      "diff - \"$DROP/expected\" >&2"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_file_compiles_anywhere),
        cmocka_unit_test(one_file_casts_as_the_library),
        cmocka_unit_test(cmake_takes_the_sources),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
