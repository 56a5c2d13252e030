/* gtx_horizons and gtx_cook_lod_meshes: bad input ends in a sentence, good input in a valid
 * asset. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include <geotex/cook.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <vector>

struct Field {
    std::vector<float> values, property;
    gtx_height_grid grid = {};

    Field(uint32_t nx, uint32_t ny)
    {
        for (uint32_t j = 0; j < ny; ++j)
            for (uint32_t i = 0; i < nx; ++i) {
                values.push_back(float(20 * std::sin(0.05 * i) * std::cos(0.04 * j)));
                property.push_back(float(i));
            }
        grid.nx = nx;
        grid.ny = ny;
        grid.values = values.data();
        grid.property = property.data();
        grid.spacing[0] = grid.spacing[1] = 5;
    }
};

static gtx_result make(const gtx_height_grid *grids, uint32_t count, const gtx_horizons_desc *desc,
                       gtx_asset **asset = nullptr, gtx_horizons_result *result = nullptr)
{
    gtx_asset *own = nullptr;
    gtx_error error = {};
    gtx_result made = gtx_horizons(grids, count, desc, &own, result, &error);
    assert_int_equal(made == GTX_OK, own != nullptr);
    if (made)
        assert_true(std::strlen(error.message) > 8);
    if (asset)
        *asset = own;
    else
        gtx_close(own);
    return made;
}

static void bad_grids_have_a_clear_error(void **)
{
    Field good(40, 30), other(41, 30), tiny(1, 1), empty(40, 30), infinite(40, 30);
    for (float &v : empty.values)
        v = NAN;
    for (float &v : infinite.values)
        v = INFINITY;
    gtx_height_grid two[] = {good.grid, other.grid};
    assert_int_equal(make(&good.grid, 1, nullptr), GTX_OK);
    assert_int_equal(make(two, 2, nullptr), GTX_ERROR_INPUT);
    assert_int_equal(make(&tiny.grid, 1, nullptr), GTX_ERROR_INPUT);
    assert_int_equal(make(&empty.grid, 1, nullptr), GTX_ERROR_EMPTY);
    assert_int_equal(make(&infinite.grid, 1, nullptr), GTX_ERROR_EMPTY);
    assert_int_equal(make(&good.grid, 0, nullptr), GTX_ERROR_ARGUMENT);
    for (double spacing : {0., -1., double(NAN), 1e300}) {
        gtx_height_grid bad = good.grid;
        bad.spacing[1] = spacing;
        assert_int_equal(make(&bad, 1, nullptr), GTX_ERROR_ARGUMENT);
    }
    gtx_height_grid bad = good.grid;
    bad.values = nullptr;
    assert_int_equal(make(&bad, 1, nullptr), GTX_ERROR_ARGUMENT);
    bad = good.grid;
    bad.reserved[0] = 1;
    assert_int_equal(make(&bad, 1, nullptr), GTX_ERROR_NOT_ZEROED);
    for (uint32_t degrees : {1u, 2u}) {
        bad = good.grid;
        bad.in_degrees = degrees;
        assert_int_equal(make(&bad, 1, nullptr),
                         degrees == 1 ? GTX_ERROR_INPUT : GTX_ERROR_ARGUMENT);
    }
    bad = good.grid;
    bad.nx = bad.ny = 1u << 20;
    assert_int_equal(make(&bad, 1, nullptr), GTX_ERROR_LIMIT);
}

static void bad_options_are_refused(void **)
{
    Field good(40, 30);
    gtx_horizons_desc good_desc = {};
    auto refuse = [&](auto change) {
        gtx_horizons_desc desc = good_desc;
        change(desc);
        return make(&good.grid, 1, &desc);
    };
    assert_int_equal(refuse([](auto &d) { d.tile = 8; }), GTX_ERROR_ARGUMENT);
    assert_int_equal(refuse([](auto &d) { d.height_bits = 12; }), GTX_ERROR_ARGUMENT);
    assert_int_equal(refuse([](auto &d) { d.mips = 9; }), GTX_ERROR_ARGUMENT);
    assert_int_equal(refuse([](auto &d) { d.vertical = -1; }), GTX_ERROR_ARGUMENT);
    assert_int_equal(refuse([](auto &d) { d.vertical = NAN; }), GTX_ERROR_ARGUMENT);
    assert_int_equal(refuse([](auto &d) { d.lod_levels = 6; }), GTX_ERROR_ARGUMENT);
    assert_int_equal(refuse([](auto &d) { d.color_range[0] = INFINITY; }), GTX_ERROR_ARGUMENT);
    assert_int_equal(refuse([](auto &d) { d.reserved[0] = 1; }), GTX_ERROR_NOT_ZEROED);
}

static void a_stack_is_an_asset(void **)
{
    Field one(200, 150), two(200, 150);
    for (float &v : two.values)
        v += 100;
    one.values[200 * 70 + 90] = NAN;
    one.property[5] = NAN;
    gtx_height_grid grids[] = {one.grid, two.grid};
    gtx_horizons_desc desc = {};
    desc.depths = 1;
    desc.vertical = 2;
    desc.lod_levels = 3;
    gtx_asset *asset;
    gtx_horizons_result result;
    assert_int_equal(make(grids, 2, &desc, &asset, &result), GTX_OK);
    gtx_info info;
    gtx_get_info(asset, &info);
    assert_int_equal(result.nodes, 2 * 200 * 150 - 1);
    assert_int_equal(result.triangles, 2 * (2 * 199 * 149 - 4));
    assert_int_equal(info.source_triangles, result.triangles);
    assert_int_equal(info.patch_count, result.patches);
    assert_true(result.color_range[0] == 0 && result.color_range[1] == 199);
    assert_true(result.height_max < 0.2 && info.has_color && info.lod_levels >= 1);
    const double top = info.bounds_max[1] + info.anchor[1];
    const double low = info.bounds_min[1] + info.anchor[1];
    assert_true(std::fabs(top - 40) < 1 && std::fabs(low + 240) < 1); /* depths, twice as deep */
    for (uint32_t p = 0; p < info.patch_count; ++p)
        assert_true(gtx_patches(asset)[p].flags & GTX_PATCH_TWO_SIDED);
    size_t size;
    assert_non_null(gtx_meta(asset, &size));
    gtx_close(asset);
}

