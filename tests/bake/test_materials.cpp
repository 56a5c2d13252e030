/* Materials in the maps: textures, masks, seams, what is averaged how. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

#include "asset/asset.h"
#include "bake/shapes.hpp"
#include "mesh/material/texture.hpp"

#include <cstring>
#include <memory>

using namespace gtx;

static Maps bake_with(const Mesh &mesh, Partition partition, BakeOptions options = {},
                      unsigned threads = 1)
{
    Task task(threads, nullptr, nullptr, {"bake", "pack"});
    return bake(mesh, partition, options, task);
}

/* A flat height field over the unit square, seen from above in `resolution` texels; texture
 * coordinates are the square's. */
struct HeightField {
    Mesh mesh;
    Partition partition;

    HeightField(unsigned squares, unsigned resolution, size_t materials = 1)
    {
        mesh = shapes::field(squares, [](double u, double v) { return Vec3d(u, v, 0); });
        Appearance &look = mesh.appearance;
        look.materials.resize(materials);
        look.material.assign(mesh.triangle_count(), 0);
        for (const auto &triangle : mesh.triangles)
            for (uint32_t v : triangle)
                look.uv[0].push_back({float(mesh.positions[v].x), float(mesh.positions[v].y)});
        divide(resolution, shapes::all_in_one());
    }
    void divide(unsigned resolution, const std::function<int(size_t)> &key)
    {
        partition = shapes::split(mesh, key, resolution);
        for (Chart &chart : partition.charts)
            chart.frame = shapes::frame_along(mesh, chart.triangles, {0, 0, 1});
        partition.pitch = 1. / resolution;
    }
    Vec3d middle(size_t t) const
    {
        return (mesh.position(t, 0) + mesh.position(t, 1) + mesh.position(t, 2)) / 3;
    }
    /* A texture of size x size texels; texel(x, y) for x and y in 0..1. */
    Texture paint(uint32_t size, Texels kind, const std::function<Rgba8(double, double)> &texel)
    {
        std::vector<Rgba8> texels;
        for (uint32_t j = 0; j < size; ++j)
            for (uint32_t i = 0; i < size; ++i)
                texels.push_back(texel((i + 0.5) / size, (j + 0.5) / size));
        mesh.appearance.images.push_back(make_image(size, size, std::move(texels), kind));
        Texture texture;
        texture.image = uint32_t(mesh.appearance.images.size() - 1);
        texture.wrap[0] = texture.wrap[1] = Wrap::CLAMP;
        return texture;
    }
    /* Cuts away where there(x, y) is false, with colours to tell the two apart. */
    void mask(uint32_t size, const std::function<bool(double, double)> &there)
    {
        Material &m = mesh.appearance.materials[0];
        m.alpha_cutoff = 0.5f;
        m.color_map = paint(size, Texels::COLOR, [&](double x, double y) {
            return there(x, y) ? Rgba8{255, 0, 0, 255} : Rgba8{0, 255, 0, 0};
        });
    }
};

/* Calls visit(x, y, index of the texel in the maps, whether it has a code) for the texels of all
 * rectangles, at their places on the height field. */
template <class Visit> static void each_texel(const Maps &maps, Visit visit)
{
    for (const gtx_patch &p : maps.patches) {
        for (unsigned j = 0; j < p.rect[3]; ++j) {
            for (unsigned i = 0; i < p.rect[2]; ++i) {
                size_t at = (size_t(p.page) * maps.page_height + p.rect[1] + j) * maps.page_width +
                            p.rect[0] + i;
                double a = (i + 0.5) / p.rect[2] * p.extent_x;
                double b = (j + 0.5) / p.rect[3] * p.extent_y;
                double x = maps.anchor[0] + p.origin[0] + a * p.axis_x[0] + b * p.axis_y[0];
                double y = maps.anchor[1] + p.origin[1] + a * p.axis_x[1] + b * p.axis_y[1];
                visit(x, y, at, maps.height[at] != 0);
            }
        }
    }
}

/* Whether the height field is hit where a grid of side x side vertical rays meets the unit
 * square. */
static std::vector<bool> look_down(const Maps &maps, unsigned side)
{
    std::vector<const uint8_t *> levels;
    gtx_asset_desc desc = shapes::describe(maps, levels);
    gtx_asset *asset = nullptr;
    gtx_caster *caster = nullptr;
    gtx_error error = {};
    if (gtx_create(&desc, &asset, &error) || gtx_caster_create(asset, nullptr, &caster, &error))
        fail_msg("%s (rule %u)", error.message, error.rule);
    std::vector<gtx_ray> rays;
    for (unsigned j = 0; j < side; ++j)
        for (unsigned i = 0; i < side; ++i)
            rays.push_back({{float((i + 0.5) / side - maps.anchor[0]),
                             float((j + 0.5) / side - maps.anchor[1]), 1}, 0, {0, 0, -1}, 0});
    std::vector<gtx_hit> hits(rays.size());
    gtx_raycast(caster, rays.data(), hits.data(), rays.size(), 0);
    gtx_caster_destroy(caster);
    gtx_close(asset);
    std::vector<bool> seen;
    for (const gtx_hit &hit : hits)
        seen.push_back(hit.patch != UINT32_MAX);
    return seen;
}

