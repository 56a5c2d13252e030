/* Materials in the maps: textures, seams, what is averaged how. */
#include "bake/materials.hpp"

static void a_texture_is_seen(void **)
{
    HeightField field(3, 64);
    auto red = [](double x) { return uint8_t(200 * x + 20); };
    field.mesh.appearance.materials[0].color_map =
        field.paint(128, Texels::COLOR, [&](double x, double y) {
            return Rgba8{red(x), red(y), uint8_t(x > 0.5 ? 255 : 0), 255};
        });
    Maps maps = bake_with(field.mesh, field.partition);
    assert_true(maps.material.empty() && maps.emission.empty());
    each_texel(maps, [&](double x, double y, size_t at, bool coded) {
        if (!coded || std::fabs(x - 0.5) < 0.02)
            return;
        auto in = [](double s) { return std::clamp(s, 0., 1.); }; /* beyond, that of the border */
        const uint8_t *c = &maps.color[0][4 * at];
        assert_true(std::abs(c[0] - red(in(x))) <= 2 && std::abs(c[1] - red(in(y))) <= 2);
        assert_int_equal(c[2], x > 0.5 ? 255 : 0);
    });
}

/* The two halves of the height field lie apart in the texture, with another colour between: it
 * shows nowhere, however far the maps are dilated. */
static void a_gutter_does_not_bleed(void **)
{
    HeightField field(8, 64);
    Appearance &look = field.mesh.appearance;
    for (size_t t = 0; t < field.mesh.triangle_count(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            auto &uv = look.uv[0][3 * t + k];
            uv = {0.1f + 0.6f * uv[0], 0.1f + 0.8f * uv[1]};
            uv[0] += field.middle(t).x > 0.5 ? 0.2f : 0;
        }
    look.materials[0].color_map = field.paint(128, Texels::COLOR, [](double x, double y) {
        bool gutter = y < 0.07 || y > 0.93 || x < 0.07 || x > 0.93 || (x > 0.43 && x < 0.57);
        if (gutter)
            return Rgba8{0, 255, 0, 255};
        return x < 0.5 ? Rgba8{255, 0, 0, 255} : Rgba8{0, 0, 255, 255};
    });
    BakeOptions options;
    options.dilation = 12;
    Maps maps = bake_with(field.mesh, field.partition, options);
    int red = 0, blue = 0;
    each_texel(maps, [&](double x, double, size_t at, bool coded) {
        const uint8_t *c = &maps.color[0][4 * at];
        assert_int_equal(c[1], 0);
        red += coded && c[0] == 255 && c[2] == 0;
        blue += coded && c[2] == 255 && c[0] == 0;
        if (coded && std::fabs(x - 0.5) > 1e-3)
            assert_int_equal(c[0] > 0, x < 0.5);
    });
    assert_true(red > 1800 && blue > 1800);
    for (const auto &level : maps.color)
        for (size_t i = 1; i < level.size(); i += 4)
            assert_int_equal(level[i], 0);
}

/* Two materials side by side: each texel has its own triangle's, and the one texel of the last
 * level the mean. */
static void materials_and_emission_are_stored(void **)
{
    HeightField field(8, 64, 2);
    Appearance &look = field.mesh.appearance;
    for (size_t t = 0; t < field.mesh.triangle_count(); ++t)
        look.material[t] = field.middle(t).x > 0.5;
    look.materials[0].roughness = 0.2f;
    look.materials[0].metallic = 1;
    look.materials[1].unlit = true;
    look.materials[1].emission[0] = 4;
    look.materials[1].emission[1] = 2;
    BakeOptions options;
    options.mips = 8;
    Maps maps = bake_with(field.mesh, field.partition, options);
    assert_true(maps.color.empty());
    assert_true(maps.material.size() == 8 && maps.emission.size() == 8);
    assert_true(maps.emission_scale == 4);
    assert_int_equal(maps.emission[0].size() / 3, maps.material[0].size() / 4);
    const uint8_t left[4] = {255, 51, 255, 255}, right[4] = {255, 255, 0, 0};
    const uint8_t dark[3] = {0, 0, 0}, bright[3] = {255, 188, 0};
    each_texel(maps, [&](double x, double, size_t at, bool coded) {
        if (!coded || std::fabs(x - 0.5) < 1e-3)
            return;
        assert_memory_equal(&maps.material[0][4 * at], x < 0.5 ? left : right, 4);
        assert_memory_equal(&maps.emission[0][3 * at], x < 0.5 ? dark : bright, 3);
    });
    const uint8_t *m = maps.material[7].data(), *e = maps.emission[7].data();
    assert_true(std::abs(m[1] - 153) < 8 && std::abs(m[2] - 128) < 8); /* half of the codes */
    assert_true(std::abs(e[0] - 188) < 6);                             /* half of the light */
}

/* Straight on the left, 45 degrees towards u on the right. */
static void a_normal_texture_bends_the_normals(void **)
{
    HeightField field(4, 32);
    Material &m = field.mesh.appearance.materials[0];
    m.normal_map = field.paint(64, Texels::DATA, [](double x, double) {
        return Rgba8{uint8_t(x < 0.5 ? 128 : 218), 128, uint8_t(x < 0.5 ? 255 : 218), 255};
    });
    Maps maps = bake_with(field.mesh, field.partition);
    each_texel(maps, [&](double x, double, size_t at, bool coded) {
        float rows[3][3], n[3];
        if (!coded || std::fabs(x - 0.5) < 0.05)
            return;
        gtx_normal_frame(&maps.patches[0], rows);
        gtx_decode_normal(&maps.normal[0][2 * at], n);
        double along = 0;
        for (int k = 0; k < 3; ++k)
            along += n[k] * rows[k][0];
        assert_float_equal(along, x < 0.5 ? 0 : std::sqrt(0.5), 0.02);
    });
}

static void any_thread_count_gives_the_same_bytes(void **)
{
    HeightField field(8, 96);
    Material &m = field.mesh.appearance.materials[0];
    field.mask(100, [](double x, double y) { return std::sin(40 * x) * std::sin(30 * y) < 0.3; });
    m.emission[1] = 2;
    m.metallic = 0.5f;
    field.divide(96, [&](size_t t) { return int(t % 64) / 7; });
    Maps one = bake_with(field.mesh, field.partition);
    Maps many = bake_with(field.mesh, field.partition, {}, 5);
    assert_true(one.height == many.height && one.trim == many.trim);
    assert_true(one.normal == many.normal && one.color == many.color);
    assert_true(one.material == many.material && one.emission == many.emission);
}

static void materials_that_say_nothing_cost_nothing(void **)
{
    HeightField field(4, 32), bare(4, 32);
    bare.mesh.appearance = Appearance();
    Maps maps = bake_with(field.mesh, field.partition);
    Maps same = bake_with(bare.mesh, bare.partition);
    assert_true(maps.color.empty() && maps.material.empty() && maps.emission.empty());
    assert_true(maps.emission_scale == 0);
    assert_true(maps.normal == same.normal && maps.trim == same.trim && maps.height == same.height);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_texture_is_seen),
        cmocka_unit_test(a_gutter_does_not_bleed),
        cmocka_unit_test(materials_and_emission_are_stored),
        cmocka_unit_test(a_normal_texture_bends_the_normals),
        cmocka_unit_test(any_thread_count_gives_the_same_bytes),
        cmocka_unit_test(materials_that_say_nothing_cost_nothing),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
