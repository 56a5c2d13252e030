/* gtx world: whoever runs its steps, in whatever order, killed and begun again: the same bytes. */
#include "cli/command.h"

#include <unistd.h>

static void plan(const char *world, const char *engine)
{
    expect(gtx("world plan big.obj --output %s --triangles 2k --glb --engine %s "
               "--worker-memory 500M --unit 2 -q", world, engine), 0);
}

/* Of every tile, and of what says where they are. */
static const char *hashes(const char *world)
{
    expect(shell("cd %s && find tiles tileset.json tiles.gtw -name '[!.]*' -type f | sort | "
                 "xargs sha256sum", world), 0);
    assert_non_null(strstr(output, "tiles/r.gtx"));
    assert_non_null(strstr(output, "tiles/r.glb"));
    assert_non_null(strstr(output, "tileset.json"));
    return output;
}

static void same_worlds(const char *a, const char *b)
{
    char *first = strdup(hashes(a));
    assert_string_equal(first, hashes(b));
    free(first);
}

static int cook_by_shell(void **state)
{
    if (set_up(state))
        return 1;
    write_sphere("big.obj", 60);
    plan("one", "shell");
    return shell("sh one/build.sh");
}

/* Every tile is valid, and has the triangles of its plan. */
static void a_world_has_all_triangles(void **state)
{
    (void)state;
    expect(shell("for t in one/tiles/*.gtx; do \"$GTX\" validate -q $t || exit 1; done"), 0);
    expect(shell("ls one/tiles/*.gtx | wc -l"), 0);
    assert_true(atoi(output) >= 9);
    expect(gtx("world plan big.obj -o two --triangles 2k --up z"), 0);
    expect_text("14160 triangles seen from the front, ");
    expect(gtx("world plan big.obj -o inside --triangles 2k --sides both"), 0);
    expect_text("14160 triangles, ");
    expect(shell("grep -o '\"geometricError\"' one/tileset.json | wc -l"), 0);
    assert_true(atoi(output) >= 10);
}

/* As an asset would be. */
static void a_world_is_compared(void **state)
{
    (void)state;
    expect(gtx("compare one big.obj --size 64 --max-holes 0 --min-iou 0.99"), 0);
    expect_text("hole pixels     0 of ");
    expect(gtx("compare one/tileset.json big.obj --size 64 --json --tile-error 0.1 -q"), 0);
    expect_text("\"hole_pixels\": 0");
    expect(gtx("compare one big.obj --size 64 --max-rms 1e-6"), 7);
    expect_text("one: error[differs]: forward RMS");
    expect(gtx("compare one none.obj --size 64"), 2);
    expect_text("none.obj: error[read]");
    expect(gtx("compare one big.obj --size 64 --max-memory 1M"), 6);
    expect_text("--max-memory allows more");
    expect(shell("cp -r one lost; rm lost/tiles/r?.gtx lost/tiles/r??.gtx"), 0);
    expect(gtx("compare lost big.obj --size 64"), 2);
    expect_text("lost/tiles/r");
}

/* All is there: nothing is written. */
static void steps_do_nothing_twice(void **state)
{
    (void)state;
    expect(shell("find one -name '[!.]*' -type f ! -name tileset.json -printf '%%p %%T@\\n' | "
                 "sort >before"), 0);
    expect(shell("sh one/build.sh"), 0);
    expect(shell("find one -name '[!.]*' -type f ! -name tileset.json -printf '%%p %%T@\\n' | "
                 "sort >after; cmp before after"), 0);
    expect(gtx("world cook one r --threads 2"), 0);
    expect_text("unchanged");
    expect(gtx("world split one"), 0);
    expect_text("unchanged");
}

static void ninja_makes_the_same(void **state)
{
    (void)state;
    need("ninja");
    for (int jobs = 1; jobs <= 2; ++jobs) {
        expect(shell("rm -rf by-ninja"), 0);
        plan("by-ninja", "ninja");
        expect(shell("ninja -C by-ninja -j%d", jobs), 0);
        same_worlds("one", "by-ninja");
        expect(shell("ninja -C by-ninja"), 0);
        expect_text("no work to do");
    }
    expect(shell("rm by-ninja/tiles/r.gtx; ninja -C by-ninja"), 0);
    same_worlds("one", "by-ninja");
}

