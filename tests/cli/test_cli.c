/* The command as a script sees it: exit codes, one clear line, whole files or none. */
#include "cli/command.h"

#include <limits.h>
#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static void usage_is_exit_1(void **state)
{
    (void)state;
    expect(gtx(""), 1);
    expect(gtx("frobnicate"), 1);
    expect_text("frobnicate");
    expect(gtx("cook"), 1);
    expect(gtx("cook sphere.obj"), 1);
    expect_text("-o OUT.gtx");
    expect(gtx("cook sphere.obj -o x.gtx --resolution 7"), 1);
    expect_text("64 to 512");
    expect(gtx("cook sphere.obj -o x.gtx --unknown"), 1);
    expect(gtx("cook sphere.obj -o x.gtx --charts"), 1);
    expect(gtx("cook none.obj -o x.gtx --height-bits 9"), 1); /* before the model is read */
    expect_text("--height-bits wants 8|16, not '9'");
    expect(gtx("horizons none.irap -o x.gtx --height-bits 9"), 1);
    expect(gtx("info"), 1);
    expect(gtx("info a b"), 1);
    assert_false(exists("x.gtx"));
}

static void help_is_exit_0(void **state)
{
    static const char *const verbs[] = {"cook",   "info",   "validate", "unpack", "pack",
                                        "filter", "render", "compare",  "combine"};
    (void)state;
    expect(gtx("--help"), 0);
    expect(gtx("--version"), 0);
    expect_text("gtx 0.1.0");
    expect_text("\nformat 0.7, cooker revision ");
    expect_text("\nzstd ");
    expect_text(", Draco 1.");
    for (size_t i = 0; i < sizeof verbs / sizeof *verbs; ++i) {
        expect(gtx("%s --help", verbs[i]), 0);
        expect_text(verbs[i]);
        char help[sizeof output];
        strcpy(help, output);
        expect(gtx("help %s", verbs[i]), 0);
        assert_string_equal(output, help);
    }
    expect(gtx("help frobnicate"), 1);
    expect_text("unknown verb 'frobnicate'");
}

/* Of a checkout, the commit that it stands at, however it was built before. */
static void version_tells_the_commit(void **state)
{
    (void)state;
    char commit[64] = "";
    FILE *git = popen("test \"$(git rev-parse --show-toplevel 2>/dev/null)\" = \"$PWD\" && "
                      "git rev-parse --short=12 HEAD", "r");
    assert_non_null(git);
    const char *line = fgets(commit, sizeof commit, git);
    pclose(git);
    if (!line)
        skip();
    commit[strcspn(commit, "\n")] = '\0';
    expect(gtx("--version"), 0);
    expect_text(commit);
}

/* What bash would offer for the last of the words, which follow the command. */
static void completes(const char *words, const char *wanted)
{
    char command[1024], found[1024] = "";
    snprintf(command, sizeof command,
             "bash -c 'source lib/package/gtx.bash; COMP_WORDS=(\"$GTX\" %s); "
             "COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _gtx; echo \"${COMPREPLY[*]}\"'", words);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    assert_non_null(fgets(found, sizeof found, pipe));
    pclose(pipe);
    found[strcspn(found, "\n")] = 0;
    assert_string_equal(found, wanted);
}

static void bash_completes_verbs_options_and_values(void **state)
{
    (void)state;
    completes("va", "validate");
    completes("help comb", "combine");
    completes("cook --part", "--partition");
    completes("cook --partition l", "layers");
    completes("cook model.obj --max-p", "--max-pixels --max-patches");
    completes("cook mod", "");
}

static void a_missing_file_is_exit_2(void **state)
{
    (void)state;
    expect(gtx("cook none.obj -o x.gtx"), 2);
    expect_text("none.obj: error[read]:");
    expect(gtx("info none.gtx"), 2);
    expect(gtx("validate none.gtx"), 2);
    expect(gtx("compare none.gtx sphere.obj"), 2);
    expect(gtx("compare sphere.gtx none.obj"), 2);
    expect(gtx("cook sphere.obj -o no/such/folder/x.gtx"), 2);
    expect(gtx("info ."), 2);
    expect(gtx("cook . -o x.gtx"), 1);
    assert_false(exists("x.gtx"));
}

