/* What a point of a surface shows: vertex colours, factors, bent normals, masks; coordinates that
 * are no numbers; and what cleaning keeps of it. */
#include "test_appearance.hpp"

static void assert_normal(const SurfaceSample &s, double x, double y, double z)
{
    const float n[] = {s.normal.x, s.normal.y, s.normal.z};
    assert_float_equal(gtx::length(s.normal), 1, 1e-5);
    if (gtx::length(Vec3d(s.normal) - gtx::normalize(Vec3d(x, y, z))) > 0.01)
        fail_msg("normal %g %g %g, not %g %g %g", n[0], n[1], n[2], x, y, z);
}

static void test_vertices(void **)
{
    Mesh mesh = square();
    mesh.appearance = {};
    SurfaceSample s = look(mesh, 0.5, 0.75);
    assert_values(s.color, {1, 1, 1, 1});
    assert_values(s.emission, {0, 0, 0});
    assert_true(s.occlusion == 1 && s.roughness == 1 && s.metallic == 0 && s.lit == 1);
    assert_true(s.cut >= 0);

    mesh.colors.assign(6, Rgba8{0, 0, 0, 0});
    mesh.colors[1] = {255, 188, 10, 255};
    s = look(mesh, 1, 1);
    assert_values(s.color, {1, gtx::srgb_to_linear(188), gtx::srgb_to_linear(10), 1});
    s = look(mesh, 0.75, 0.75); /* half of it: as light, not as codes */
    assert_values(s.color, {0.5, gtx::srgb_to_linear(188) / 2, gtx::srgb_to_linear(10) / 2, 0.5});

    mesh.normals[0] = {-1, 0, 0};
    mesh.normals[1] = {0, 0, 1};
    assert_normal(look(mesh, 0.5, 1), -1, 0, 1);
    mesh.normals[1] = {1, 0, 0};
    assert_normal(look(mesh, 0.5, 1), 0, 0, 1); /* they cancel out: the triangle's own */
}

static void test_factors(void **)
{
    Mesh mesh = square();
    Material &m = material(mesh);
    const float color[4] = {0.5f, 0.25f, 1, 0.5f}, emission[3] = {0, 2, 8};
    std::copy_n(color, 4, m.color);
    std::copy_n(emission, 3, m.emission);
    m.metallic = 0.5f;
    m.roughness = 0.25f;
    m.unlit = true;
    mesh.colors.assign(6, Rgba8{255, 255, 188, 128});
    SurfaceSample s = look(mesh, 0.5, 0.5);
    assert_values(s.color, {0.5, 0.25, gtx::srgb_to_linear(188), 1});
    assert_values(s.emission, {0, 2, 8});
    assert_values(&s.metallic, {0.5});
    assert_values(&s.roughness, {0.25});
    assert_values(&s.lit, {0});
    assert_true(s.cut >= 0); /* opaque, whatever its alpha */
    m.alpha_cutoff = 0.5f;
    s = look(mesh, 0.5, 0.5);
    assert_values(&s.cut, {0.5 * 128 / 255 - 0.5});
}

static void test_needs(void **)
{
    Mesh mesh = square();
    auto needs = [&] { return gtx::appearance_needs(mesh); };
    assert_false(needs().color || needs().material || needs().emission || needs().mask);
    assert_true(needs().emission_scale == 0);

    material(mesh).metallic = 1;
    material(mesh).emission[1] = 3;
    material(mesh).alpha_cutoff = 0.5f;
    assert_true(needs().material && needs().emission && needs().mask && !needs().color);
    assert_true(needs().emission_scale == 3);
    mesh.appearance.materials.push_back({});
    mesh.appearance.material = {1, 1}; /* nobody uses the first any more */
    assert_false(needs().color || needs().material || needs().emission || needs().mask);
    mesh.appearance.materials[1].color[2] = 0.5f;
    assert_true(needs().color);
    mesh.appearance = {};
    assert_false(needs().color);
    mesh.colors.resize(6);
    assert_true(needs().color && !needs().material);

    mesh = square();
    material(mesh).occlusion_map = add_plain(mesh, {});
    assert_true(needs().material && !needs().color);
    material(mesh) = {};
    material(mesh).unlit = true;
    assert_true(needs().material);
    material(mesh) = {};
    material(mesh).color_map.image = 0;
    assert_true(needs().color && !needs().material);
}

/* Green points up the image, against v. */
static void test_normal_texture(void **)
{
    Mesh mesh = square();
    material(mesh).normal_map = add_plain(mesh, {218, 128, 218, 9}); /* 45 degrees along u */
    assert_normal(look(mesh, 0.3, 0.3), 1, 0, 1);
    material(mesh).normal_map = add_plain(mesh, {128, 218, 218, 9}); /* up, which is +y here */
    assert_normal(look(mesh, 0.3, 0.3), 0, 1, 1);
    material(mesh).normal_scale = 0.5f;
    assert_normal(look(mesh, 0.3, 0.3), 0, 0.5, 1);
    material(mesh).normal_scale = 0;
    assert_normal(look(mesh, 0.3, 0.3), 0, 0, 1);
    material(mesh).normal_scale = 1;

    Mesh mirrored = mesh; /* u runs the other way: up stays up */
    for (auto &uv : mirrored.appearance.uv[0])
        uv[0] = 1 - uv[0];
    assert_normal(look(mirrored, 0.3, 0.3), 0, 1, 1);
    material(mirrored).normal_map = add_plain(mirrored, {218, 128, 218, 9});
    assert_normal(look(mirrored, 0.3, 0.3), -1, 0, 1);

    Mesh turned = mesh; /* by the transform: v' = u, u' = -v */
    const float rows[6] = {0, -1, 0, 1, 0, 0};
    std::copy_n(rows, 6, material(turned).normal_map.transform);
    assert_normal(look(turned, 0.3, 0.3), -1, 0, 1);
}

