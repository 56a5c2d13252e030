/* Real and nasty models come out of cleaning with every promise kept. */
#include "test_clean.hpp"

#include <cstdlib>
#include <string>

static void skip_without_models(void)
{
    if (!std::getenv("GEOTEX_MODELS"))
        skip();
}

static Cleaned clean_file(const char *name)
{
    Task task(1, nullptr, nullptr);
    return clean(import_mesh(std::string(std::getenv("GEOTEX_MODELS")) + "/" + name, task));
}

static void test_watertight(void **)
{
    skip_without_models();
    for (const char *name :
         {"scans/armadillo_86k.obj.gz", "scans/horse.ply.gz", "scans/nefertiti.obj.gz",
          "nasty/gen_triangle_soup_dup_vertices.ply", "nasty/gen_coincident_spheres.ply",
          "nasty/gen_scale_1e-30.ply", "nasty/gen_duplicate_faces.ply",
          "nasty/gen_winding_random_half.ply"}) {
        Cleaned c = clean_file(name);
        assert_true(c.report.closed);
        assert_int_equal(c.report.components, 1);
        assert_true(volume(c.mesh) > 0);
    }
}

static void test_open(void **)
{
    skip_without_models();
    assert_int_equal(clean_file("scans/bunny.ply").report.boundary_edges, 223);
    assert_int_equal(clean_file("scans/face.obj.gz").report.boundary_edges, 96);
    Cleaned lion = clean_file("scans/oded_lionstatue.obj.gz");
    assert_int_equal(lion.report.boundary_edges, 322);
    assert_int_equal(lion.report.flipped, 2);
}

/* Thousands of edges with four triangles and flaps without thickness: the body stays one piece,
 * with a handful of slits, and all that is dropped is what is there twice. */
static void test_dirty(void **)
{
    skip_without_models();
    Cleaned c = clean_file("scans/dragon_vrip_res2.ply.gz");
    assert_int_equal(c.mesh.triangle_count(), 202520 - 1489);
    assert_int_equal(c.dropped("duplicate"), 1489);
    assert_int_equal(c.report.dropped.size(), 1);
    assert_true(c.report.nonmanifold_edges > 2000);
    auto neighbours = triangle_neighbours(c.mesh);
    UnionFind pieces(neighbours.size());
    std::map<size_t, std::pair<size_t, size_t>> sizes; /* of a piece: triangles, border edges */
    for (size_t t = 0; t < neighbours.size(); ++t)
        for (uint32_t n : neighbours[t])
            pieces.join(t, n == gtx::NO_TRIANGLE ? t : n);
    std::pair<size_t, size_t> body;
    for (size_t t = 0; t < neighbours.size(); ++t) {
        auto &size = sizes[pieces.find(t)];
        ++size.first;
        size.second += size_t(std::count(neighbours[t].begin(), neighbours[t].end(),
                                         gtx::NO_TRIANGLE));
        body = std::max(body, size);
    }
    assert_true(body.first > 199000);
    assert_true(body.second < 50);
}

static void test_nasty(void **)
{
    skip_without_models();
    for (const char *name : {"klein_bottle_figure8", "moebius", "nonmanifold_edge_fan16",
                             "nonmanifold_fins", "zero_area_slivers", "soup_jitter_1e-7",
                             "two_tris_bowtie_vertex", "flat_z0", "nan_vertices", "inf_vertices",
                             "nan_normals_nan_uv", "zero_normals", "offset_1e7_f32_quantised",
                             "offset_1e7_f64", "anisotropic_1e6_1_1e-6", "scale_1e38_overflow",
                             "nested_spheres_5_components", "2000_tiny_components"})
        clean_file((std::string("nasty/gen_") + name + ".ply").c_str());
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_watertight),
        cmocka_unit_test(test_open),
        cmocka_unit_test(test_dirty),
        cmocka_unit_test(test_nasty),
    };
    return cmocka_run_group_tests_name("clean models", tests, nullptr, nullptr);
}