/* The sixth step and the eleventh are killed while they run. */
static void killed_workers_leave_nothing_wrong(void **state)
{
    static const char killer[] =
        "#!/bin/sh\necho step >>steps\ncase $(wc -l <steps) in\n"
        "6|11) \"$REAL\" \"$@\" & sleep 0.08; kill -9 $!; wait $!; exit 137;;\nesac\n"
        "exec \"$REAL\" \"$@\"\n";
    (void)state;
    write_file("killer", killer, sizeof killer - 1);
    plan("killed", "shell");
    expect(shell("chmod +x killer; export REAL=\"$GTX\" GTX=$PWD/killer; ! sh killed/build.sh && "
                 "! sh killed/build.sh && sh killed/build.sh"), 0);
    same_worlds("one", "killed");
    expect(shell("echo >killed/work/low/r0x; for t in killed/tiles/*.gtx; do : >$t; break; done; "
                 "sh killed/build.sh"), 0); /* a tile that somebody spoiled */
    same_worlds("one", "killed");
}

static void leaves_may_come_in_any_order(void **state)
{
    (void)state;
    plan("turned", "shell");
    expect(shell("cd turned; awk '/cook/ && !m {c[n++]=$0; next} /merge/ && !m {m=1; "
                 "while (n) print c[--n]} {print}' build.sh >b; cmp -s b build.sh && exit 1; "
                 "sh ./b"), 0);
    same_worlds("one", "turned");
}

static void slurm_gets_jobs_that_wait(void **state)
{
    (void)state;
    plan("by-slurm", "slurm");
    expect(shell("cat by-slurm/slurm/submit.sh by-slurm/slurm/job.sh; sh -n "
                 "by-slurm/slurm/submit.sh && sh -n by-slurm/slurm/job.sh"), 0);
    expect_text("--mem=501M");
    expect_text("--dependency=afterok:$job --array=1-");
    char root[1024];
    assert_non_null(getcwd(root, sizeof root));
    if (!shell("sinfo -h -o %%a | grep up")) {
        expect(shell("job=$(sh by-slurm/slurm/submit.sh | tail -1); srun -Q -d afterany:$job true"),
               0);
    } else if (!shell("[ $(id -u) = 0 ] && command -v munged slurmctld slurmd")) {
        expect(shell("sh %s/samples/pipeline/cluster/slurm.sh by-slurm", root), 0);
    } else {
        printf("no Slurm is running or installed here\n");
        skip();
    }
    same_worlds("one", "by-slurm");
}

/* What plan was allowed, its steps are, whoever runs them. */
static void limits_go_on_to_the_steps(void **state)
{
    static const char serial[] = /* of Dask, what the script asks of it: one after another */
        "class Client:\n    def __init__(self, cluster): pass\n"
        "    def __enter__(self): return self\n    def __exit__(self, *error): pass\n"
        "    def submit(self, run, *arguments, pure): return run(*arguments)\n\n\n"
        "def LocalCluster(**options): pass\n";
    static const char *const engines[][3] = {
        {"ninja", "ninja", "ninja -C limited"},
        {"shell", "sh", "sh limited/build.sh"},
        {"slurm", "awk", "cd limited; export SLURM_ARRAY_TASK_COUNT=1 SLURM_ARRAY_TASK_ID=1; "
                         "sh slurm/job.sh split && sh slurm/job.sh cook $(ls slurm/cook-* | "
                         "tail -1)"},
        {"ninja", "python3", "PYTHONPATH=. python3 $ROOT/samples/pipeline/world_dask.py limited"},
    };
    (void)state;
    char root[1024];
    assert_non_null(getcwd(root, sizeof root));
    setenv("ROOT", root, 1);
    write_file("distributed.py", serial, sizeof serial - 1);
    for (size_t i = 0; i < sizeof engines / sizeof *engines; ++i) {
        if (shell("command -v %s", engines[i][1]))
            continue;
        expect(shell("rm -rf limited"), 0);
        expect(gtx("world plan big.obj -o limited --triangles 2k --engine %s --max-work 200k -q",
                   engines[i][0]), 0);
        assert_int_not_equal(shell("%s", engines[i][2]), 0);
        expect_text("--max-work allows more");
    }
}

/* One line, and the exit code of what went wrong. */
static void refuses(const char *arguments, int code, const char *text)
{
    expect(gtx("%s", arguments), code);
    expect_text(text);
    assert_int_equal(strlen(output), strcspn(output, "\n") + 1);
}

