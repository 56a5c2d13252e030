/* Material libraries of OBJ models: colours, textures, and what is only warned of. */
#include "test_import.hpp"

#include "image/image.h"

#include <cmath>

/* Writes a PNG of 4 bytes a texel beside the model. */
static void write_png(const Folder &folder, const char *name, uint32_t width, uint32_t height,
                      const gtx::Vector<uint8_t> &texels)
{
    const std::string path = (folder.path / name).string();
    if (gtx_image_write_png(path.c_str(), width, height, 4, texels.data(), nullptr))
        fail_msg("%s cannot be written", path.c_str());
}

static const char square[] = "mtllib my lib.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                             "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                             "usemtl one\nf 1/1 2/2 3/3\nusemtl two\nf 1/1 3/3 4/4\n";

static Imported import_square(const Folder &folder, const std::string &library)
{
    folder.write("my lib.mtl", library);
    return import_path(folder.write("a.obj", square));
}

static void colours_and_factors(void **)
{
    Folder folder;
    Imported i = import_square(folder, "# comment\nnewmtl two\r\nKd 0.5 0.25 2\nd 1\n\tNs 10\n"
                                       "newmtl one\nKd .1\nPr 0.3\nPm 1\nKe 2 0 0\nillum 2\n"
                                       "newmtl two\nKd 0 0 0\n");
    assert_works(i, 4, 2);
    const gtx::Appearance &look = i.mesh.appearance;
    assert_int_equal(look.materials.size(), 2);
    const gtx::Material &one = look.materials[look.material[0]];
    const gtx::Material &two = look.materials[look.material[1]];
    assert_true(one.color[0] == 0.1f && one.color[2] == 0.1f && one.metallic == 1);
    assert_true(one.roughness == 0.3f && one.emission[0] == 2 && one.emission[1] == 0);
    assert_true(two.color[0] == 0.5f && two.color[1] == 0.25f && two.color[2] == 1);
    assert_true(two.roughness == 1 && two.emission[0] == 0);
    assert_int_equal(i.warnings.size(), 1);
    assert_true(i.warns("has texture coordinates, but names no texture"));
    assert_true(look.uv[0].empty()); /* nothing looks at them */
    assert_int_equal(i.sources.size(), 2);
}

/* An image of four colours: red and green above, blue and white below. */
static void the_image_stands_upright(void **)
{
    Folder folder;
    write_png(folder, "a b.png", 2, 2, {255, 0, 0, 255, 0, 255, 0, 255,
                                               0, 0, 255, 255, 255, 255, 255, 255});
    Imported i = import_square(folder, "newmtl one\nmap_Kd a b.png\nnewmtl two\nmap_Kd a b.png\n");
    assert_works(i, 4, 2);
    assert_true(i.warnings.empty());
    assert_int_equal(i.mesh.appearance.images.size(), 1);
    gtx::Mesh mesh = i.mesh;
    mesh.normals.assign(6, Vec3f(0, 0, 1));
    const float bottom[3] = {0.75f, 0, 0.25f}; /* at (0.25, 0.25): blue */
    gtx::SurfaceSample s = gtx::sample_surface(mesh, 0, bottom, 1e-6);
    assert_true(s.color[2] > 0.9f && s.color[0] < 0.1f);
    const float top[3] = {0.25f, 0.25f, 0.5f}; /* at (0.25, 0.75): red */
    s = gtx::sample_surface(mesh, 1, top, 1e-6);
    assert_true(s.color[0] > 0.9f && s.color[2] < 0.1f);
}

static void options_stand_before_the_name(void **)
{
    Folder folder;
    write_png(folder, "t.png", 1, 1, {9, 9, 9, 255});
    Imported i = import_square(folder, "newmtl one\nmap_Kd -clamp on -s 2 3 -o 0.5 0.25 0 -bm 1 "
                                       "t.png\n"
                                       "newmtl two\nmap_Kd -strange t.png\nKd 1 1 1\n");
    assert_works(i, 4, 2);
    const gtx::Appearance &look = i.mesh.appearance;
    const gtx::Texture &t = look.materials[look.material[0]].color_map;
    assert_true(t.used() && t.wrap[0] == gtx::Wrap::CLAMP);
    assert_true(t.transform[0] == 2 && t.transform[2] == 0.5f);
    /* The bottom, v = 0 of the file, looks at 0.25 of it: at 0.75 from the top. */
    assert_true(std::fabs(t.transform[4] * 1 + t.transform[5] - 0.75f) < 1e-6);
    assert_false(look.materials[look.material[1]].color_map.used());
    assert_true(i.warns("MTL statements were ignored: map_Kd"));
}

