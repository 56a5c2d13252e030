/* Textures that a model does not bring along, and exports of fewer bytes. */
#include "command.h"

#include <sys/stat.h>

/* One pixel, red: a TGA of 24 bits a pixel. */
static const unsigned char red[] = {0, 0, 2, 0, 0, 0, 0, 0,  0, 0, 0,
                                    0, 1, 0, 1, 0, 24, 0, 0, 0, 255};

static const char square[] = "v 0 0 0\nv 1 0 0\nv 1 1 0.2\nv 0 1 0\n"
                             "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
static const char face[] = "f 1/1 2/2 3/3 4/4\n";

static void write_square(const char *name, const char *material)
{
    char text[512];
    const int size = snprintf(text, sizeof text, "%s%s%s", material, square, face);
    write_file(name, text, (size_t)size);
}

static void a_model_without_one_takes_a_base_color(void **state)
{
    (void)state;
    write_square("plain.obj", "");
    write_file("red.tga", red, sizeof red);
    expect(gtx("cook plain.obj -o plain.gtx"), 0);
    expect_text("note[no-texture]");
    expect(gtx("info --json plain.gtx"), 0);
    expect_text("\"color\": false");
    expect(gtx("cook plain.obj -o red.gtx --base-color red.tga --depfile red.d"), 0);
    expect(gtx("info --json red.gtx"), 0);
    expect_text("\"color\": true");
    size_t size;
    char *sources = slurp("red.d", &size);
    sources[size] = 0;
    assert_non_null(strstr(sources, "red.tga"));
    free(sources);
    expect(gtx("compare red.gtx plain.obj --base-color red.tga --size 64 --levels 1"), 0);
    expect(gtx("compare red.gtx plain.obj --size 64 --levels 1"), 3); /* another model */
    expect(gtx("cook plain.obj -o none.gtx --base-color none.tga"), 2);
    assert_false(exists("none.gtx"));
}

static void textures_are_found_by_name(void **state)
{
    (void)state;
    static const char library[] = "newmtl a\nmap_Kd C:\\art\\crimson.tga\n";
    write_file("art.mtl", library, sizeof library - 1);
    write_square("art.obj", "mtllib art.mtl\nusemtl a\n");
    assert_int_equal(mkdir(in_folder("textures"), 0700), 0);
    write_file("textures/crimson.tga", red, sizeof red);
    expect(gtx("cook art.obj -o art.gtx"), 0);
    expect_text("warning[unread-image]");
    expect(gtx("cook art.obj -o art.gtx --texture-dir textures --strict "
               "--allow few-triangles"), 0);
    expect(gtx("info --json art.gtx"), 0);
    expect_text("\"color\": true");
    expect(gtx("compare art.gtx art.obj --texture-dir textures --size 64 --levels 1"), 0);
}

static void exports_are_compressed(void **state)
{
    (void)state;
    expect(gtx("export sphere.gtx -o plain.glb --collision"), 0);
    expect(gtx("export sphere.gtx -o small.glb --collision --compress meshopt"), 0);
    size_t plain, small;
    free(slurp("plain.glb", &plain));
    free(slurp("small.glb", &small));
    assert_true(2 * small < plain);
    expect(gtx("cook small.glb -o small.gtx"), 0);
    expect(gtx("export sphere.gtx -o none.glb --compress zip"), 1);
    assert_false(exists("none.glb"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_model_without_one_takes_a_base_color),
        cmocka_unit_test(textures_are_found_by_name),
        cmocka_unit_test(exports_are_compressed),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
