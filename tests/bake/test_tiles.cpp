/* Height grids in tiles: the same heights where tiles meet, fine steps inside, holes where nothing
 * is, and no way for a ray between two of them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "asset/patch.h"
#include "base/bytes.h"
#include "bake/lods.hpp"
#include "bake/tiles.hpp"

using namespace gtx;

/* Hills, steep in one corner; a hole with a ragged rim. */
static HeightGrid hills(uint32_t nx, uint32_t ny)
{
    HeightGrid grid;
    grid.nx = nx;
    grid.ny = ny;
    grid.step[0] = 7;
    grid.step[1] = 9;
    grid.origin[0] = 458000;
    grid.origin[1] = 5930000;
    grid.rotation = 30;
    for (uint32_t j = 0; j < ny; ++j)
        for (uint32_t i = 0; i < nx; ++i) {
            const double u = double(i) / nx, v = double(j) / ny;
            const double z = 40 * std::sin(9 * u) * std::cos(7 * v) + 300 * std::exp(-60 * u * v);
            const bool hole = std::hypot(u - 0.6, v - 0.5) < 0.1 + 0.02 * std::sin(40 * u);
            grid.values.push_back(hole ? NAN : float(z));
        }
    return grid;
}

struct Made {
    Maps maps;
    TileReport report;
};
static Made make(const HeightGrid &grid, TileOptions options = {}, unsigned threads = 2)
{
    Task task(threads, nullptr, nullptr, {"bake", "pack", "lod"}, {1, 1, 1});
    Made out;
    GridLayer layer{&grid, {}};
    layer.colors.assign(grid.count(), {200, 100, 50});
    out.maps = bake_tiles({layer}, options, out.report, task);
    return out;
}

/* Calls with each coded texel's node of the grid and its height as a reader has it, in double. */
template <class Body> static void for_texels(const HeightGrid &grid, const Maps &maps, Body body)
{
    const double turn = grid.rotation * std::acos(-1.0) / 180;
    for (const gtx_patch &p : maps.patches)
        for (int y = 0; y < p.rect[3]; ++y)
            for (int x = 0; x < p.rect[2]; ++x) {
                const size_t row = size_t(p.page) * maps.page_height + p.rect[1] + y;
                const size_t at = row * maps.page_width + p.rect[0] + x;
                const unsigned code = maps.height_bits == 8
                                          ? maps.height[at]
                                          : gtx_load_own_u16(&maps.height[2 * at]);
                if (!code)
                    continue;
                const double a = (x + 0.5) / p.rect[2] * p.extent_x;
                const double b = (y + 0.5) / p.rect[3] * p.extent_y;
                const double c = gtx_code_height(code, maps.height_bits) * p.extent_z;
                double at_point[3];
                for (int k = 0; k < 3; ++k)
                    at_point[k] = p.origin[k] + a * p.axis_x[k] + b * p.axis_y[k] +
                                  c * p.axis_z[k] + maps.anchor[k];
                const double dx = at_point[0] - grid.origin[0], dy = -at_point[2] - grid.origin[1];
                const double i = (std::cos(turn) * dx + std::sin(turn) * dy) / grid.step[0];
                const double j = (std::cos(turn) * dy - std::sin(turn) * dx) / grid.step[1];
                assert_true(std::fabs(i - std::round(i)) < 0.02);
                assert_true(std::fabs(j - std::round(j)) < 0.02);
                body(uint32_t(std::lround(i)), uint32_t(std::lround(j)), at_point[1],
                     gtx_height_step(&p, maps.height_bits));
            }
}

