/* Textures in every wrap and level, of colours and of numbers, by either set of coordinates. */
#include "test_appearance.hpp"

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
    gtx::Vector<Rgba8> board;
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
    gtx::Vector<Rgba8> row;
    for (uint8_t i = 0; i < 7; ++i)
        row.push_back({uint8_t(30 * i), 0, 0, 0});
    const Image odd = gtx::make_image(7, 1, row, Texels::DATA);
    assert_int_equal(odd.levels.size(), 3);
    assert_int_equal(odd.levels[1].width, 3);
    assert_int_equal(odd.levels[2].height, 1);
    assert_in_range(odd.levels[2].texels[0].r, 89, 91);
    const gtx::Vector<Rgba8> five(5, Rgba8{7, 7, 7, 7});
    const Image tall = gtx::make_image(1, 5, five, Texels::DATA);
    assert_int_equal(tall.levels.size(), 3);
    assert_true(tall.levels[2].texels[0] == (Rgba8{7, 7, 7, 7}));
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_wrap), cmocka_unit_test(test_levels),
        cmocka_unit_test(test_footprint), cmocka_unit_test(test_color_texture),
        cmocka_unit_test(test_other_textures), cmocka_unit_test(test_sets),
    };
    return cmocka_run_group_tests_name("texture", tests, nullptr, nullptr);
}
