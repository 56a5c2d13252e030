/* Every output of every verb: over what it goes, what becomes of it on a full disk, and that it is
 * never an input. */
#include "cli/command.h"

#include "image/image.h"

#include <sys/sysmacros.h>
#include <unistd.h>

/* %s is the output. Inputs are all files that are read, and that it may not be. */
static const struct {
    const char *command, *inputs[4];
    bool draws;
} outputs[] = {
    {"cook t.obj -q -o %s", {"t.obj", "t.mtl", "t.png"}, false},
    {"cook t.obj -q -o x.gtx --report %s", {"t.obj", "t.mtl", "t.png", "x.gtx"}, false},
    {"cook t.obj -q -o x.gtx --depfile %s", {"t.obj", "t.mtl", "t.png", "x.gtx"}, false},
    {"cook t.obj -q -o x.gtx --charts-ply %s", {"t.obj", "t.mtl", "t.png", "x.gtx"}, false},
    {"cook - --name t.obj -q -o %s <t.obj", {"t.obj", "t.mtl"}, false},
    {"horizons g.png@0,0=p.png -q -o %s", {"g.png", "p.png"}, false},
    {"horizons g.png@0,0=p.png -q -o x.gtx --report %s", {"g.png", "p.png", "x.gtx"}, false},
    {"horizons g.png@0,0=p.png -q -o x.gtx --depfile %s", {"g.png", "p.png", "x.gtx"}, false},
    {"pack a.gtx -o %s", {"a.gtx"}, false},
    {"pack maps -o x.gtx --report %s", {"maps/asset.json", "maps/height-0.png", "x.gtx"}, false},
    {"pack maps -o x.gtx --depfile %s", {"maps/asset.json", "maps/height-0.png", "x.gtx"}, false},
    {"pack maps -o %s", {"maps/asset.json", "maps/height-0.png"}, false},
    {"filter a.gtx --pattern p.png -o %s", {"a.gtx", "p.png"}, false},
    {"filter a.gtx --pattern p.png -o x.gtx --report %s", {"a.gtx", "p.png", "x.gtx"}, false},
    {"filter a.gtx --pattern p.png -o x.gtx --depfile %s", {"a.gtx", "p.png", "x.gtx"}, false},
    {"combine a.gtx a.gtx --op union --openness 1 --lod-levels 0 -q -o %s", {"a.gtx"}, false},
    {"combine a.gtx a.gtx --op union --openness 1 --lod-levels 0 -q -o x.gtx --report %s",
     {"a.gtx", "x.gtx"}, false},
    {"render t.obj a.gtx --size 64x48 -o %s", {"t.obj", "t.mtl", "t.png", "a.gtx"}, true},
    {"render a.gtx --size 64x48 -o x.png --depth %s", {"a.gtx", "x.png"}, true},
};
enum { OUTPUTS = sizeof outputs / sizeof *outputs };

/* As shell(), through a file: programs that the command leaves in the background would keep a pipe
 * open. */