static void neighbours_have_the_same_heights(void **)
{
    const HeightGrid grid = hills(400, 300);
    for (unsigned bits : {8u, 16u}) {
        TileOptions options;
        options.bake.height_bits = bits;
        const Made made = make(grid, options);
        assert_int_equal(made.maps.patches.size(), 12);
        Vector<double> seen(grid.count(), NAN);
        size_t common = 0, nodes = 0;
        double most = 0, finest = INFINITY, coarsest = 0;
        for_texels(grid, made.maps, [&](uint32_t i, uint32_t j, double height, double step) {
            double &before = seen[size_t(j) * grid.nx + i];
            if (!std::isnan(before)) {
                assert_true(std::fabs(before - height) < 1e-4 * step + 1e-4);
                ++common;
            }
            before = height;
            most = std::max(most, std::fabs(height - grid.at(i, j)));
            finest = std::min(finest, step);
            coarsest = std::max(coarsest, step);
            ++nodes;
        });
        assert_true(common > 3000);
        for (size_t n = 0; n < seen.size(); ++n)
            assert_int_equal(std::isnan(seen[n]), std::isnan(grid.values[n]));
        assert_true(most <= coarsest / 2 + 1e-3 && made.report.max <= coarsest / 2 + 1e-9);
        assert_true(std::fabs(most - made.report.max) < 1e-3);
        assert_true(finest <= coarsest / 2); /* where it is flat steps are finer */
        assert_true(bits == 8 || made.report.max < 0.01);
        assert_int_equal(made.report.nodes, nodes - common);
    }
}

static gtx_asset *create(const Maps &maps)
{
    Vector<const uint8_t *> normals, colors;
    gtx_asset_desc desc = shapes::describe(maps, normals);
    for (const auto &level : maps.color)
        colors.push_back(level.data());
    desc.color = colors.data();
    gtx_asset *asset = nullptr;
    gtx_error error;
    if (gtx_create(&desc, &asset, &error))
        print_error("%s\n", error.message);
    assert_non_null(asset);
    return asset;
}

/* Rays straight and aslant through every border: each meets the surface, from above and below. */
static void no_ray_passes_between_tiles(void **)
{
    HeightGrid grid = hills(300, 300);
    for (float &value : grid.values)
        value = std::isnan(value) ? 0 : value;
    const Made made = make(grid);
    gtx_asset *asset = create(made.maps);
    for (uint32_t level : {0u, 2u}) {
        gtx_caster_desc desc = {};
        desc.level = level;
        gtx_caster *caster;
        assert_int_equal(gtx_caster_create(asset, &desc, &caster, nullptr), GTX_OK);
        for (int64_t n = 0; n < 40000; ++n) {
            const double i = 3 + 293 * (double(n * 7919 % 40009) / 40009);
            const double j = n % 2 ? 100 - 1 + 2 * (double(n * 31 % 1009) / 1009)
                                   : 3 + 293 * (double(n * 104729 % 40013) / 40013);
            const auto place = n % 4 < 2 ? grid.place(i, j) : grid.place(j, i);
            const double height = 20;
            gtx_ray ray = {};
            const double to[3] = {place[0] - made.maps.anchor[0], height - made.maps.anchor[1],
                                  -place[1] - made.maps.anchor[2]};
            const double from[3] = {0.2 * double(n % 7 - 3), n % 3 ? 1. : -1.,
                                    0.2 * double(n % 5 - 2)};
            for (int k = 0; k < 3; ++k) {
                ray.origin[k] = float(to[k] + 1000 * from[k]);
                ray.direction[k] = float(-from[k]);
            }
            /* Rays that leave the grid sideways before they reach it are no matter. */
            const double reach = 1000 * 0.8;
            if (i * 7 < reach || j * 7 < reach || (297 - i) * 7 < reach || (297 - j) * 7 < reach)
                for (int k : {0, 2}) {
                    ray.origin[k] = float(to[k]);
                    ray.direction[k] = 0;
                }
            gtx_hit hit;
            assert_int_equal(gtx_raycast(caster, &ray, &hit, 1, 0), GTX_OK);
            assert_true(std::isfinite(hit.t));
        }
        gtx_caster_destroy(caster);
    }
    gtx_close(asset);
}

