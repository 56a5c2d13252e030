/* gtx cook as a build step: streams, dependency files, progress, strictness, several models. */
#include "cli/command.h"

#include <time.h>
#include <unistd.h>
#include <utime.h>

static bool is_empty(void)
{
    return !output[0];
}

static void streams_carry_models_and_assets(void **state)
{
    (void)state;
    expect(gtx("cook sphere.obj -o a.gtx -q"), 0);
    expect(gtx("cook - --name any.obj -o b.gtx -q <sphere.obj"), 0);
    same_files("a.gtx", "b.gtx");
    expect(gtx("cook sphere.obj -q -o - >b.gtx"), 0);
    same_files("a.gtx", "b.gtx");
    expect(gtx("cook - --name any.obj -q -o - <sphere.obj | cat >b.gtx"), 0);
    same_files("a.gtx", "b.gtx");
    expect(gtx("cook sphere.obj -o - >b.gtx"), 0);
    expect_text("stdout: "); /* the summary is on stderr */
    same_files("a.gtx", "b.gtx");

    expect(gtx("cook - -o b.gtx <sphere.obj"), 5); /* no telling what it is */
    expect_text("stdin: error[unsupported]");
    expect(gtx("cook - --name a.obj -o - </dev/null >none"), 3);
    expect_text("stdin: error[empty]");
    size_t size;
    free(slurp("none", &size));
    assert_int_equal(size, 0); /* nothing is written before it is whole */
    expect(gtx("cook sphere.obj -o - >/dev/full"), 2);
    expect_text("stdout: error[write]");
    expect(gtx("cook sphere.obj - -o b.gtx"), 1);
    expect(gtx("cook sphere.obj -o - --depfile d"), 1);
    static const char *const densities[] = {"-1", "4.1", "nan", "inf", "fine", "''"};
    for (size_t i = 0; i < sizeof densities / sizeof *densities; ++i)
        expect(gtx("cook sphere.obj -o b.gtx --texel-density %s", densities[i]), 1);
    expect(gtx("cook sphere.obj -o c.gtx --texel-density 0"), 0);
    expect(gtx("cook sphere.obj -o c.gtx --texel-density 0.5"), 0);
    expect(gtx("cook sphere.obj -o b.gtx --adaptive"), 1);
    expect(gtx("cook sphere.obj -o b.gtx --partition vsa --adaptive"), 1);
    expect(gtx("cook sphere.obj -o c.gtx --partition pgp --adaptive"), 0);
    expect(gtx("cook sphere.obj -o c.gtx --partition layers --error 1e-3"), 0);
    expect(gtx("cook sphere.obj -o c.gtx --partition relief"), 0);
    expect(gtx("cook sphere.obj -o c.gtx --partition auto"), 0);
    expect(gtx("cook sphere.obj -o c.gtx --partition relief --error 1e-3"), 1);
    expect(gtx("validate c.gtx"), 0);
    expect(gtx("cook sphere.obj -o - --if-changed"), 1);
    expect(gtx("cook - --name a.obj -o b.gtx --if-changed <sphere.obj"), 1);
    same_files("a.gtx", "b.gtx");
}

static void blocks_are_kept_where_asked_for(void **state)
{
    static const char *const wrong[] = {"bc7", "normals", "bc,,etc2", "bc,bc", "''"};
    size_t plain, kept;
    (void)state;
    expect(gtx("cook sphere.obj -o a.gtx -q"), 0);
    expect(gtx("cook sphere.obj -o b.gtx -q --texture-format bc-small,normals,etc2"), 0);
    expect(gtx("validate b.gtx"), 0);
    free(slurp("a.gtx", &plain));
    free(slurp("b.gtx", &kept));
    assert_true(kept > plain);
    expect(gtx("cook sphere.obj -o b.gtx --if-changed --texture-format bc,normals"), 0);
    expect(gtx("cook sphere.obj -o c.gtx -q --texture-format normals,bc"), 0);
    same_files("b.gtx", "c.gtx"); /* another key */
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i)
        expect(gtx("cook sphere.obj -o c.gtx --texture-format %s", wrong[i]), 1);
}

