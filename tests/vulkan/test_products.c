/* Shaders as products: each language that a tool is there for, with the bindings that
 * format/shaders.md tells. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>

static char folder[] = "/tmp/gtx_products_XXXXXX";

/* A command in the folder, with the script and the program that writes texts as $S and $W. */
static int shell(const char *command)
{
    char whole[2048];
    snprintf(whole, sizeof whole,
             "S=$PWD/lib/vulkan/products.sh W=$GTX_OUT/gen/write_texts; cd %s && %s", folder,
             command);
    return system(whole);
}

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

/* A hull's cast, a tile's and an LOD mesh's. */
static void languages_are_made(void **state)
{
    (void)state;
    if (!getenv("GTX_OUT") || shell("command -v glslangValidator >/dev/null"))
        skip();
    assert_int_equal(shell("sh $S $W out 0 48 64 2>said"), 0);
    assert_int_equal(shell("test $(ls out/glsl | wc -l) = 6 && test $(ls out/spirv | wc -l) = 6"),
                     0);
    assert_int_equal(shell("for f in out/spirv/*; do test $(od -An -tx4 -N4 $f) = 07230203 || "
                           "exit 1; done"), 0);
    assert_int_equal(shell("grep -q '\"64\": {\"vertex\": \".*.vert\", \"fragment\": \".*.frag\"}' "
                           "out/pipelines.json"), 0);
    /* What is missing is named. */
    assert_int_equal(shell("command -v spirv-cross >/dev/null || grep -q 'no spirv-cross' said"),
                     0);
    assert_int_equal(shell("command -v naga >/dev/null || grep -q 'no naga' said"), 0);
    assert_int_equal(shell("! command -v spirv-cross >/dev/null || { "
                           "grep -q 'uint4> .* : register(t0)' out/hlsl/*.frag.hlsl && "
                           "grep -q 'cbuffer .* : register(b8)' out/hlsl/*.frag.hlsl && "
                           "grep -q 'buffer(8)' out/msl/*.frag.metal && "
                           "grep -q 'texture_buffer<uint> .*texture(9)' out/msl/*; }"), 0);
    assert_int_equal(shell("! command -v naga >/dev/null || { test $(ls out/wgsl | wc -l) = 4 && "
                           "grep -q '@binding(16)' out/wgsl/*; }"), 0);
}

static void errors_are_told(void **state)
{
    (void)state;
    if (!getenv("GTX_OUT") || shell("command -v glslangValidator >/dev/null"))
        skip();
    assert_int_equal(shell("echo '#version 450' >text && echo 'void main() { wrong(); }' >>text && "
                           "printf '#!/bin/sh\\ncp text $1/0.vert; cp text $1/0.frag\\n' >bad && "
                           "chmod +x bad"), 0);
    assert_int_not_equal(shell("sh $S ./bad broken 2>said"), 0);
    assert_int_equal(shell("grep -q wrong said"), 0);
    /* Without tools nothing is made, and that is said. */
    assert_int_equal(shell("PATH=/nowhere /bin/sh $S ./bad none 2>said"), 0);
    assert_int_equal(shell("grep -q 'no glslangValidator' said && test ! -e none"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(languages_are_made),
                                       cmocka_unit_test(errors_are_told)};
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
