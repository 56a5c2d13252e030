/* Real models: the counts that others measured, and files that must not bring the importer down. */
#include "test_import.hpp"

static void test_counts(void **)
{
    static const struct {
        const char *path;
        size_t vertices, triangles;
        bool normals, colors;
        size_t images;
    } known[] = {
        {"scans/bunny.ply", 35947, 69451, false, false, 0},
        {"scans/dragon_vrip_res2.ply.gz", 100250, 202520, false, false, 0},
        {"scans/armadillo_86k.obj.gz", 43243, 86482, false, false, 0},
        {"scans/gargo_3dhop.ply.gz", 25002, 50000, true, true, 0},
        {"scans/horse.ply.gz", 48485, 96966, true, false, 0},
        {"scans/ogre.obj.gz", 62194, 124008, false, false, 0},
        {"scans/rocker-arm.obj", 10044, 20088, false, false, 0},
        {"textured/spot/spot/spot_quadrangulated.obj", 2930, 5856, false, false, 0},
        {"draco/bunny_gltf.drc", 34834, 69451, true, false, 0},
        {"draco/dragon_810k_loop_q14.drc", 414356, 810080, false, false, 0},
        {"draco/test_nm.obj.edgebreaker.0.9.1.drc", 99, 170, true, false, 0},
        {"draco/test_nm.obj.sequential.cl3.2.2.drc", 97, 170, true, false, 0},
        {"nasty/gen_color_normal_uv_big_endian.ply", 642, 1280, true, true, 0},
        {"nasty/gen_tristrips.ply", 6, 4, false, false, 0},
        {"nasty/gen_ngon_concave.obj", 5, 3, false, false, 0},
        {"nasty/gen_quads_ngons_ascii.ply", 8, 7, false, false, 0},
        {"nasty/gen_negative_idx_colors_crlf.obj", 3, 1, false, true, 0},
        {"nasty/gen_instances_64_nodes.glb", 64 * 642, 64 * 1280, false, false, 0},
        {"gltf/dragon_draco_119k.glb", 59639, 119232, true, false, 0},
        {"gltf/2CylinderEngine.glb", 84657, 121496, true, false, 0}, /* 34 primitives in 82 nodes */
        {"gltf/BoxMetaDraco/glTF/BoxMetaDraco.gltf", 36, 12, true, false, 0},
        {"gltf/KhronosSampleModels/Duck/glTF_Binary/Duck.glb", 2399, 4212, true, false, 1},
        {"gltf/KhronosSampleModels/SimpleSparseAccessor/glTF/SimpleSparseAccessor.gltf", 14, 12,
         false, false, 0},
        {"gltf/BoxTextured_meshopt.glb", 24, 12, true, false, 1},
        {"gltf/dragon_202k_meshopt_quant.glb", 100207, 202520, false, false, 0},
        {"gltf/greySnapper_vertColor.glb", 1515, 2754, true, true, 3},
        {"textured/DamagedHelmet.glb", 14556, 15452, true, false, 5},
    };
    if (models().empty())
        skip();
    for (const auto &k : known) {
        Imported i = import_path(models() + "/" + k.path);
        print_message("# %s\n", k.path);
        assert_works(i, k.vertices, k.triangles);
        assert_int_equal(!i.mesh.normals.empty(), k.normals);
        assert_int_equal(!i.mesh.colors.empty(), k.colors);
        assert_int_equal(i.mesh.appearance.images.size(), k.images);
    }
}

/* A sphere in two files, one of them under a node with a negative scale: the same outside. */
static void test_orientation(void **)
{
    if (models().empty())
        skip();
    for (const char *path : {"/nasty/gen_sphere_ref.ply", "/nasty/gen_sphere_ref.glb",
                             "/nasty/gen_mirrored_negative_scale.glb"}) {
        Imported i = import_path(models() + path);
        assert_works(i, 642, 1280);
        double volume = 0;
        for (size_t t = 0; t < i.mesh.triangle_count(); ++t)
            volume += gtx::dot(i.mesh.position(t, 0), i.mesh.area_vector(t)) / 6;
        assert_true(volume > 0);
    }
}

static void test_unsupported(void **)
{
    if (models().empty())
        skip();
    std::string m = models();
    assert_fails(import_path(m + "/draco/pc_color.drc"), GTX_ERROR_UNSUPPORTED, "point cloud");
    assert_fails(import_path(m + "/nasty/gen_vertices_no_faces.ply"), GTX_ERROR_UNSUPPORTED,
                 "point cloud");
}

/* Whatever a file holds, it ends in a mesh with valid numbers or in one error with a sentence. */
static void test_malformed(void **)
{
    static const gtx_result allowed[] = {GTX_OK,          GTX_ERROR_READ,  GTX_ERROR_INPUT,
                                         GTX_ERROR_EMPTY, GTX_ERROR_LIMIT, GTX_ERROR_UNSUPPORTED};
    if (models().empty())
        skip();
    size_t files = 0, refused = 0;
    for (const char *folder : {"/malformed", "/nasty"})
        for (const auto &entry : std::filesystem::recursive_directory_iterator(models() + folder)) {
            if (!entry.is_regular_file())
                continue;
            Imported i = import_path(entry.path().string());
            assert_true(std::find(std::begin(allowed), std::end(allowed), i.result) !=
                        std::end(allowed));
            if (i.result == GTX_OK)
                assert_works(i, i.mesh.positions.size(), i.mesh.triangles.size());
            else
                assert_true(!i.message.empty() && i.message.size() < 240);
            ++files;
            refused += i.result != GTX_OK;
        }
    print_message("# %zu of %zu files refused\n", refused, files);
    assert_true(refused > files / 2 && refused < files);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_orientation),
        cmocka_unit_test(test_unsupported),
        cmocka_unit_test(test_malformed),
    };
    return cmocka_run_group_tests_name("import_models", tests, nullptr, nullptr);
}