static void test_tangents(void **)
{
    Mesh mesh = square();
    mesh.appearance.tangents.assign(6, {0, 1, 0, 1}); /* n x t = -x */
    material(mesh).normal_map = add_plain(mesh, {218, 128, 218, 9});
    assert_normal(look(mesh, 0.3, 0.3), 0, 1, 1);
    material(mesh).normal_map = add_plain(mesh, {128, 218, 218, 9});
    assert_normal(look(mesh, 0.3, 0.3), -1, 0, 1);
    for (auto &t : mesh.appearance.tangents)
        t[3] = -1;
    assert_normal(look(mesh, 0.3, 0.3), 1, 0, 1);
    mesh.appearance.tangents.assign(6, {0, 0, 0, 0}); /* none given: from the coordinates */
    assert_normal(look(mesh, 0.3, 0.3), 0, 1, 1);
}

static void assert_finite(const SurfaceSample &s)
{
    assert_float_equal(gtx::length(s.normal), 1, 1e-4);
    for (float v : {s.color[0], s.color[3], s.emission[0], s.occlusion, s.roughness, s.cut})
        assert_true(std::isfinite(v));
}

static void test_hostile(void **)
{
    const float inf = INFINITY;
    const std::array<float, 2> coordinates[] = {{NAN, NAN}, {inf, -inf}, {3e38f, -3e38f}, {0, 0}};
    for (const auto &uv : coordinates) {
        Mesh mesh = square();
        Material &m = material(mesh);
        for (Texture Material::*map : gtx::MATERIAL_TEXTURES)
            m.*map = add_image(mesh, leveled());
        m.emission[0] = 1;
        m.alpha_cutoff = 0.5f;
        mesh.appearance.uv[0].assign(6, uv);
        for (double footprint : {0., 0.1, 1e300})
            assert_finite(look(mesh, 0.3, 0.3, footprint));
        mesh.appearance.uv[0][1] = {1, 0}; /* a line in the image */
        assert_finite(look(mesh, 0.3, 0.3, 0.1));
        mesh.appearance.tangents.assign(6, {NAN, inf, 0, 1});
        assert_finite(look(mesh, 0.3, 0.3, 0.1));
        mesh.appearance.tangents.assign(6, {0, 0, 1, 1}); /* along the normal */
        assert_finite(look(mesh, 0.3, 0.3, 0.1));
    }
}

/* The square again, doubled, with a sliver between, and one triangle wound against its normal. */
static void test_clean(void **)
{
    Mesh mesh = square();
    mesh.positions.push_back({0.5, 0, 0});
    mesh.triangles = {{0, 1, 4}, {0, 1, 2}, {0, 3, 2}, {0, 1, 2}};
    mesh.appearance.materials.resize(4);
    mesh.appearance.material = {0, 1, 2, 3};
    mesh.normals.clear();
    mesh.appearance.uv[0].clear();
    mesh.appearance.uv[1].clear();
    for (size_t c = 0; c < 12; ++c) {
        mesh.normals.push_back({0, 0, c / 3 == 2 ? -1.f : 1.f});
        mesh.appearance.uv[0].push_back({float(c), 0});
        mesh.appearance.uv[1].push_back({0, float(c)});
        mesh.appearance.tangents.push_back({1, 0, 0, 1});
    }
    Task task(1, nullptr, nullptr);
    gtx::CleanReport report;
    mesh = gtx::clean_mesh(std::move(mesh), task, report);
    assert_int_equal(mesh.triangle_count(), 2);
    const bool first_turned = mesh.normals[0].z < 0;
    const gtx::Appearance &look = mesh.appearance;
    assert_int_equal(look.material[0], 1);
    assert_int_equal(look.material[1], 2);
    assert_int_equal(look.uv[0].size(), 6);
    assert_int_equal(look.uv[1].size(), 6);
    for (size_t t = 0; t < 2; ++t) {
        const bool turned = t == (first_turned ? 0 : 1);
        const float first = t == 0 ? 3 : 6;
        const float order[2][3] = {{0, 1, 2}, {0, 2, 1}};
        for (size_t k = 0; k < 3; ++k) {
            const size_t c = 3 * t + k;
            assert_true(look.uv[0][c][0] == first + order[turned][k]);
            assert_true(look.uv[1][c][1] == first + order[turned][k]);
            assert_true(mesh.normals[c].z == mesh.normals[0].z);
            /* n x t times the sign points where it did: the texture did not move */
            assert_true(mesh.normals[c].z * look.tangents[c][3] == (t == 0 ? 1 : -1));
        }
    }
}

static void test_clean_drops_misfits(void **)
{
    Mesh mesh = square();
    material(mesh).color_map = add_plain(mesh, {});
    material(mesh).normal_map.image = 7; /* there is none */
    mesh.appearance.uv[0].pop_back();
    Task task(1, nullptr, nullptr);
    gtx::CleanReport report;
    Mesh clean = gtx::clean_mesh(mesh, task, report);
    assert_true(clean.appearance.uv[0].empty());
    assert_false(material(clean).color_map.used() || material(clean).normal_map.used());
    mesh.appearance.material[1] = 1; /* nor such a material */
    assert_true(gtx::clean_mesh(mesh, task, report).appearance.material.empty());
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_vertices), cmocka_unit_test(test_factors),
        cmocka_unit_test(test_needs), cmocka_unit_test(test_normal_texture),
        cmocka_unit_test(test_tangents), cmocka_unit_test(test_hostile),
        cmocka_unit_test(test_clean), cmocka_unit_test(test_clean_drops_misfits),
    };
    return cmocka_run_group_tests_name("appearance", tests, nullptr, nullptr);
}