/* The LOD mesh of the maps has one border around everything and one around the hole. */
static void the_lod_is_whole_across_tiles(void **)
{
    const HeightGrid grid = hills(300, 260);
    const Made made = make(grid);
    Task task(2, nullptr, nullptr, {"lod"}, {1});
    LodSource source = lod_source(made.maps, task);
    assert_int_equal(source.triangles.size(), made.report.triangles);
    LodLevel all;
    for (const auto &t : source.triangles)
        all.indices.insert(all.indices.end(), t.begin(), t.end());
    const lods::Edges edges = lods::count_edges(all);
    assert_int_equal(edges.crowded, 0);
    size_t rim = 0;
    auto cell = [&](int64_t i, int64_t j) {
        return i >= 0 && j >= 0 && i + 1 < grid.nx && j + 1 < grid.ny &&
               !std::isnan(grid.at(uint32_t(i), uint32_t(j)) +
                           grid.at(uint32_t(i + 1), uint32_t(j)) +
                           grid.at(uint32_t(i), uint32_t(j + 1)) +
                           grid.at(uint32_t(i + 1), uint32_t(j + 1)));
    };
    for (int64_t j = -1; j < int64_t(grid.ny); ++j)
        for (int64_t i = -1; i < int64_t(grid.nx); ++i)
            rim += (cell(i, j) != cell(i + 1, j)) + (cell(i, j) != cell(i, j + 1));
    assert_int_equal(edges.open, rim);
}

static void normals_follow_the_values(void **)
{
    HeightGrid grid;
    grid.nx = grid.ny = 200;
    grid.step[0] = grid.step[1] = 10;
    for (uint32_t j = 0; j < grid.ny; ++j)
        for (uint32_t i = 0; i < grid.nx; ++i)
            grid.values.push_back(float(3 * i + 1.0 * j)); /* rises to the east and north */
    const Made made = make(grid);
    gtx_asset *asset = create(made.maps);
    gtx_caster *caster;
    assert_int_equal(gtx_caster_create(asset, nullptr, &caster, nullptr), GTX_OK);
    gtx_ray ray = {{float(700 - made.maps.anchor[0]), 5000, float(-900 - made.maps.anchor[2])}, 0,
                   {0, -1, 0}, 0};
    gtx_hit hit;
    assert_int_equal(gtx_raycast(caster, &ray, &hit, 1, 0), GTX_OK);
    const double height = ray.origin[1] - hit.t + made.maps.anchor[1];
    assert_true(std::fabs(height - (210 + 90)) < 2);
    const Vec3d expected = normalize(Vec3d(-0.3, 1, 0.1));
    assert_true(hit.normal[0] * expected.x + hit.normal[1] * expected.y +
                    hit.normal[2] * expected.z > 0.999);
    gtx_caster_destroy(caster);
    gtx_close(asset);
}

static void bad_grids_are_refused(void **)
{
    HeightGrid empty = hills(40, 40), tiny = empty, flat = empty;
    empty.values.assign(empty.count(), NAN);
    tiny.nx = tiny.ny = 1;
    tiny.values = {1};
    flat.values.assign(flat.count(), 7);
    for (const HeightGrid *grid : {&empty, &tiny}) {
        gtx_result result = GTX_OK;
        try {
            make(*grid);
        } catch (const Error &e) {
            result = e.result;
        }
        assert_int_equal(result, grid == &empty ? GTX_ERROR_EMPTY : GTX_ERROR_INPUT);
    }
    const Made made = make(flat); /* all the same height is no fault */
    assert_true(made.report.max < 1e-3);
    gtx_close(create(made.maps));
}

static void any_thread_count_gives_the_same(void **)
{
    const HeightGrid grid = hills(300, 200);
    const Made one = make(grid, {}, 1), many = make(grid, {}, 5);
    assert_true(one.maps.height == many.maps.height && one.maps.normal == many.maps.normal);
    assert_true(one.maps.trim == many.maps.trim && one.maps.color == many.maps.color);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(neighbours_have_the_same_heights),
        cmocka_unit_test(no_ray_passes_between_tiles),
        cmocka_unit_test(the_lod_is_whole_across_tiles),
        cmocka_unit_test(normals_follow_the_values),
        cmocka_unit_test(bad_grids_are_refused),
        cmocka_unit_test(any_thread_count_gives_the_same),
    };
    return cmocka_run_group_tests_name("tiles", tests, nullptr, nullptr);
}
