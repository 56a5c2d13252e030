/* Which importer a file gets, gzip, cancelling, and the list of sources. */
#include "mesh/gzip.hpp"
#include "mesh/test_import.hpp"

static const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
static const std::string ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float "
                               "x\nproperty float y\nproperty float z\n"
                               "element face 1\nproperty list uchar int "
                               "vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 3 0 1 2\n";

static void test_kind(void **)
{
    assert_works(import_text("a.obj", obj), 3, 1);
    assert_works(import_text("A.OBJ", obj), 3, 1);
    assert_works(import_text("ply.obj", ply), 3, 1); /* content before name */
    assert_works(import_text("none", ply), 3, 1);
    assert_fails(import_text("none", obj), GTX_ERROR_UNSUPPORTED, "'none' is none of");
    assert_fails(import_text("a.fbx", "Kaydara\n"), GTX_ERROR_UNSUPPORTED, "'a.fbx' is none of");
    assert_fails(import_text("a.fbx", ""), GTX_ERROR_UNSUPPORTED, "none of");
    assert_fails(import_text("a.gltf", "hello"), GTX_ERROR_INPUT, "JSON");
    assert_fails(import_text("a.glb", "glTF"), GTX_ERROR_INPUT, "GLB");
    assert_fails(import_text("a.drc", ""), GTX_ERROR_INPUT, "Draco");
}

static void test_unreadable(void **)
{
    Folder folder;
    const auto refused = [&](const std::string &path, const char *why) {
        assert_fails(import_path(path), GTX_ERROR_READ, why);
    };
    refused((folder.path / "absent.obj").string(),
            "cannot open the file: No such file or directory");
    refused(folder.path.string(), "cannot read the file: Is a directory");
    refused("/proc/self/mem", "cannot read the file: Input/output error"); /* even as root */
}

static void test_gzip(void **)
{
    std::string packed = gzipped(obj);
    assert_works(import_text("a.obj.gz", packed), 3, 1);
    assert_works(import_text("a.obj", packed), 3, 1);
    assert_works(import_text("a.obj.gz", packed + "garbage"), 3, 1);
    assert_works(
        import_text("a.obj.gz", gzipped("v 0 0 0\nv 1 0 0\n") + gzipped("v 0 1 0\nf 1 2 3\n")), 3,
        1);
    assert_works(import_text("a.gz", gzipped(ply)), 3, 1);
    assert_fails(import_text("a.gz", packed), GTX_ERROR_UNSUPPORTED, "none of");
    for (size_t size = 2; size < packed.size(); ++size)
        assert_fails(import_text("a.obj.gz", packed.substr(0, size)), GTX_ERROR_INPUT, "gzip");
    packed[packed.size() - 5] ^= 1;
    assert_fails(import_text("a.obj.gz", packed), GTX_ERROR_INPUT, "damaged");

    std::string large = obj; /* more than one block on either side */
    for (uint32_t k = 0, seed = 1; k < 400000; ++k)
        large += "# " + std::to_string(seed = seed * 1664525 + 1013904223) + "\n";
    assert_works(import_text("a.obj.gz", gzipped(large + "f 3 2 1\n")), 3, 2);
}

static void test_cancel(void **)
{
    std::string text = "v 0 0 0\n";
    for (int k = 0; k < 200000; ++k)
        text += "f 1 1 1\n";
    Folder folder;
    int calls = 0;
    auto stop = [](const gtx_progress *, void *count) {
        return int(++*static_cast<int *>(count) > 2);
    };
    Task task(1, stop, &calls);
    try {
        gtx::import_mesh(folder.write("a.obj", text), task);
        fail_msg("not cancelled");
    } catch (const gtx::Error &e) {
        assert_int_equal(e.result, GTX_CANCELLED);
    }
    assert_int_equal(calls, 3);
}

static void test_sources(void **)
{
    Folder folder;
    std::string path = folder.write("a.obj", obj);
    Imported i = import_path(path);
    assert_int_equal(i.sources.size(), 1);
    assert_string_equal(i.sources[0].c_str(), path.c_str());
    Task task(1, nullptr, nullptr);
    assert_int_equal(gtx::import_mesh(path, task).triangle_count(), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kind),
        cmocka_unit_test(test_unreadable),
        cmocka_unit_test(test_gzip),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_sources),
    };
    return cmocka_run_group_tests_name("import_files", tests, nullptr, nullptr);
}
