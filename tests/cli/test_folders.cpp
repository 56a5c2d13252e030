/* gtx cook of folders: every model is tried, parts of them on other machines, and a cache. */
#include "common/schema.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

extern "C" {
#include "cli/command.h"
}

#include <unistd.h>

using schema::json;

#define QUICK "--resolution 64 --mips 1 --lod-levels 0 --texel-density 0 -q"

static int shell(const std::string &line)
{
    return shell("%s", line.c_str());
}

static void write_text(const std::string &name, const std::string &text)
{
    std::ofstream(in_folder(name.c_str())) << text;
}

/* A tetrahedron of some height. */
static void write_small(const std::string &name, double height)
{
    write_text(name, "v 0 " + std::to_string(height) + " 0\nv 1 0 0\nv 0 0 1\nv -1 0 -1\n"
                     "f 1 3 2\nf 1 4 3\nf 1 2 4\nf 2 3 4\n");
}

static json report_of(const char *name)
{
    std::ifstream file(in_folder(name));
    const json report = json::parse(file);
    const json rules = schema::load("format/folder-report.schema.json");
    const json cook = schema::load("format/cook-report.schema.json");
    std::string why = schema::broken(report, rules, rules);
    for (const json &model : report["models"])
        if (why.empty() && !model["report"].is_null())
            why = schema::broken(model["report"], cook, cook);
    if (!why.empty())
        fail_msg("%s", why.c_str());
    return report;
}

static int count_of(const json &report, const char *what)
{
    return report[what].get<int>();
}

static void a_thousand_models(void **)
{
    expect(shell("mkdir -p many/0 many/1 many/2/deep"), 0);
    static const char *const places[] = {"many/", "many/0/", "many/1/t ", "many/2/deep/"};
    for (int i = 0; i < 1000; ++i)
        write_small(places[i % 4] + std::to_string(i) + ".obj", 1 + i * 0.001);
    write_text("many/notes.txt", "no model");
    write_text("many/.hidden.obj", "no model");
    expect(gtx("cook many -o all " QUICK " --cache cache --jobs 3 --report r.json"), 0);
    json report = report_of("r.json");
    assert_int_equal(count_of(report, "cooked"), 1000);
    assert_int_equal(report["models"].size(), 1000);
    expect(shell("find all -name '*.gtx' | wc -l"), 0);
    assert_int_equal(atoi(output), 1000);
    expect(gtx("cook many/2/deep/7.obj -o one.gtx " QUICK), 0);
    same_files("one.gtx", "all/2/deep/7.gtx");

    /* On three machines that share the cache: each model on one of them. */
    int sum = 0;
    for (int shard = 1; shard <= 3; ++shard) {
        expect(gtx("cook many -o parts " QUICK " --cache cache --shard %d/3 --report r.json",
                   shard), 0);
        report = report_of("r.json");
        assert_int_equal(count_of(report, "cooked"), 0);
        assert_true(count_of(report, "cached") > 250 && count_of(report, "shards") == 3);
        sum += count_of(report, "cached");
    }
    assert_int_equal(sum, 1000);
    expect(shell("diff -r all parts"), 0);
    expect(gtx("cook many -o parts " QUICK " --if-changed --report r.json"), 0);
    assert_int_equal(count_of(report_of("r.json"), "unchanged"), 1000);
    expect(gtx("cook many -o all " QUICK " --if-changed --progress json"), 0);
    assert_int_equal(*output, 0);
    expect(gtx("cook many/1 -o all --if-changed --progress json --shard 1/20"), 0);
    expect_text("{\"done\": 1, \"total\": ");
    expect_text(" models: ");
}