static void a_dependency_file_names_every_source(void **state)
{
    static const char odd[] = "a b$c#d\\e.obj", library[] = "newmtl m\nKd 1 0 0\n";
    size_t size;
    (void)state;
    char *sphere = slurp("sphere.obj", &size), *with = malloc(size + 64);
    assert_non_null(with);
    size_t head = (size_t)sprintf(with, "mtllib lib rary.mtl\n");
    memcpy(with + head, sphere, size);
    write_file(odd, with, size + head);
    write_file("lib rary.mtl", library, sizeof library - 1);
    free(sphere);
    free(with);
    expect(gtx("cook 'a b$c#d\\e.obj' -q -o 'o t.gtx' --depfile 'o t.d'"), 0);
    char *text = slurp("o t.d", &size);
    text[size] = 0;
    assert_string_equal(text, "o\\ t.gtx: \\\n a\\ b$$c\\#d\\e.obj \\\n lib\\ rary.mtl\n"
                              "a\\ b$$c\\#d\\e.obj:\nlib\\ rary.mtl:\n");
    free(text);
    remove(in_folder("o t.d"));
    expect(gtx("cook none.obj -q -o a.gtx --depfile 'o t.d'"), 2);
    assert_false(exists("o t.d"));
    expect(gtx("cook 'a b$c#d\\e.obj' -q -o 'o t.gtx' --depfile 'o t.d' --if-changed"), 0);
    assert_true(exists("o t.d")); /* also where nothing was cooked */
    expect(gtx("cook sphere.obj -q -o a.gtx --depfile no/such/folder.d"), 2);
    expect_text("no/such/folder.d: error[write]");
}

static time_t changed(const char *name)
{
    struct stat info;
    assert_int_equal(stat(in_folder(name), &info), 0);
    return info.st_mtime;
}

static void unchanged_outputs_stay(void **state)
{
    (void)state;
    expect(gtx("cook sphere.obj -q -o a.gtx"), 0);
    const time_t before = 1000000000;
    assert_int_equal(utime(in_folder("a.gtx"), &(struct utimbuf){before, before}), 0);
    expect(gtx("cook sphere.obj -o a.gtx --if-changed --report a.json"), 0);
    expect_text("a.gtx: unchanged");
    assert_int_equal(changed("a.gtx"), before);
    size_t size;
    char *report = slurp("a.json", &size);
    report[size] = 0;
    assert_non_null(strstr(report, "\"unchanged\": true"));
    free(report);
    expect(gtx("cook sphere.obj -o a.gtx --if-changed --mips 3"), 0);
    assert_true(changed("a.gtx") != before);
    expect(gtx("cook --help"), 0);
    expect_text("stores a key");
}

static void strict_is_exit_3(void **state)
{
    static const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    static const char fan[] = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\n"
                              "f 1 2 3\nf 1 2 4\nf 1 2 5\n";
    (void)state;
    write_file("open.obj", text, sizeof text - 1);
    write_file("fan.obj", fan, sizeof fan - 1);
    write_file("kept.gtx", "precious", 8);
    expect(gtx("cook fan.obj -o kept.gtx --strict"), 3);
    expect_text("fan.obj: error[input]: 1 edge with more than two triangles: split (nonmanifold-");
    expect(gtx("cook fan.obj -o kept.gtx --strict --allow few-triangles"), 3);
    expect(gtx("cook fan.obj -o kept.gtx --strict --allow nonmanifold-edge"), 1);
    expect_text("there is no warning 'nonmanifold-edge' to allow");
    size_t size;
    char *kept = slurp("kept.gtx", &size);
    assert_int_equal(size, 8);
    free(kept);
    expect(gtx("cook sphere.obj -o a.gtx --strict"), 0);
    /* Turned to face outwards, which loses nothing. */
    char turn[512];
    snprintf(turn, sizeof turn, "cd %s && awk '/^f/ {printf \"f\"; for (i = NF; i > 1; --i) "
             "printf \" \" $i; print \"\"; next} {print}' sphere.obj >inner.obj", folder);
    assert_int_equal(system(turn), 0);
    expect(gtx("cook inner.obj -o a.gtx --strict"), 0);
    expect_text("inner.obj: note[inside-out]: ");
    expect(gtx("cook open.obj -o open.gtx"), 0);
    expect_text("open.obj: note[open-edges]: ");
    expect(gtx("cook fan.obj -o kept.gtx"), 0);
    expect_text("fan.obj: warning[nonmanifold-edges]: ");
    const char *allow = "--allow nonmanifold-edges,few-triangles,outline-loss,"
                        "empty-texels,unorientable";
    expect(gtx("cook fan.obj -o fan.gtx --strict --if-changed %s", allow), 0);
    expect(gtx("cook fan.obj -o fan.gtx --strict --if-changed %s", allow), 0);
    expect_text("fan.gtx: unchanged");
    expect(gtx("cook fan.obj -o fan.gtx --strict --if-changed"), 3);
}

