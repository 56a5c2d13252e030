/* samples/pipeline: a build cooks what changed, and nothing else. */
#include "cli/command.h"

#include <time.h>
#include <unistd.h>
#include <utime.h>

/* A folder of models: a textured triangle with its files, a sphere below, and names that need
 * escaping. */
static const char gltf[] =
    "{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"byteLength\": 60, \"uri\": \"tri.bin\"}],"
    "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 36},"
    "{\"buffer\": 0, \"byteOffset\": 36, \"byteLength\": 24}],"
    "\"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, "
    "\"type\": \"VEC3\"},"
    "{\"bufferView\": 1, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC2\"}],"
    "\"images\": [{\"uri\": \"my%20skin.png\"}], \"textures\": [{\"source\": 0}],"
    "\"materials\": [{\"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}}}],"
    "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0, \"TEXCOORD_0\": 1},"
    "\"material\": 0}]}], \"nodes\": [{\"mesh\": 0}], \"scenes\": [{\"nodes\": [0]}]}";
static const float numbers[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1};
/* 2 x 2 pixels. */
static const unsigned char png[] = {
    0x89, 'P',  'N',  'G',  0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 'I',  'H',  'D',
    'R',  0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xfd,
    0xd4, 0x9a, 0x73, 0x00, 0x00, 0x00, 0x10, 'I',  'D',  'A',  'T',  0x78, 0x9c, 0x63, 0xf8,
    0xcf, 0xc0, 0x00, 0x44, 0x0c, 0x10, 0x0a, 0x00, 0x1f, 0xee, 0x03, 0xfd, 0x8b, 0x5f, 0x14,
    0xd4, 0x00, 0x00, 0x00, 0x00, 'I',  'E',  'N',  'D',  0xae, 0x42, 0x60, 0x82};

static char root[512]; /* where the project lies */

static void make_models(void)
{
    expect(shell("rm -rf models out && mkdir -p models/sub out"), 0);
    write_file("models/tri.gltf", gltf, sizeof gltf - 1);
    write_file("models/tri.bin", numbers, sizeof numbers);
    write_file("models/my skin.png", png, sizeof png);
    write_sphere("models/sub/ball one.obj", 12);
}

/* Clocks of file systems are coarse: two changes need a pause between them to be two. */
static void touch(const char *name)
{
    nanosleep(&(struct timespec){0, 30000000}, NULL);
    assert_int_equal(utime(in_folder(name), NULL), 0);
}

static void change(const char *name)
{
    size_t size;
    char *data = slurp(name, &size);
    data[size / 2] ^= 1;
    write_file(name, data, size);
    free(data);
    touch(name);
}

static long long changed(const char *name)
{
    struct stat info;
    assert_int_equal(stat(in_folder(name), &info), 0);
    return info.st_mtim.tv_sec * 1000000000ll + info.st_mtim.tv_nsec;
}

/* Runs `build` and checks how many cooks it says it started, and which output it wrote. */
static void builds(const char *build, unsigned cooks, const char *tri, bool tri_written,
                   const char *ball, bool ball_written)
{
    long long before[2] = {exists(tri) ? changed(tri) : 0, exists(ball) ? changed(ball) : 0};
    expect(shell("%s", build), 0);
    unsigned found = 0;
    for (const char *at = output; (at = strstr(at, "COOK ")) != NULL; ++at)
        ++found;
    if (found != cooks)
        fail_msg("%u cooks instead of %u: %s", found, cooks, output);
    assert_int_equal(changed(tri) != before[0], tri_written);
    assert_int_equal(changed(ball) != before[1], ball_written);
}

/* `leaves_alone`: the build looks at times after a cook, so that equal content ends there. */
static void follow_changes(const char *build, const char *tri, const char *ball, bool leaves_alone)
{
    builds(build, 2, tri, true, ball, true);
    expect(gtx("validate '%s'", tri), 0);
    expect(gtx("validate '%s'", ball), 0);
    builds(build, 0, tri, false, ball, false);
    static const char *const parts[] = {"models/tri.bin", "models/my skin.png", "models/tri.gltf"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; ++i) {
        touch(parts[i]);
        builds(build, 1, tri, !leaves_alone, ball, false);
        builds(build, 0, tri, false, ball, false);
    }
    change("models/tri.bin");
    builds(build, 1, tri, true, ball, false);
    builds(build, 0, tri, false, ball, false);
    change("models/my skin.png");
    builds(build, 1, tri, true, ball, false);
    builds(build, 0, tri, false, ball, false);
    write_sphere("models/sub/ball one.obj", 13);
    touch("models/sub/ball one.obj");
    builds(build, 1, tri, false, ball, true);
    builds(build, 0, tri, false, ball, false);
    assert_int_equal(unlink(in_folder(tri)), 0);
    expect(shell("%s", build), 0);
    assert_true(exists(tri));
}

static void ninja_cooks_what_changed(void **state)
{
    (void)state;
    need("ninja");
    make_models();
    expect(shell("%s/samples/pipeline/ninja.sh models out '%s' >build.ninja", root, getenv("GTX")),
           0);
    follow_changes("ninja", "out/tri.gltf.gtx", "out/sub/ball one.obj.gtx", true);
}