/* What is wrong with one does not stop the others. */
static void every_model_is_tried(void **)
{
    expect(shell("mkdir -p bad/sub bad/shut && ln -s .. bad/sub/up && "
                 "ln -s nowhere bad/gone.obj && mkfifo bad/pipe.ply && "
                 "ln -s sub bad/again && mkdir bad/folder.obj"), 0);
    write_small("bad/good.obj", 1);
    write_small("bad/sub/good.obj", 1);
    write_small("bad/shut/good.obj", 1);
    write_text("bad/broken.ply", "ply\nnothing");
    write_text("bad/empty.obj", "v 0 0 0\n");
    const bool is_root = geteuid() == 0; /* for whom nothing is shut */
    expect(shell("chmod 0 bad/shut; chmod 777 . bad"), 0);
    const std::string command =
        std::string(is_root ? "setpriv --reuid 65534 --clear-groups " : "") +
        "'" + getenv("GTX") + "' cook bad -o out --report r.json " + QUICK;
    assert_int_equal(shell(command), 3); /* the highest */
    expect_text("bad/broken.ply: error[input]: ");
    expect_text("bad/empty.obj: error[empty]: ");
    expect_text("bad/gone.obj: error[read]: cannot open the file: No such file");
    expect_text("bad/pipe.ply: error[read]: it is no regular file");
    expect_text("bad/shut: error[read]: Permission denied");
    const json report = report_of("r.json");
    assert_int_equal(count_of(report, "cooked"), 2);
    assert_int_equal(count_of(report, "failed"), 3);
    assert_int_equal(count_of(report, "exit_code"), 3);
    assert_int_equal(report["unreadable"].size(), 2);
    expect(shell("find out -type f | sort | tr '\\n' ' '"), 0);
    assert_string_equal(output, "out/good.gtx out/sub/good.gtx ");
    expect(shell("chmod 700 bad/shut"), 0);

    write_small("bad/sub/good.stl.obj", 1);
    write_small("bad/good.off", 1);
    expect(gtx("cook bad -o out2 " QUICK), 1);
    expect_text("gtx cook: error[usage]: bad/good.obj and bad/good.off would give one asset: "
                "out2/good.gtx\n");
    assert_false(exists("out2"));
    expect(gtx("cook bad/shut bad/sub -o out2 " QUICK), 1);
    expect_text("bad/shut/good.obj and bad/sub/good.obj would give one asset");
    expect(shell("mkdir none"), 0);
    expect(gtx("cook none -o out2"), 3);
    expect_text("there is no model to cook");
    assert_false(exists("out2"));
}

static void misuse_is_told(void **)
{
    static const char *const wrong[] = {
        "--shard 0/3", "--shard 4/3", "--shard 1/0", "--shard 1", "--shard 1/3x", "--shard -1/3",
        "--depfile d", "--charts-ply c.ply", "--name a.obj"};
    for (const char *option : wrong) {
        expect(gtx("cook bad -o no %s", option), 1);
        assert_false(exists("no"));
    }
    expect(gtx("cook sphere.obj -o no.gtx --shard 1/2"), 1);
    expect(gtx("cook sphere.obj -o no.gtx --jobs 2"), 1);
    expect(gtx("cook - -o no/ <sphere.obj"), 1);
    expect(gtx("cook bad -o no --report bad/good.obj"), 1);
    assert_false(exists("no") || exists("no.gtx"));
    /* Several models into a folder: each into an asset of its own. */
    write_small("a.obj", 1);
    write_small("b.ply.obj", 2);
    expect(gtx("cook a.obj b.ply.obj -o each/ " QUICK), 0);
    expect(gtx("cook a.obj -o each " QUICK), 0); /* it is a folder now */
    assert_true(exists("each/a.gtx") && exists("each/b.ply.gtx"));
}

static void cooks_from(const char *asset, const char *text)
{
    expect(gtx("cook sphere.obj -o %s --cache cache2", asset), 0);
    expect_text(text);
    same_files("sphere.gtx", asset);
}