static void progress_is_a_json_object_a_line(void **state)
{
    (void)state;
    expect(gtx("cook sphere.obj -o a.gtx --progress json"), 0);
    double last = 0;
    unsigned lines = 0;
    for (char *line = strtok(output, "\n"); line && *line == '{'; line = strtok(NULL, "\n")) {
        char stage[32], eta[32];
        double fraction, seconds;
        assert_int_equal(sscanf(line, "{\"stage\": \"%31[a-z]\", \"fraction\": %lf, "
                                      "\"seconds\": %lf, \"eta_seconds\": %31[0-9.nul]}",
                                stage, &fraction, &seconds, eta), 4);
        assert_true(fraction >= last && fraction <= 1 && seconds >= 0);
        assert_true(!strcmp(eta, "null") || atof(eta) >= 0);
        last = fraction;
        ++lines;
    }
    assert_true(lines >= 7 && lines < 200 && last > 0.9);
    expect(gtx("compare a.gtx sphere.obj --size 64 --levels 1 --progress json"), 0);
    expect_text("{\"stage\": \"measure\"");
    expect(gtx("cook sphere.obj -o a.gtx --progress dots"), 1);
    expect(gtx("cook sphere.obj -o a.gtx --progress json -q"), 0);
    assert_true(is_empty());
    expect(gtx("cook open.obj -o a.gtx -q"), 0); /* has warnings */
    assert_true(is_empty());
    expect(gtx("cook none.obj -o a.gtx -q"), 2); /* but an error is told */
    expect_text("none.obj: error[read]");
}

static void several_models_cook_together(void **state)
{
    (void)state;
    expect(gtx("cook sphere.obj open.obj -o both.gtx --up z --depfile both.d"), 0);
    expect(gtx("compare both.gtx sphere.obj open.obj --up z --size 128 --min-iou 0.95"), 0);
    size_t size;
    char *text = slurp("both.d", &size);
    text[size] = 0;
    assert_string_equal(text, "both.gtx: \\\n sphere.obj \\\n open.obj\nsphere.obj:\nopen.obj:\n");
    free(text);
    expect(gtx("cook sphere.obj none.obj -o both.gtx"), 2);
    expect_text("gtx cook: error[read]: none.obj: ");
    expect(gtx("cook - open.obj --name a.obj -o b.gtx <sphere.obj"), 0);
}

/* What `gtx info --json` says behind `"key": `. */
static double info(const char *asset, const char *key)
{
    char quoted[64];
    snprintf(quoted, sizeof quoted, "\"%s\": ", key);
    expect(gtx("info --json %s", asset), 0);
    expect_text(quoted);
    return atof(strstr(output, quoted) + strlen(quoted));
}

