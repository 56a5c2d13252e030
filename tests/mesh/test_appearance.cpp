/* What a point of a surface shows: vertex colours, factors, textures in every wrap and level, bent
 * normals, masks; and coordinates that are no numbers. */
#include "test_import.hpp"

#include "mesh/material/srgb.hpp"
#include "mesh/material/texture.hpp"

using gtx::Image;
using gtx::Material;
using gtx::SurfaceSample;
using gtx::Texels;
using gtx::Texture;
using gtx::Wrap;

/* The square from 0 to `side` in the xy plane, facing +z, as two triangles. Both sets of texture
 * coordinates run from 0 to 1 along x and, downwards, along y. */
static Mesh square(double side = 1)
{
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    const float uv[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    for (const auto &t : mesh.triangles)
        for (uint32_t v : t) {
            mesh.normals.push_back({0, 0, 1});
            for (auto &set : mesh.appearance.uv)
                set.push_back({uv[v][0], uv[v][1]});
        }
    mesh.appearance.materials.resize(1);
    mesh.appearance.material = {0, 0};
    return mesh;
}

static Material &material(Mesh &mesh)
{
    return mesh.appearance.materials[0];
}

static Texture add_image(Mesh &mesh, Image image)
{
    Texture texture;
    texture.image = uint32_t(mesh.appearance.images.size());
    mesh.appearance.images.push_back(std::move(image));
    return texture;
}

/* Of one colour. */
static Texture add_plain(Mesh &mesh, const Rgba8 &c, Texels kind = Texels::DATA)
{
    return add_image(mesh, gtx::make_image(1, 1, {c}, kind));
}

/* Where texture coordinates are (u, v), in the lower right triangle for u + v > 1. */
static SurfaceSample look(const Mesh &mesh, double u, double v, double footprint = 0)
{
    const bool lower = u + v >= 1; /* its corners: (0,1) (1,1) (1,0); else (0,1) (1,0) (0,0) */
    const float lower_weights[3] = {float(1 - u), float(u + v - 1), float(1 - v)};
    const float upper_weights[3] = {float(v), float(u), float(1 - u - v)};
    return gtx::sample_surface(mesh, lower ? 0 : 1, lower ? lower_weights : upper_weights,
                               footprint);
}

static void assert_values(const float *found, std::initializer_list<double> expected)
{
    size_t k = 0;
    for (double e : expected) {
        if (!(std::abs(found[k] - e) < 2e-3))
            fail_msg("value %zu is %g, not %g", k, found[k], e);
        ++k;
    }
}

static void assert_normal(const SurfaceSample &s, double x, double y, double z)
{
    const float n[] = {s.normal.x, s.normal.y, s.normal.z};
    assert_float_equal(gtx::length(s.normal), 1, 1e-5);
    if (gtx::length(Vec3d(s.normal) - gtx::normalize(Vec3d(x, y, z))) > 0.01)
        fail_msg("normal %g %g %g, not %g %g %g", n[0], n[1], n[2], x, y, z);
}

/* ---- without textures ---- */

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

/* ---- textures ---- */

static void test_wrap(void **)
{
    /* texels of red 0, 85, 170, 255 in a row; centres at 1/8, 3/8, 5/8, 7/8 */
    const Image image = gtx::make_image(4, 1, {{0, 0, 0, 0}, {85, 0, 0, 0}, {170, 0, 0, 0},
                                               {255, 0, 0, 0}}, Texels::DATA);
    static const struct {
        Wrap wrap;
        double u, value;
    } cases[] = {
        {Wrap::REPEAT, 0.375, 1 / 3.},   {Wrap::REPEAT, 0.5, 0.5},
        {Wrap::REPEAT, 0, 0.5},          {Wrap::REPEAT, 1, 0.5},
        {Wrap::REPEAT, -0.125, 1},       {Wrap::REPEAT, 7.375, 1 / 3.},
        {Wrap::MIRROR, 0, 0},            {Wrap::MIRROR, 1, 1},
        {Wrap::MIRROR, -0.375, 1 / 3.},  {Wrap::MIRROR, 1.375, 2 / 3.},
        {Wrap::MIRROR, 2.125, 0},        {Wrap::MIRROR, -1.375, 2 / 3.},
        {Wrap::CLAMP, -3, 0},            {Wrap::CLAMP, 1.5, 1},
        {Wrap::CLAMP, 0.25, 1 / 6.},     {Wrap::REPEAT, 1e300, 0.5},
        {Wrap::REPEAT, NAN, 0.5},        {Wrap::CLAMP, INFINITY, 0},
    };
    for (const auto &c : cases) {
        const Wrap wrap[2] = {c.wrap, Wrap::CLAMP};
        auto value = gtx::sample_image(image, wrap, c.u, 0.5, 0, Texels::DATA);
        if (std::abs(value[0] - c.value) > 1e-6)
            fail_msg("wrap %d at %g: %g, not %g", int(c.wrap), c.u, double(value[0]), c.value);
    }
    const Wrap wrap[2] = {Wrap::CLAMP, Wrap::CLAMP}; /* rows run down */
    const Image column = gtx::make_image(1, 2, {{9, 0, 0, 0}, {99, 0, 0, 0}}, Texels::DATA);
    auto low = gtx::sample_image(column, wrap, 0, 0.9, 0, Texels::DATA);
    assert_float_equal(low[0], 99 / 255., 1e-6);
}

static void test_levels(void **)
{
    /* black and white in turn are half the light: code 188, not 128 */
    std::vector<Rgba8> board;
    for (int i = 0; i < 64; ++i)
        board.push_back((i + i / 8) % 2 ? Rgba8{255, 255, 255, 255} : Rgba8{0, 0, 0, 0});
    const Image light = gtx::make_image(8, 8, board, Texels::COLOR);
    const Image data = gtx::make_image(8, 8, board, Texels::DATA);
    assert_int_equal(light.levels.size(), 4);
    for (size_t k = 1; k < 4; ++k) {
        assert_int_equal(light.levels[k].width, 8 >> k);
        assert_true(light.levels[k].texels[0] == (Rgba8{188, 188, 188, 128}));
        assert_true(data.levels[k].texels[0] == (Rgba8{128, 128, 128, 128}));
    }
    /* odd sizes lose nothing: the mean of all texels stays */
    std::vector<Rgba8> row;
    for (uint8_t i = 0; i < 7; ++i)
        row.push_back({uint8_t(30 * i), 0, 0, 0});
    const Image odd = gtx::make_image(7, 1, row, Texels::DATA);
    assert_int_equal(odd.levels.size(), 3);
    assert_int_equal(odd.levels[1].width, 3);
    assert_int_equal(odd.levels[2].height, 1);
    assert_in_range(odd.levels[2].texels[0].r, 89, 91);
    const std::vector<Rgba8> five(5, Rgba8{7, 7, 7, 7});
    const Image tall = gtx::make_image(1, 5, five, Texels::DATA);
    assert_int_equal(tall.levels.size(), 3);
    assert_true(tall.levels[2].texels[0] == (Rgba8{7, 7, 7, 7}));
}

/* 4 x 4 texels whose three levels are 0, 100 and 200. */
static Image leveled()
{
    Image image;
    for (uint32_t k = 0; k < 3; ++k) {
        uint8_t c = uint8_t(100 * k);
        std::vector<Rgba8> texels(16u >> 2 * k, Rgba8{c, c, c, c});
        image.levels.push_back({4u >> k, 4u >> k, texels});
    }
    return image;
}

static void test_footprint(void **)
{
    Mesh mesh = square(4); /* a texel is a unit */
    material(mesh).metal_rough_map = add_image(mesh, leveled());
    material(mesh).metallic = 1;
    auto level = [&](double footprint) {
        return look(mesh, 0.4, 0.4, footprint).metallic * 255 / 100;
    };
    assert_float_equal(level(0), 0, 1e-3);
    assert_float_equal(level(1), 0, 1e-3);
    assert_float_equal(level(2), 1, 1e-3);
    assert_float_equal(level(std::sqrt(8)), 1.5, 1e-3);
    assert_float_equal(level(4), 2, 1e-3);
    assert_float_equal(level(1e30), 2, 1e-3);
    Texture &t = material(mesh).metal_rough_map;
    t.transform[0] = t.transform[4] = 0.5f; /* the texels are twice as large */
    assert_float_equal(level(4), 1, 1e-3);
    for (auto &uv : mesh.appearance.uv[0])
        uv = {0.5f, 0.5f}; /* no texel is passed, at whatever size */
    assert_float_equal(level(1e30), 0, 1e-3);
}

static void test_color_texture(void **)
{
    Mesh mesh = square();
    material(mesh).color_map = add_plain(mesh, {188, 255, 0, 51}, Texels::COLOR);
    material(mesh).color[0] = 0.5f;
    mesh.colors.assign(6, Rgba8{255, 188, 255, 255});
    const double half = gtx::srgb_to_linear(188);
    assert_values(look(mesh, 0.3, 0.3).color, {0.5 * half, half, 0, 1});
    material(mesh).alpha_cutoff = 0.5f;
    SurfaceSample s = look(mesh, 0.3, 0.3);
    assert_values(&s.cut, {0.2 - 0.5});
    assert_true(gtx::appearance_needs(mesh).mask);
}

static void test_other_textures(void **)
{
    Mesh mesh = square();
    Material &m = material(mesh);
    m.metallic = 0.5f;
    m.roughness = 0.5f;
    m.metal_rough_map = add_plain(mesh, {9, 51, 102, 9});
    m.occlusion_map = add_plain(mesh, {51, 9, 9, 9});
    m.occlusion_strength = 0.5f;
    m.emission[0] = 10;
    m.emission[1] = 1;
    m.emission_map = add_plain(mesh, {188, 0, 255, 9}, Texels::COLOR);
    SurfaceSample s = look(mesh, 0.3, 0.3);
    assert_values(&s.roughness, {0.1});
    assert_values(&s.metallic, {0.2});
    assert_values(&s.occlusion, {1 + 0.5 * (0.2 - 1)});
    assert_values(s.emission, {10 * gtx::srgb_to_linear(188), 0, 0});
}

static void test_sets(void **)
{
    Mesh mesh = square();
    for (auto &uv : mesh.appearance.uv[1])
        uv = {0.875f, 0};
    Image image = gtx::make_image(4, 1, {{0, 0, 0, 0}, {0, 85, 0, 0}, {0, 170, 0, 0},
                                         {0, 255, 0, 0}}, Texels::DATA);
    Texture &t = material(mesh).metal_rough_map = add_image(mesh, image);
    SurfaceSample s = look(mesh, 0.375, 0.5);
    assert_values(&s.roughness, {1 / 3.});
    t.set = 1;
    s = look(mesh, 0.375, 0.5);
    assert_values(&s.roughness, {1});
    t.set = 0;
    const float turned[6] = {0, 1, 0.25f, 1, 0, 0}; /* u' = v + 1/4 */
    std::copy_n(turned, 6, t.transform);
    s = look(mesh, 0.1, 0.375);
    assert_values(&s.roughness, {2 / 3.});
}

/* ---- normals ---- */

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

/* ---- cleaning ---- */

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
        cmocka_unit_test(test_vertices),       cmocka_unit_test(test_factors),
        cmocka_unit_test(test_needs),          cmocka_unit_test(test_wrap),
        cmocka_unit_test(test_levels),         cmocka_unit_test(test_footprint),
        cmocka_unit_test(test_color_texture),  cmocka_unit_test(test_other_textures),
        cmocka_unit_test(test_sets),           cmocka_unit_test(test_normal_texture),
        cmocka_unit_test(test_tangents),       cmocka_unit_test(test_hostile),
        cmocka_unit_test(test_clean),          cmocka_unit_test(test_clean_drops_misfits),
    };
    return cmocka_run_group_tests_name("appearance", tests, nullptr, nullptr);
}