/* What is in a cache is taken only as it was put there. */
static void a_cache_may_be_damaged(void **)
{
    cooks_from("a.gtx", "patches");
    assert_null(strstr(output, "note[cache]"));
    cooks_from("b.gtx", "b.gtx: from the cache\n");
    expect(shell("ls cache2/*/*"), 0);
    output[strcspn(output, "\n")] = 0;
    const std::string entry = output;
    size_t size;
    free(slurp("sphere.gtx", &size));
    const std::string damages[] = {
        "truncate -s " + std::to_string(size / 2) + " " + entry, "truncate -s 0 " + entry,
        "printf x | dd of=" + entry + " bs=1 conv=notrunc seek=" + std::to_string(size / 2),
        "printf x | dd of=" + entry + " bs=1 conv=notrunc seek=96",
        "'" + std::string(getenv("GTX")) + "' cook a.obj -q -o " + entry};
    for (const std::string &damage : damages) {
        expect(shell(damage), 0);
        cooks_from("c.gtx", "note[cache]: ");
        expect_text("is not taken and made again: ");
        cooks_from("d.gtx", "d.gtx: from the cache\n");
    }
    write_text("victim", "precious");
    expect(shell("ln -sf $PWD/victim " + entry), 0);
    cooks_from("c.gtx", "it is no regular file");
    expect(shell("cat victim"), 0);
    assert_string_equal(output, "precious");
    expect(shell("rm " + entry + " && mkfifo " + entry), 0);
    cooks_from("c.gtx", "it is no regular file");
    /* One that cannot be written to is no error. */
    expect(gtx("cook sphere.obj -o c.gtx --cache victim"), 0);
    expect_text("sphere.obj: note[cache]: the asset is not kept in the cache: ");
    /* What a cached cook warned of, a build with --strict does not take. */
    expect(gtx("cook a.obj -o c.gtx --cache cache2"), 0);
    expect_text("warning[few-triangles]");
    expect(gtx("cook a.obj -o c.gtx --cache cache2"), 0);
    expect_text("warning[few-triangles]");
    expect_text("from the cache");
    expect(gtx("cook a.obj -o e.gtx --cache cache2 --strict"), 3);
    assert_false(exists("e.gtx"));
    expect(gtx("cook a.obj -o e.gtx --cache cache2 --strict --allow "
               "few-triangles,empty-texels"), 0);
    expect_text("from the cache");
}

/* Jobs share the memory that is allowed; what needs more than its part is cooked alone. */
static void memory_is_shared(void **)
{
    expect(shell("mkdir -p large && for i in 1 2 3 4; do cp sphere.obj large/$i.obj; done"), 0);
    expect(gtx("cook sphere.obj -q -o a.gtx --max-memory 18M"), 0);
    expect(gtx("cook sphere.obj -q -o a.gtx --max-memory 4M"), 6);
    expect(gtx("cook large -o out3 --jobs 3 --max-memory 18M"), 0);
    expect_text("4 cooked");
    expect(gtx("cook large -o out4 --jobs 1 --max-memory 4M -q"), 6);
    expect_text("--max-memory allows more");
}

/* Ctrl-C leaves whole assets, and the report says which models are missing. */
static void an_interrupt_leaves_whole_files(void **)
{
    expect(shell("mkdir -p slow && for i in 1 2 3 4 5 6 7 8 9 a b c d e f; do "
                 "cp sphere.obj slow/$i.obj; done"), 0);
    assert_int_equal(shell("\"$GTX\" cook slow -o out5 --jobs 2 --report r.json & pid=$!; "
                           "for i in $(seq 600); do ls out5/*.gtx >/dev/null 2>&1 && break; "
                           "sleep 0.02; done; kill -TERM $pid; wait $pid"), 130);
    const json report = report_of("r.json");
    assert_int_equal(count_of(report, "exit_code"), 130);
    assert_true(count_of(report, "untried") > 0 && count_of(report, "cooked") > 0);
    expect(shell("ls -A out5 | wc -l"), 0);
    assert_int_equal(atoi(output), count_of(report, "cooked"));
    expect(shell("for a in out5/*; do \"$GTX\" validate -q $a || exit 1; done"), 0);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_thousand_models),
        cmocka_unit_test(every_model_is_tried),
        cmocka_unit_test(misuse_is_told),
        cmocka_unit_test(a_cache_may_be_damaged),
        cmocka_unit_test(memory_is_shared),
        cmocka_unit_test(an_interrupt_leaves_whole_files),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