/* Rays that see the height field where `off`, the distance to it in object units, is more than
 * `more`, or miss it where it is less than -`less`. */
static int wrong_rays(const Maps &maps, double less, double more,
                      const std::function<double(double, double)> &off)
{
    constexpr unsigned SIDE = 200;
    std::vector<bool> seen = look_down(maps, SIDE);
    int wrong = 0;
    for (unsigned j = 0; j < SIDE; ++j) {
        for (unsigned i = 0; i < SIDE; ++i) {
            double d = off((i + 0.5) / SIDE, (j + 0.5) / SIDE);
            wrong += seen[j * SIDE + i] ? d > more : d < -less;
        }
    }
    return wrong;
}

static double outside_of_disc(double x, double y)
{
    return 0.3 - std::hypot(x - 0.5, y - 0.5);
}

static void a_disc_is_cut_out(void **)
{
    for (uint32_t size : {32u, 256u}) { /* a coarse texture and a fine one */
        HeightField field(6, 64);
        field.mask(size, [](double x, double y) { return outside_of_disc(x, y) < 0; });
        Maps maps = bake_with(field.mesh, field.partition);
        double blur = size < 64 ? 0.5 / size : 0;
        assert_int_equal(wrong_rays(maps, 0.15 / 64 + blur, 0.15 / 64 + blur, outside_of_disc), 0);
        int empty = 0;
        each_texel(maps, [&](double x, double y, size_t at, bool coded) {
            double off = outside_of_disc(x, y);
            assert_true(off < 2. / 64 + blur || !coded); /* no cell that shows needs it */
            empty += off > 2. / 64 + blur && !coded;
            assert_true(!coded || maps.color[0][4 * at + 1] < 195); /* half of the light is 188 */
        });
        assert_true(empty > 800);
    }
}

static double outside_of_fence(double x, double y)
{
    auto bar = [](double s) {
        double at = s * 5 - std::floor(s * 5);
        return (std::fabs(at - 0.5) - 0.2) / 5;
    };
    return std::min(bar(x), bar(y));
}

/* Five by five bars of 0.08, which is five texels; cut into four charts right across the bars. */
static void a_fence_stays_open_across_charts(void **)
{
    HeightField field(8, 64);
    field.mask(512, [](double x, double y) { return outside_of_fence(x, y) < 0; });
    for (int charts : {1, 4}) {
        field.divide(64, [&](size_t t) {
            Vec3d m = field.middle(t);
            return charts == 1 ? 0 : 2 * (m.x > 0.5) + (m.y > 0.5);
        });
        Maps maps = bake_with(field.mesh, field.partition);
        assert_int_equal(maps.patches.size(), charts);
        /* Where two outlines cross, a corner is rounded. */
        assert_int_equal(wrong_rays(maps, 0.25 / 64, 0.5 / 64, outside_of_fence), 0);
    }
}

static void what_is_cut_away_whole_has_no_patch(void **)
{
    HeightField field(4, 32, 2);
    auto right = [&](size_t t) { return int(field.middle(t).x > 0.5); };
    for (size_t t = 0; t < field.mesh.triangle_count(); ++t)
        field.mesh.appearance.material[t] = uint32_t(right(t));
    Material &gone = field.mesh.appearance.materials[1];
    gone.color[3] = 0.2f;
    gone.alpha_cutoff = 0.5f;
    field.divide(32, right);
    Maps maps = bake_with(field.mesh, field.partition);
    assert_int_equal(maps.patches.size(), 1);
    assert_int_equal(wrong_rays(maps, 0.3 / 32, 0.6 / 32,
                                [](double x, double) { return x - 0.5; }), 0);

    std::fill(field.mesh.appearance.material.begin(), field.mesh.appearance.material.end(), 1u);
    gtx_result result = GTX_OK;
    try {
        bake_with(field.mesh, field.partition);
    } catch (const Error &error) {
        result = error.result;
    }
    assert_int_equal(result, GTX_ERROR_EMPTY);
}

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
        cmocka_unit_test(a_disc_is_cut_out),
        cmocka_unit_test(a_fence_stays_open_across_charts),
        cmocka_unit_test(what_is_cut_away_whole_has_no_patch),
        cmocka_unit_test(a_texture_is_seen),
        cmocka_unit_test(a_gutter_does_not_bleed),
        cmocka_unit_test(materials_and_emission_are_stored),
        cmocka_unit_test(a_normal_texture_bends_the_normals),
        cmocka_unit_test(any_thread_count_gives_the_same_bytes),
        cmocka_unit_test(materials_that_say_nothing_cost_nothing),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
