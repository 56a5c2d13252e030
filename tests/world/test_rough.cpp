/* No ray passes through rough terrain where its own chart does not show it. */
#include "worlds.hpp"

#include <geotex/cook.h>

#include <cmath>

using namespace gtx;

/* Of rays within `reach` / 19 texels of a place of the source, which is behind all of them: those
 * that meet nothing within two texels of it. */
static size_t rays_through(const gtx_asset *asset, const Vec3d &at, const Vec3d &toward,
                           double texel, int reach)
{
    const double STEP = texel / 19, NEAR = 2.1 * texel;
    gtx_info info;
    gtx_error error;
    gtx_caster *caster = nullptr;
    gtx_get_info(asset, &info);
    if (gtx_caster_create(asset, nullptr, &caster, &error))
        fail_msg("%s", error.message);
    const Vec3d x = normalize(cross(toward, Vec3d(1, 0, 0))), y = cross(toward, x);
    size_t through = 0;
    for (int j = -reach; j <= reach; ++j)
        for (int i = -reach; i <= reach; ++i) {
            const Vec3d from = at + x * (STEP * i) + y * (STEP * j) + toward * NEAR -
                               Vec3d(info.anchor[0], info.anchor[1], info.anchor[2]);
            const gtx_ray ray = {{float(from.x), float(from.y), float(from.z)}, 0,
                                 {float(-toward.x), float(-toward.y), float(-toward.z)},
                                 float(3 * NEAR)};
            gtx_hit hit;
            gtx_raycast(caster, &ray, &hit, 1, GTX_RAY_TWO_SIDED);
            through += hit.patch == UINT32_MAX;
        }
    gtx_caster_destroy(caster);
    return through;
}

/* Its own height field is right there, in the map, but the cells leave a slit of a texel; that of
 * the next chart faces the wall, and ends half a texel sooner than it could. */
static void a_steep_wall_is_whole(void **)
{
    PlanOptions options;
    options.models = {in_folder("rough.ply")};
    options.folder = in_folder("rough");
    options.triangles = 6000;
    write_file(options.models[0], ply_text(rough_terrain(110, 0.8)));
    Task task(2, nullptr, nullptr, {"read", "cook", "simplify"}, {1, 1, 1});
    task.limits.allow_work(1e6);
    plan_world(options, task);
    split_world(options.folder, task);
    cook_tile(options.folder, "r50", task);
    gtx_asset *asset = nullptr;
    gtx_error error;
    if (gtx_open_file(in_folder("rough/tiles/r50.gtx").c_str(), nullptr, &asset, &error))
        fail_msg("%s", error.message);
    const size_t through = rays_through(asset, {0.26518, 0.013375, 0.339637},
                                        normalize(Vec3d(-0.08, 0.87, -0.49)), 0.0038, 24);
    print_message("# %zu rays pass\n", through);
    assert_int_equal(through, 0);
    gtx_close(asset);
}

/* Of an asset of its own, of which a texel is 0.0066; likewise. */
static size_t rays_through_terrain(double seed, const Vec3d &at, const Vec3d &toward, int reach)
{
    const std::string path = in_folder("whole.ply");
    write_file(path, ply_text(rough_terrain(40, 0.8, 0.2, seed, 2.399)));
    gtx_asset *asset = nullptr;
    gtx_error error;
    if (gtx_cook_file(path.c_str(), in_folder("whole.gtx").c_str(), nullptr, nullptr, &error) ||
        gtx_open_file(in_folder("whole.gtx").c_str(), nullptr, &asset, &error))
        fail_msg("%s", error.message);
    const size_t through = rays_through(asset, at, normalize(toward), 0.0066, reach);
    gtx_close(asset);
    print_message("# %zu rays pass\n", through);
    return through;
}

static void is_whole_at(double seed, const Vec3d &at, const Vec3d &normal)
{
    assert_int_equal(rays_through_terrain(seed, at, normal, 12), 0);
}

/* Another height field is right there, as steep as the own one; neither's trim hides anything. */
static void what_two_charts_miss_is_whole(void **)
{
    is_whole_at(7, {0.7718, 0.0744, 0.9495}, {-0.632, 0.240, -0.737});
}

/* The side of a crest is within a texel of its top, along the normal of the top, and crosses it. */
static void a_crest_beside_its_side_is_whole(void **)
{
    is_whole_at(8, {-0.3633, -0.0346, 0.0593}, {0.238, 0.890, -0.388});
}

/* One field's hidden cell rises by nine texels, and crosses a wall that leans back in one place. */
static void what_shows_a_wall_is_no_sheet_in_the_air(void **)
{
    assert_int_equal(rays_through_terrain(7, {-0.2307, 0.2252, -0.4681}, {1, -1, -1}, 4), 81);
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_steep_wall_is_whole),
        cmocka_unit_test(what_two_charts_miss_is_whole),
        cmocka_unit_test(a_crest_beside_its_side_is_whole),
        cmocka_unit_test(what_shows_a_wall_is_no_sheet_in_the_air),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
