/* What a model names many times is read once, and nothing in its text takes more than near-linear
 * time. */
#include "../common/hostile.hpp"
#include "test_import.hpp"

/* Ends the program where something takes forever: what is here takes a second. */
constexpr unsigned FOREVER = 60;

static const char triangle[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";

static void a_library_named_often_is_read_once(void **)
{
    Folder folder;
    folder.write("a.mtl", "newmtl a\nKd 0 1 0\n");
    std::string text = triangle;
    for (int i = 0; i < 1000; ++i)
        text += "mtllib a.mtl\nmtllib ./a.mtl\nmtllib .//./a.mtl\nmtllib none.mtl\n";
    Imported i = import_path(folder.write("a.obj", text));
    assert_works(i, 3, 1);
    assert_int_equal(i.sources.size(), 2);
    assert_int_equal(i.warnings.size(), 1); /* of the one that is not there */
    assert_true(i.mesh.appearance.materials[0].color[1] == 1);
}

static void an_image_named_often_is_read_once(void **)
{
    Folder folder;
    folder.write("t.png", "no image");
    std::string library, text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n";
    for (const char *name : {"t.png", "./t.png", ".//t.png", ".\\t.png"})
        for (int k = 0; k < 50; ++k) {
            const std::string material = name + std::to_string(k);
            library += "newmtl " + material + "\nmap_Kd " + name + "\n";
            text += "usemtl " + material + "\nf 1/1 2/1 3/1\n";
        }
    folder.write("a.mtl", library);
    Imported i = import_path(folder.write("a.obj", text));
    assert_int_equal(i.result, GTX_OK);
    assert_int_equal(i.sources.size(), 3);
    assert_int_equal(i.warnings.size(), 1);
}

static void references_are_listed_once(void **)
{
    Folder folder;
    std::string text = "mtllib b.mtl\nmtllib ./b.mtl\n", library;
    for (int k = 0; k < 40000; ++k) /* in two folders that are one, in two spellings */
        library += "map_Kd " + std::to_string(k) + ".png\nmap_Kd ./" + std::to_string(k) + ".png\n";
    folder.write("b.mtl", library);
    gtx::ModelFile file = {(folder.path / "a.obj").string(), gtx::Bytes(text), nullptr};
    Task task(1, nullptr, nullptr);
    assert_int_equal(gtx::referenced_files(file, task).size(), 40001);
}

static void names_of_any_length_name_no_file(void **)
{
    Folder folder;
    std::string name;
    for (int k = 0; k < 500000; ++k)
        name += "a/";
    gtx::ModelFile file = {(folder.path / "a.obj").string(), gtx::Bytes("mtllib x " + name),
                           nullptr};
    Task task(1, nullptr, nullptr);
    assert_int_equal(gtx::referenced_files(file, task).size(), 1);
}

static void names_are_found_among_many(void **)
{
    constexpr size_t MANY = 200000;
    Folder folder;
    std::string library, text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (size_t k = 0; k < MANY; ++k) {
        library += "newmtl m" + std::to_string(k) + "\n" + (k == MANY - 2 ? "Kd 0 1 0\n" : "");
        text += "usemtl m" + std::to_string(MANY - 1 - k) + "\nf 1 2 3\n";
    }
    folder.write("a.mtl", library);
    const std::string path = folder.write("a.obj", text);
    alarm(FOREVER);
    Imported i = import_path(path);
    alarm(0);
    assert_works(i, 3, MANY);
    const gtx::Appearance &look = i.mesh.appearance;
    assert_int_equal(look.materials.size(), MANY);
    assert_true(look.materials[look.material[1]].color[0] == 0);
    assert_true(look.materials[look.material[2]].color[0] == 1);
}

/* Without an ear that is found soon they are cut all the same, into as many triangles. */
static void polygons_without_ears_take_linear_time(void **)
{
    constexpr unsigned COUNT = 300, CORNERS = 500;
    Folder folder;
    const std::string path = folder.write("a.obj", hostile::polygons(COUNT, CORNERS));
    alarm(FOREVER);
    Imported i = import_path(path);
    alarm(0);
    assert_works(i, 512, COUNT * (CORNERS - 2));
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_library_named_often_is_read_once),
        cmocka_unit_test(an_image_named_often_is_read_once),
        cmocka_unit_test(references_are_listed_once),
        cmocka_unit_test(names_of_any_length_name_no_file),
        cmocka_unit_test(names_are_found_among_many),
        cmocka_unit_test(polygons_without_ears_take_linear_time),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