static void faults_are_one_line(void **state)
{
    (void)state;
    expect(shell("mkdir -p models empty; cp big.obj models; head -c 3000 /bin/sh >rubbish.ply; "
                 "rm -f none"), 0);
    refuses("world", 1, "a step is missing");
    refuses("world dance", 1, "the steps are");
    refuses("world plan big.obj", 1, "-o DIR is missing");
    refuses("world plan - - -o w", 1, "standard input is read once");
    refuses("world plan big.obj -o w --triangles 10", 1, "--triangles wants N");
    refuses("world plan models -o models/w", 1, "the world's folder would hold");
    refuses("world plan models -o .", 1, "the world's folder would hold");
    refuses("world plan big.obj -o .", 1, "the world's folder would hold");
    refuses("world plan one/tiles/r.glb -o one", 1, "the world's folder would hold");
    refuses("world plan empty -o w", 3, "there is no model in the folder");
    refuses("world plan none.ply -o w", 2, "none.ply");
    refuses("world plan rubbish.ply -o w", 3, "rubbish.ply");
    refuses("world plan big.obj -o w --max-triangles 100", 6, "--max-triangles allows more");
    refuses("world split empty", 2, "gtx world plan makes it");
    refuses("world cook one r99", 1, "the plan has no tile 'r99'");
    refuses("world merge one r99", 1, "the plan has no tile 'r99'");
    expect(gtx("world plan big.obj -o fresh --triangles 2k -q"), 0);
    refuses("world cook fresh r", 2, "the step that makes it has not run");
    refuses("world index fresh", 2, "is not cooked");
    refuses("world split fresh --max-memory 100k", 6, "--max-memory allows more");
    expect(gtx("world split fresh -q --progress json"), 0);
    expect(shell("cell=$(ls fresh/work/split/r* | head -1); truncate -s -1 $cell; basename $cell"),
           0);
    output[strcspn(output, "\n")] = 0;
    char spoiled[128];
    snprintf(spoiled, sizeof spoiled, "world cook fresh %.60s", output);
    refuses(spoiled, 3, "is not whole");
    expect(shell("echo '{\"tiles\": [{\"name\": \"../../x\"}]}' >fresh/plan.json"), 0);
    refuses("world split fresh", 3, "none that gtx world plan wrote");
    assert_false(exists("w/plan.json"));
}

static void triangles_come_from_stdin(void **state)
{
    (void)state;
    const float triangle[18] = {0, 0, 0, 1, 0, 0, 0, 0, 1, NAN, 0, 0, 1, 0, 0, 0, 0, 1};
    write_file("raw", triangle, sizeof triangle);
    expect(gtx("world plan - -o raw-world <raw"), 0);
    expect_text("1 triangles, 1 leaves");
    expect_text("warning[non-finite]: 1 triangles");
    write_file("raw", triangle, sizeof triangle - 1);
    refuses("world plan - -o raw-world <raw", 3, "no whole number of triangles");
}

/* Read as a stream asks for it; what is not as the index tells ends in one line, without a
 * picture. */
static void a_world_is_drawn(void **state)
{
    (void)state;
    expect(gtx("render one -o world.png --size 96x64 --max-error 0.1"), 0);
    expect(shell("file world.png | grep -q 96 || test -s world.png"), 0);
    expect(shell("cp -r one shown; rm shown/tiles/r.gtx"), 0);
    refuses("render shown -o no.png", 2, "shown: error[read]: tiles/r.gtx: No such file");
    expect(shell("head -c 5000 one/tiles/r.gtx >shown/tiles/r.gtx"), 0);
    refuses("render shown -o no.png", 3, "tiles/r.gtx: the tile ends after 5000 of");
    expect(shell("cp one/tiles/r.gtx shown/tiles; for t in shown/tiles/r?.gtx; do "
                 "cp one/tiles/r.gtx $t; done"), 0);
    expect(gtx("render shown -o far.png --size 64x48 --camera 30,20,60"), 0);
    expect(gtx("render shown -o no.png --max-error 0.001"), 3);
    expect_text("of the tile");
    expect(shell("printf x >>shown/tiles.gtw"), 0);
    refuses("render shown -o no.png", 3, "shown: error[corrupt]: the header of the index");
    assert_false(exists("no.png"));
    refuses("render one -o one/tiles.gtw", 1, "one/tiles.gtw");
    refuses("render one -o no.png --max-memory 100k", 6, "--max-memory allows more");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_world_has_all_triangles),
        cmocka_unit_test(a_world_is_compared),
        cmocka_unit_test(steps_do_nothing_twice),
        cmocka_unit_test(ninja_makes_the_same),
        cmocka_unit_test(killed_workers_leave_nothing_wrong),
        cmocka_unit_test(leaves_may_come_in_any_order),
        cmocka_unit_test(slurm_gets_jobs_that_wait),
        cmocka_unit_test(limits_go_on_to_the_steps),
        cmocka_unit_test(faults_are_one_line),
        cmocka_unit_test(triangles_come_from_stdin),
        cmocka_unit_test(a_world_is_drawn),
    };
    return cmocka_run_group_tests(tests, cook_by_shell, tear_down);
}