static void what_is_missing_is_a_warning(void **)
{
    Folder folder;
    Imported i = import_path(folder.write("b.obj", square));
    assert_works(i, 4, 2);
    assert_true(i.warns("material library 'my lib.mtl' was not found"));
    i = import_square(folder, "Kd 1 1 1\nnewmtl one\nmap_Kd no.png\nmap_bump x.png\nd 0.5\nKd\n");
    assert_works(i, 4, 2);
    assert_true(i.warns("image 'no.png' was ignored"));
    assert_true(i.warns("image 'x.png' was ignored"));
    assert_true(i.warns("MTL statements were ignored: d, Kd"));
    i = import_square(folder, "newmtl one\nmap_Kd ../secret.png\n");
    assert_true(i.warns("it is not a file in the model's folder"));
    i = import_path(folder.write("c.obj", edited(square, "my lib.mtl", "../../etc/passwd")));
    assert_works(i, 4, 2);
    assert_int_equal(i.sources.size(), 1);
    assert_true(i.warns("was not found"));
}

static void coordinates_that_are_not_there(void **)
{
    Folder folder;
    write_png(folder, "t.png", 1, 1, {9, 9, 9, 255});
    folder.write("my lib.mtl", "newmtl one\nmap_Kd t.png\n");
    Imported i = import_path(folder.write(
        "a.obj", "mtllib my lib.mtl\nusemtl one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0.5 0.5\n"
                 "f 1/1 2/7 3/-9\nf 1 2 3\nf 3//  2// 1//\n"));
    assert_works(i, 3, 3);
    assert_int_equal(i.mesh.appearance.uv[0].size(), 9);
    assert_true(i.warns("2 corners name texture coordinates that are not there"));
}

/* The square's first triangle, at its middle. */
static gtx::SurfaceSample middle_of(const Imported &i)
{
    gtx::Mesh mesh = i.mesh;
    mesh.normals.assign(6, Vec3f(0, 0, 1));
    const float middle[3] = {1 / 3.f, 1 / 3.f, 1 / 3.f};
    return gtx::sample_surface(mesh, 0, middle, 1e-6);
}

static void bump_maps_hold_heights_or_normals(void **)
{
    Folder folder;
    gtx::Vector<uint8_t> ramp; /* higher to the right, 4 codes a texel: a slope of 8 * 4 / 255 */
    for (int i = 0; i < 64 * 2; ++i)
        for (int c = 0; c < 4; ++c)
            ramp.push_back(c == 3 ? 255 : uint8_t(4 * (i % 64)));
    write_png(folder, "ramp.png", 64, 2, ramp);
    write_png(folder, "bent.png", 1, 1, {218, 128, 218, 255});
    for (double scale : {1., 2.}) {
        Imported i = import_square(folder, "newmtl one\nmap_Bump -bm " + std::to_string(scale) +
                                               " ramp.png\n");
        const Vec3f n = middle_of(i).normal;
        assert_true(std::fabs(-n.x / n.z - scale * 8 * 4 / 255) < 0.02 && std::fabs(n.y) < 0.01);
    }
    assert_true(middle_of(import_square(folder, "newmtl one\nbump bent.png\n")).normal.x > 0.69f);
    /* `norm` says more than `bump`, in whatever order. */
    for (const char *maps : {"norm bent.png\nbump ramp.png\n", "bump ramp.png\nnorm bent.png\n"}) {
        Imported i = import_square(folder, std::string("newmtl one\n") + maps);
        assert_true(middle_of(i).normal.x > 0.69f && i.warnings.empty());
    }
}