static void bad_models_are_exit_3_and_write_nothing(void **state)
{
    static const struct {
        const char *name, *text;
        int code;
    } cases[] = {
        {"empty.obj", "", 3},
        {"points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", 3},
        {"index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", 3},
        {"nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 3},
        {"flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", 3},
        {"short.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", 3},
        {"lying.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n"
                      "property float x\nproperty float y\nproperty float z\n"
                      "element face 1\nproperty list uchar int vertex_indices\nend_header\nabc", 3},
        {"empty.glb", "glTF", 3},
        {"bad.gltf", "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":["
                     "{\"attributes\":{\"POSITION\":7}}]}],\"nodes\":[{\"mesh\":0}],"
                     "\"scenes\":[{\"nodes\":[0]}]}", 3},
        {"ext.gltf", "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"ACME_x\"],"
                     "\"extensionsUsed\":[\"ACME_x\"]}", 5},
        {"noise.drc", "DRACO\002\002\001\001abcdefgh", 3},
        {"what.xyz", "1 2 3\n", 5},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        write_file(cases[i].name, cases[i].text, strlen(cases[i].text));
        write_file("kept.gtx", "precious", 8);
        expect(gtx("cook %s -o kept.gtx", cases[i].name), cases[i].code);
        expect_text("error[");
        assert_int_equal(strchr(output, '\n') - output + 1, (long)strlen(output)); /* one line */
        size_t size;
        char *kept = slurp("kept.gtx", &size);
        assert_int_equal(size, 8);
        assert_memory_equal(kept, "precious", 8);
        free(kept);
        assert_int_equal(left_over(), 0);
    }
}

static void one_triangle_cooks(void **state)
{
    static const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    (void)state;
    write_file("one.obj", text, sizeof text - 1);
    expect(gtx("cook one.obj -o one.gtx"), 0);
    expect(gtx("validate one.gtx"), 0);
    expect(gtx("compare one.gtx one.obj --size 256 --min-iou 0.9"), 0);
}

static void an_asset_is_described(void **state)
{
    (void)state;
    expect(gtx("info sphere.gtx"), 0);
    expect_text("patches");
    expect_text("cells at most");
    expect(gtx("info --json sphere.gtx"), 0);
    expect_text("\"ray_cells\": ");
    expect_text("\"content_hash\": \"0x");
    expect(gtx("validate sphere.gtx"), 0);
    expect_text("valid");
    expect(gtx("validate --json sphere.gtx"), 0);
    expect_text("\"valid\": true");
    expect(gtx("cook -q sphere.obj -o again.gtx"), 0);
    assert_string_equal(output, "");
}

static void cooking_is_deterministic(void **state)
{
    size_t size[2];
    (void)state;
    expect(gtx("cook sphere.obj -o one.gtx --threads 1"), 0);
    expect(gtx("cook sphere.obj -o three.gtx --threads 3"), 0);
    char *one = slurp("one.gtx", &size[0]), *three = slurp("three.gtx", &size[1]);
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(one, three, size[0]);
    free(one);
    free(three);
}

static void broken_assets_name_the_rule(void **state)
{
    size_t size;
    char *good = slurp("sphere.gtx", &size);
    (void)state;
    write_file("short.gtx", good, size / 2);
    expect(gtx("info short.gtx"), 3);
    expect(gtx("validate short.gtx"), 3);
    expect_text("118");
    write_file("tiny.gtx", good, 20);
    expect(gtx("validate tiny.gtx"), 3);
    good[60] ^= 1; /* page_width: the header's hash no longer fits */
    write_file("flip.gtx", good, size);
    expect(gtx("info flip.gtx"), 3);
    expect(gtx("validate flip.gtx"), 3);
    expect_text("byte");
    write_file("text.gtx", "hello\n", 6);
    expect(gtx("validate text.gtx"), 3);
    expect_text("100");
    expect(gtx("compare text.gtx sphere.obj"), 3);
    free(good);
}

static void every_verb_names_the_broken_rule(void **state)
{
    static const struct {
        const char *verb, *rest;
    } calls[] = {
        {"info", ""}, {"validate", ""}, {"view", ""}, {"compare", "sphere.obj"},
        {"bench", "sphere.obj"}, {"unpack", "maps"}, {"pack", "-o x.gtx"},
        {"render", "-o x.png"}, {"filter", "-o x.gtx --gaussian 1"},
        {"combine", "sphere.gtx -o x.gtx --op union"},
    };
    char bad[PATH_MAX];
    (void)state;
    assert_non_null(realpath("tests/golden/bad/305-patch-page.gtx", bad));
    for (size_t i = 0; i < sizeof calls / sizeof *calls; ++i) {
        expect(gtx("%s '%s' %s", calls[i].verb, bad, calls[i].rest), 3);
        expect_text("305-patch-page.gtx: error[305 patch-page]: a patch lies on an existing page");
        expect_text(" (byte 512)\n");
    }
}

static void comparing_judges_only_stated_limits(void **state)
{
    (void)state;
    expect(gtx("compare sphere.gtx sphere.obj --size 256 --levels 1"), 0);
    expect_text("silhouette IoU");
    expect(gtx("compare sphere.gtx sphere.obj --size 256 --levels 1 --max-holes 0 --min-iou 0.98"),
           0);
    expect(gtx("compare sphere.gtx sphere.obj --size 256 --levels 1 --max-rms 1e-12"), 7);
    expect(gtx("compare sphere.gtx sphere.obj --size 256 --levels 1 --views 3 --seed 9 --json"), 0);
    expect_text("\"hole_pixels\"");
    expect_text("\"wall_pixels\"");
    expect_text("\"views\": 29");
    expect(gtx("compare --help"), 0);
    expect_text("format/measures.md");
}

static void rendering_writes_a_png(void **state)
{
    (void)state;
    int code = gtx("render sphere.gtx -o sphere.png --size 64x64");
    if (code == 5)
        skip(); /* no OpenGL here */
    expect(code, 0);
    size_t size;
    char *png = slurp("sphere.png", &size);
    assert_true(size > 100);
    assert_memory_equal(png, "\x89PNG", 4);
    free(png);
    expect(gtx("render sphere.gtx -o d.png --size 64x64 --depth d.exr"), 0);
    char *exr = slurp("d.exr", &size);
    assert_memory_equal(exr, "\x76\x2f\x31\x01", 4);
    free(exr);
    code = gtx("render sphere.gtx -o es.png --size 64x64 --gles");
    assert_true((code == 0 && exists("es.png")) || code == 5);
    code = gtx("render sphere.gtx -o vulkan.png --size 64x64 --vulkan");
    assert_true((code == 0 && exists("vulkan.png")) || code == 5);
    if (code == 0) {
        expect(gtx("render sphere.obj -o mesh.png --vulkan"), 5);
        expect_text("by Vulkan only assets are drawn");
        assert_false(exists("mesh.png"));
    }
    expect(gtx("render sphere.gtx -o x.png --vulkan --gles"), 1);
    expect(gtx("render none.gtx -o x.png"), 2);
    expect(gtx("render sphere.gtx -o x.png --max-cells 50"), 6);
    expect_text("a ray through the asset takes");
    expect_text("--max-cells allows more");
    expect(gtx("render sphere.gtx"), 1);
    expect(gtx("render sphere.gtx --method lod -o with_lod.png --size 64x64"), 0);
    expect(gtx("cook sphere.obj --lod-levels 0 -o bare.gtx"), 0);
    expect(gtx("render bare.gtx --method lod -o x.png"), 5); /* it has none */
    assert_false(exists("x.png"));
}

/* The interrupt comes at ten moments of a longer cook. */
static void an_interrupted_cook_leaves_no_half_file(void **state)
{
    (void)state;
    write_sphere("big.obj", 260);
    for (int moment = 0; moment < 10; ++moment) {
        write_file("kept.gtx", "precious", 8);
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            if (chdir(folder) == 0 && freopen("stderr.txt", "w", stderr))
                execl(getenv("GTX"), "gtx", "cook", "big.obj", "-o", "kept.gtx", (char *)NULL);
            _exit(99);
        }
        struct timespec pause = {0, (20 + 60 * moment) * 1000000};
        nanosleep(&pause, NULL);
        kill(child, SIGINT);
        int status;
        assert_int_equal(waitpid(child, &status, 0), child);
        size_t size;
        char *kept = slurp("kept.gtx", &size);
        bool cancelled = WIFSIGNALED(status) || WEXITSTATUS(status) == 130;
        if (cancelled) {
            assert_int_equal(size, 8);
            assert_memory_equal(kept, "precious", 8);
        } else {
            assert_int_equal(WEXITSTATUS(status), 0);
            expect(gtx("validate kept.gtx"), 0);
        }
        free(kept);
        assert_int_equal(left_over(), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(usage_is_exit_1),
        cmocka_unit_test(help_is_exit_0),
        cmocka_unit_test(version_tells_the_commit),
        cmocka_unit_test(bash_completes_verbs_options_and_values),
        cmocka_unit_test(a_missing_file_is_exit_2),
        cmocka_unit_test(bad_models_are_exit_3_and_write_nothing),
        cmocka_unit_test(one_triangle_cooks),
        cmocka_unit_test(an_asset_is_described),
        cmocka_unit_test(cooking_is_deterministic),
        cmocka_unit_test(broken_assets_name_the_rule),
        cmocka_unit_test(every_verb_names_the_broken_rule),
        cmocka_unit_test(comparing_judges_only_stated_limits),
        cmocka_unit_test(rendering_writes_a_png),
        cmocka_unit_test(an_interrupted_cook_leaves_no_half_file),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