static void options_reach_the_asset(void **state)
{
    (void)state;
    expect(gtx("cook sphere.obj --output a.gtx --quiet"), 0);
    assert_true(is_empty());
    same_files("a.gtx", "sphere.gtx");
    expect(gtx("cook sphere.obj -o a.gtx --unit 0.25 --dilation 3 --charts-ply a.ply"), 0);
    assert_true(info("sphere.gtx", "unit") == 1 && info("a.gtx", "unit") == 0.25);
    size_t size;
    char faces[64], *ply = slurp("a.ply", &size);
    snprintf(faces, sizeof faces, "element face %.0f\n", info("a.gtx", "source_triangles"));
    ply[size] = 0;
    assert_non_null(strstr(ply, faces)); /* ends before the binary part */
    free(ply);
    expect(gtx("unpack a.gtx a"), 0);
    char *json = slurp("a/asset.json", &size);
    json[size] = 0;
    assert_non_null(strstr(json, "\"dilation\": 3,"));
    assert_null(strstr(json, "\"dilation\": 8,"));
    free(json);
}

static void an_error_is_kept_in_fewer_bytes(void **state)
{
    (void)state;
    expect(gtx("cook sphere.obj -o e.gtx --error 2e-3 --report e.json"), 0);
    size_t size;
    char *report = slurp("e.json", &size);
    report[size] = 0;
    const char *forward = strstr(report, "\"forward\": {");
    assert_non_null(strstr(report, "\"requested\": 0.002"));
    assert_non_null(forward);
    assert_true(atof(strstr(forward, "\"rms\": ") + strlen("\"rms\": ")) <= 2e-3);
    free(report);
    assert_true(info("e.gtx", "bytes") < 0.5 * info("sphere.gtx", "bytes"));
}

/* By the driver that there is, or with a line that there is none. */
static void a_gpu_may_extract_the_maps(void **state)
{
    (void)state;
    int code = gtx("cook sphere.obj -o gpu.gtx --extract gpu --report gpu.json");
    if (code == 5) {
        expect_text("sphere.obj: error[gl]: no OpenGL driver");
        print_message("skipped: %s", output);
        skip();
    }
    expect(code, 0);
    expect(gtx("cook sphere.obj -o gpu.gtx --extract hand"), 1);
    size_t size;
    char *text = slurp("gpu.json", &size);
    text[size] = 0;
    assert_non_null(strstr(text, "\"renderer\""));
    free(text);
}

/* Not that of whoever started the command. */
static void peak_memory_is_the_commands_own(void **state)
{
    const size_t large = (size_t)512 << 20;
    (void)state;
    char *memory = malloc(large);
    assert_non_null(memory);
    memset(memory, 1, large);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (chdir(folder) == 0 && freopen("stderr.txt", "w", stderr))
            execl(getenv("GTX"), "gtx", "cook", "sphere.obj", "-o", "a.gtx", "--report", "a.json",
                  (char *)NULL);
        _exit(99);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(memory[large / 2], 1);
    free(memory);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    size_t size;
    char *report = slurp("a.json", &size);
    report[size] = 0;
    const char *peak = strstr(report, "\"peak_rss_bytes\": ");
    assert_non_null(peak);
    double bytes = atof(strchr(peak, ':') + 1);
    free(report);
    if (strcmp(getenv("GTX_CONFIG") ? getenv("GTX_CONFIG") : "", "sanitize"))
        assert_true(bytes > 2e6 && bytes < 3e8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(streams_carry_models_and_assets),
        cmocka_unit_test(blocks_are_kept_where_asked_for),
        cmocka_unit_test(a_dependency_file_names_every_source),
        cmocka_unit_test(unchanged_outputs_stay),
        cmocka_unit_test(strict_is_exit_3),
        cmocka_unit_test(progress_is_a_json_object_a_line),
        cmocka_unit_test(several_models_cook_together),
        cmocka_unit_test(options_reach_the_asset),
        cmocka_unit_test(an_error_is_kept_in_fewer_bytes),
        cmocka_unit_test(a_gpu_may_extract_the_maps),
        cmocka_unit_test(peak_memory_is_the_commands_own),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