static void ninja_takes_odd_names(void **state)
{
    (void)state;
    need("ninja");
    expect(shell("rm -rf 'odd $1' out && mkdir 'odd $1'"), 0);
    write_sphere("odd $1/a #1 $(x) b.obj", 12);
    expect(shell("%s/samples/pipeline/ninja.sh 'odd $1' out '%s' >build.ninja", root,
                 getenv("GTX")), 0);
    expect(shell("ninja"), 0);
    expect_text("COOK");
    expect(shell("ninja"), 0);
    expect_text("no work to do");
    touch("odd $1/a #1 $(x) b.obj");
    expect(shell("ninja"), 0);
    expect_text("COOK");
    expect(shell("ninja"), 0);
    expect_text("no work to do");
}

static void cmake_cooks_what_changed(void **state)
{
    static const struct {
        const char *generator, *program;
        bool leaves_alone;
    } cases[] = {{"Ninja", "ninja", true}, {"Unix Makefiles", "make", false}};
    (void)state;
    need("cmake");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        if (shell("command -v %s", cases[i].program))
            continue;
        make_models();
        expect(shell("cmake -G '%s' -S %s/samples/pipeline -B out -DMODELS=$PWD/models -DGTX='%s'",
                     cases[i].generator, root, getenv("GTX")), 0);
        follow_changes("cmake --build out", "out/tri.gltf.gtx", "out/sub/ball one.obj.gtx",
                       cases[i].leaves_alone);
    }
}

/* What sbatch does, one task after another. */
static const char sbatch[] =
    "#!/bin/sh\nfor word; do case $word in --array=1-*) n=${word#--array=1-} ;; "
    "--output=*) log=${word#--output=} ;; esac; done\ncat >job.sh\n"
    "for i in $(seq \"$n\"); do SLURM_ARRAY_TASK_ID=$i sh job.sh "
    ">\"$(echo \"$log\" | sed \"s/%a/$i/\")\" 2>&1 || exit; done\necho 17\n";

static void job_arrays_cook_a_folder(void **state)
{
    (void)state;
    make_models();
    write_file("sbatch", sbatch, sizeof sbatch - 1);
    const char *cook = "chmod +x sbatch && PATH=$PWD:$PATH "
                       "%s/samples/pipeline/slurm.sh models 'o t' cache 3 '%s'";
    expect(shell(cook, root, getenv("GTX")), 0);
    assert_string_equal(output, "17\n");
    expect(gtx("validate 'o t/tri.gtx'"), 0);
    expect(gtx("validate 'o t/sub/ball one.gtx'"), 0);
    expect(shell("cat 'o t'/*.json | grep -c '\"outcome\": \"cooked\"'"), 0);
    assert_int_equal(atoi(output), 2);
    expect(shell("rm 'o t/tri.gtx'"), 0);
    expect(shell(cook, root, getenv("GTX")), 0);
    expect(shell("grep -ho '\"outcome\": \"[a-z]*\"' 'o t'/*.json | sort"), 0);
    assert_string_equal(output, "\"outcome\": \"cached\"\n\"outcome\": \"unchanged\"\n");
    write_file("models/broken.ply", "ply\n", 4);
    assert_int_not_equal(shell(cook, root, getenv("GTX")), 0);
}

/* A texture that is gone is a change, and the model is cooked without it. */
static void deleted_sources_stop_no_build(void **state)
{
    (void)state;
    need("make");
    make_models();
    static const char rules[] = "out/tri.gtx:\n\t'$(GTX)' cook -q models/tri.gltf -o $@ "
                                "--depfile out/tri.d && echo COOK\n-include out/tri.d\n";
    write_file("Makefile", rules, sizeof rules - 1);
    for (int with_ninja = 0; with_ninja < 2; ++with_ninja) {
        make_models();
        if (with_ninja && shell("command -v ninja"))
            break;
        if (with_ninja)
            expect(shell("%s/samples/pipeline/ninja.sh models out '%s' >build.ninja", root,
                         getenv("GTX")), 0);
        const char *build = with_ninja ? "ninja out/tri.gltf.gtx" : "make -s";
        expect(shell("%s", build), 0);
        expect_text("COOK");
        expect(shell("%s", build), 0);
        assert_null(strstr(output, "COOK"));
        assert_int_equal(unlink(in_folder("models/my skin.png")), 0);
        expect(shell("%s", build), 0);
        expect_text("COOK");
        expect(shell("%s", build), 0);
        assert_null(strstr(output, "COOK"));
    }
}

static int set_up_here(void **state)
{
    return getcwd(root, sizeof root) ? set_up(state) : 1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ninja_cooks_what_changed),
        cmocka_unit_test(ninja_takes_odd_names),
        cmocka_unit_test(cmake_cooks_what_changed),
        cmocka_unit_test(deleted_sources_stop_no_build),
        cmocka_unit_test(job_arrays_cook_a_folder),
    };
    return cmocka_run_group_tests(tests, set_up_here, tear_down);
}