static int sh(const char *format, ...)
{
    char text[1024], command[2048];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    snprintf(command, sizeof command, "cd %s && { %s; } >/tmp/%s.txt 2>&1", folder, text,
             strrchr(folder, '/') + 1);
    const int status = system(command);
    snprintf(command, sizeof command, "/tmp/%s.txt", strrchr(folder, '/') + 1);
    FILE *said = fopen(command, "r");
    assert_non_null(said);
    output[fread(output, 1, sizeof output - 1, said)] = 0;
    fclose(said);
    remove(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* Runs the command of an output; false where it needs a driver that is not there. */
static bool makes(int i, const char *before, const char *path, int wanted)
{
    char arguments[512];
    snprintf(arguments, sizeof arguments, outputs[i].command, path);
    const int code = sh("%s \"$GTX\" %s", before, arguments);
    if (outputs[i].draws && code == 5)
        return false;
    if (code != wanted)
        fail_msg("%s: exit code %d instead of %d: %s", arguments, code, wanted, output);
    return true;
}

static void same_file(const char *a, const char *b)
{
    if (sh("cmp %s %s", a, b))
        fail_msg("%s", output);
}

static void links_stay_links(void **state)
{
    (void)state;
    for (int i = 0; i < OUTPUTS; ++i) {
        sh("rm -rf real link far; mkdir far; echo old >real; ln -s real link");
        if (!makes(i, "", "link", 0))
            continue;
        if (sh("test -h link && ! grep -q '^old$' real && rm link && ln -s far/real link"))
            fail_msg("%s: the link was replaced", outputs[i].command);
        makes(i, "", "link", 0); /* it dangles */
        if (sh("test -h link && test -s far/real"))
            fail_msg("%s: the link was replaced", outputs[i].command);
    }
    assert_int_equal(left_over(), 0);
}

static void what_is_no_file_is_written_to(void **state)
{
    (void)state;
    for (int i = 0; i < OUTPUTS; ++i) {
        sh("rm -rf pipe got; mkfifo pipe");
        if (makes(i, "timeout 20 cat pipe >got & ", "pipe", 0) &&
            sh("test -p pipe || exit 1; until test -s got; do sleep 0.1; n=x$n; "
                  "test $n != xxxxxxxxxxxxxxxxxxxx || exit 1; done"))
            fail_msg("%s: the pipe was replaced", outputs[i].command);
    }
    char null[128], full[128];
    strcpy(null, in_folder("null"));
    strcpy(full, in_folder("full"));
    if (mknod(null, S_IFCHR | 0666, makedev(1, 3)) || mknod(full, S_IFCHR | 0666, makedev(1, 7)))
        skip(); /* not root */
    for (int i = 0; i < OUTPUTS; ++i) {
        makes(i, "", "null", 0);
        if (makes(i, "", "full", 2))
            expect_text("cannot write full: No space left on device");
        if (sh("test -c null && test -c full"))
            fail_msg("%s: the device was replaced", outputs[i].command);
    }
    assert_int_equal(left_over(), 0);
}

/* Nothing can be written, not even what the command says. */
static void a_full_disk_costs_nothing(void **state)
{
    (void)state;
    for (int i = 0; i < OUTPUTS; ++i) {
        sh("echo old >kept; rm -f fresh");
        makes(i, "ulimit -f 0;", "kept", 2);
        makes(i, "ulimit -f 0;", "fresh", 2);
        if (sh("test \"$(cat kept)\" = old && ! test -e fresh"))
            fail_msg("%s: something was written", outputs[i].command);
        assert_int_equal(left_over(), 0);
    }
    if (sh("ulimit -f 0; \"$GTX\" unpack a.gtx other") != 2 || exists("other"))
        fail_msg("unpack: %s", output);
    assert_int_equal(left_over(), 0);
}

static void no_output_is_an_input(void **state)
{
    static const char *const spellings[] = {"", "./maps/../", "hard", "soft"};
    (void)state;
    sh("\"$GTX\" cook t.obj -q -o x.gtx; cp g.png x.png");
    for (int i = 0; i < OUTPUTS; ++i)
        for (int k = 0; k < 4 && outputs[i].inputs[k]; ++k)
            for (int s = k ? (i + k) % 4 : 0; s < (k ? (i + k) % 4 + 1 : 4); ++s) {
                char input[64], path[128];
                const bool is_link = s >= 2;
                snprintf(input, sizeof input, "%s", outputs[i].inputs[k]);
                snprintf(path, sizeof path, "%s%s", spellings[s], is_link ? "" : input);
                sh("rm -f hard soft before; cp %s before; ln %s hard; ln -s %s soft", input,
                      input, input);
                if (makes(i, "", path, 1))
                    expect_text("error[usage]");
                same_file(input, "before");
            }
    expect(gtx("view a.gtx --screenshot ./a.gtx"), 1);
    expect(gtx("view --drop a.gtx --screenshot a.gtx"), 1);
    expect(gtx("cook t.obj -q -o new.gtx --report ./new.gtx"), 1); /* neither exists */
    assert_false(exists("new.gtx"));
    assert_int_equal(left_over(), 0);
}

static void names_may_be_long_and_folders_closed(void **state)
{
    char name[256];
    (void)state;
    sh("mkdir folder");
    memset(name, 'n', 255);
    name[255] = 0;
    for (int i = 0; i < OUTPUTS; ++i) {
        makes(i, "", name, 0);
        if (makes(i, "", "nowhere/a", 2))
            expect_text("nowhere/a: No such file or directory");
        if (i > 0 && makes(i, "", "folder", 2)) /* a folder takes what cook makes of models */
            expect_text("folder: Is a directory");
    }
    assert_int_equal(left_over(), 0);
}

static void standard_output_goes_on(void **state)
{
    (void)state;
    if (access("/proc/self/fd/1", F_OK))
        skip();
    assert_int_equal(sh("ln -s /proc/self/fd/1 stdout; echo head >log; "
                           "\"$GTX\" cook t.obj -q -o stdout >>log"), 0);
    assert_int_equal(sh("test -h stdout && { echo head; cat a.gtx; } | cmp - log"), 0);
}

static void one_of_two_cooks_wins(void **state)
{
    (void)state;
    for (int i = 0; i < 6; ++i) {
        assert_int_equal(sh("\"$GTX\" cook t.obj -q -o two.gtx & "
                               "\"$GTX\" cook sphere.obj -q -o two.gtx; code=$?; wait $! && "
                               "(exit $code)"), 0);
        assert_int_equal(sh("cmp two.gtx a.gtx || cmp two.gtx sphere.gtx"), 0);
    }
    assert_int_equal(left_over(), 0);
}

/* The folder that is there stays, with its permissions and the links to it. */
static void unpacking_fills_a_folder(void **state)
{
    (void)state;
    assert_int_equal(sh("mkdir -m 700 empty; ln -s empty way; \"$GTX\" unpack a.gtx way"), 0);
    assert_int_equal(sh("test -h way && test \"$(stat -c %%a empty)\" = 700"), 0);
    assert_int_equal(sh("\"$GTX\" pack empty -o b.gtx && cmp a.gtx b.gtx"), 0);
    assert_int_equal(sh("mkdir here; cd here; \"$GTX\" unpack ../a.gtx . && test -e asset.json"),
                     0);
    assert_int_equal(sh("\"$GTX\" pack here -o here/b.gtx"), 0); /* beside what is read */
    assert_int_equal(sh("\"$GTX\" unpack a.gtx a.gtx"), 2);
    assert_int_equal(sh("test -z \"$(find . -name '.gtx-*')\""), 0);
}

static int prepare(void **state)
{
    static const char model[] = "mtllib t.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                "vt 0 0\nf 1/1 3/1 2/1\nf 1/1 2/1 4/1\nf 2/1 3/1 4/1\n"
                                "f 1/1 4/1 3/1\n";
    static const char library[] = "newmtl m\nmap_Kd t.png\n";
    uint8_t pixels[8 * 8];
    if (set_up(state))
        return 1;
    for (size_t i = 0; i < sizeof pixels; ++i)
        pixels[i] = (uint8_t)(37 * i);
    write_file("t.obj", model, sizeof model - 1);
    write_file("t.mtl", library, sizeof library - 1);
    return gtx_image_write_png(in_folder("t.png"), 8, 8, 1, pixels, NULL) ||
           gtx_image_write_png(in_folder("g.png"), 8, 8, 1, pixels, NULL) ||
           gtx_image_write_png(in_folder("p.png"), 8, 8, 1, pixels, NULL) ||
           gtx("cook t.obj -q -o a.gtx") || gtx("unpack a.gtx maps");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(links_stay_links),
        cmocka_unit_test(what_is_no_file_is_written_to),
        cmocka_unit_test(a_full_disk_costs_nothing),
        cmocka_unit_test(no_output_is_an_input),
        cmocka_unit_test(names_may_be_long_and_folders_closed),
        cmocka_unit_test(standard_output_goes_on),
        cmocka_unit_test(one_of_two_cooks_wins),
        cmocka_unit_test(unpacking_fills_a_folder),
    };
    return cmocka_run_group_tests(tests, prepare, tear_down);
}