static void maps_of_one_number(void **)
{
    Folder folder;
    write_png(folder, "half.png", 1, 1, {128, 64, 0, 255});
    write_png(folder, "hole.png", 1, 1, {255, 255, 255, 40});
    gtx::SurfaceSample s = middle_of(import_square(
        folder, "newmtl one\nmap_Pr half.png\nmap_Pm -imfchan g half.png\nmap_d hole.png\n"));
    assert_true(std::fabs(s.roughness - 0.5f) < 0.01 && std::fabs(s.metallic - 0.25f) < 0.01);
    assert_true(s.cut < -0.3f);
    assert_true(middle_of(import_square(folder, "newmtl one\nmap_d half.png\n")).cut > 0);
    /* Nothing shines, and nothing is cut, by an image that is not there. */
    s = middle_of(import_square(folder, "newmtl one\nmap_Pm no.png\nmap_d no.png\n"));
    assert_true(s.metallic == 0 && s.cut == 1);
}

static void targa_is_read(void **)
{
    Folder folder;
    std::string file("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\0", 18);
    folder.write("a.tga", file + "\x10\x20\xff"); /* blue, green, red */
    Imported i = import_square(folder, "newmtl one\nmap_Kd a.tga\n");
    assert_true(i.warnings.empty() && middle_of(i).color[0] > 0.99f);
    folder.write("a.tga", file + "\x10");
    assert_true(import_square(folder, "newmtl one\nmap_Kd a.tga\n").warns("was ignored"));
}

/* Beside the model whatever path is named; elsewhere in a folder that is given, nowhere else. */
static void textures_are_found_by_name(void **)
{
    Folder folder, other;
    write_png(folder, "t.png", 1, 1, {255, 0, 0, 255});
    for (const char *name : {"../maps/t.png", "C:\\art\\t.png", "/art/t.png", "t.png"}) {
        Imported i = import_square(folder, std::string("newmtl one\nmap_Kd ") + name + "\n");
        assert_true(i.warnings.empty() && middle_of(i).color[1] == 0);
        assert_int_equal(i.sources.size(), 3);
    }
    write_png(other, "o.png", 1, 1, {0, 255, 0, 255});
    const std::string library = "newmtl one\nmap_Kd " + (other.path / "o.png").string() + "\n";
    Imported i = import_square(folder, library);
    assert_true(i.warns("it is not a file in the model's folder"));
    gtx::Task task(1, nullptr, nullptr);
    gtx::ModelFile file = gtx::read_model((folder.path / "a.obj").string(), task);
    file.textures.folder = other.path.string();
    i.mesh = gtx::import_model(file, task);
    assert_true(task.warnings.empty() && middle_of(i).color[0] == 0);
    bool foreseen = false;
    for (const std::string &path : gtx::referenced_files(file, task))
        foreseen |= path == (other.path / "o.png").string();
    assert_true(foreseen);
}

static void a_base_colour_is_given(void **)
{
    Folder folder;
    write_png(folder, "b.png", 1, 1, {255, 0, 0, 255});
    const std::string model = folder.write("a.obj", edited(square, "mtllib my lib.mtl", "# none"));
    assert_true(import_path(model).warns("has texture coordinates, but names no texture"));
    gtx::Task task(1, nullptr, nullptr);
    gtx::ModelFile file = gtx::read_model(model, task);
    file.textures.base_color = (folder.path / "b.png").string();
    Imported i;
    i.mesh = gtx::import_model(file, task);
    assert_true(task.warnings.empty() && middle_of(i).color[1] == 0);
    file.textures.base_color += ".no";
    try {
        gtx::import_model(file, task);
        fail_msg("a base colour that is not there was taken");
    } catch (const gtx::Error &e) {
        assert_int_equal(e.result, GTX_ERROR_READ);
    }
}

int main(void)
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(colours_and_factors),
        cmocka_unit_test(the_image_stands_upright),
        cmocka_unit_test(options_stand_before_the_name),
        cmocka_unit_test(what_is_missing_is_a_warning),
        cmocka_unit_test(coordinates_that_are_not_there),
        cmocka_unit_test(bump_maps_hold_heights_or_normals),
        cmocka_unit_test(maps_of_one_number),
        cmocka_unit_test(targa_is_read),
        cmocka_unit_test(textures_are_found_by_name),
        cmocka_unit_test(a_base_colour_is_given),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