static void parts_are_one_surface(void **)
{
    Field west(130, 60), east(130, 60);
    east.grid.origin[0] = 129 * 5;
    gtx_height_grid parts[] = {west.grid, east.grid};
    gtx_horizons_desc desc = {};
    desc.one_surface = 1;
    gtx_horizons_result result;
    assert_int_equal(make(parts, 2, &desc, nullptr, &result), GTX_OK);
    assert_int_equal(result.nodes, 259 * 60);
    assert_int_equal(result.triangles, 2 * 258 * 59);
    parts[1].property = nullptr;
    assert_int_equal(make(parts, 2, &desc), GTX_ERROR_ARGUMENT);
    parts[1] = east.grid;
    parts[1].origin[0] += 1;
    assert_int_equal(make(parts, 2, &desc), GTX_ERROR_INPUT);
}

static int stop(const gtx_progress *, void *)
{
    return 1;
}

static void cancelling_and_lods(void **)
{
    Field field(100, 100);
    gtx_horizons_desc desc = {};
    desc.progress = stop;
    assert_int_equal(make(&field.grid, 1, &desc), GTX_CANCELLED);
    gtx_asset *asset, *with_lod = nullptr, *again = nullptr;
    assert_int_equal(make(&field.grid, 1, nullptr, &asset), GTX_OK);
    gtx_lod_desc lod = {};
    lod.levels = 2;
    assert_int_equal(gtx_cook_lod_meshes(asset, &lod, &with_lod, nullptr), GTX_OK);
    gtx_info info;
    gtx_get_info(with_lod, &info);
    assert_in_range(info.lod_levels, 1, 2 + 3); /* and those for a few pixels */
    assert_int_equal(gtx_cook_lod_meshes(with_lod, &lod, &again, nullptr), GTX_OK); /* replaced */
    gtx_info other;
    gtx_get_info(again, &other);
    assert_true(info.content_hash == other.content_hash);
    lod.levels = 6;
    assert_int_equal(gtx_cook_lod_meshes(asset, &lod, &again, nullptr), GTX_ERROR_ARGUMENT);
    lod.levels = 0;
    lod.progress = stop;
    assert_int_equal(gtx_cook_lod_meshes(asset, &lod, &again, nullptr), GTX_CANCELLED);
    assert_int_equal(gtx_cook_lod_meshes(nullptr, nullptr, &again, nullptr), GTX_ERROR_ARGUMENT);
    gtx_close(asset);
    gtx_close(with_lod);
    gtx_close(again);
}

static void missing_files_are_told_of(void **)
{
    gtx_height_grid grid;
    gtx_error error;
    std::memset(&error, 0xa5, sizeof error);
    assert_int_equal(gtx_height_grid_read("/nowhere/a.gri", nullptr, &grid, &error),
                     GTX_ERROR_READ);
    assert_true(error.result == GTX_ERROR_READ && !error.rule && !error.rule_name &&
                !error.offset);
    assert_string_equal(error.message, "cannot open the file: No such file or directory");
    assert_int_equal(gtx_height_grid_read(nullptr, nullptr, &grid, &error), GTX_ERROR_ARGUMENT);
    gtx_height_grid none = {};
    gtx_height_grid_free(&none);
    gtx_height_grid_free(nullptr);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(bad_grids_have_a_clear_error),
        cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(a_stack_is_an_asset),
        cmocka_unit_test(parts_are_one_surface),
        cmocka_unit_test(cancelling_and_lods),
        cmocka_unit_test(missing_files_are_told_of),
    };
    return cmocka_run_group_tests_name("horizons", tests, nullptr, nullptr);
}
