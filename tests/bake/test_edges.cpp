/* Where a chart ends or breaks: discontinuities, needles, specks, shreds. */
#include "bake/baked.hpp"

static void one_triangle_bakes(void **)
{
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    shapes::add_normals(mesh);
    Maps maps = bake_valid(mesh, shapes::split(mesh, shapes::all_in_one(), 64));
    const gtx_patch &p = maps.patches[0];
    assert_true(p.extent_z >= std::max(p.extent_x, p.extent_y) / 4100);
    each_texel(maps, [&](const gtx_patch &, const Vec3d &q, double, size_t) {
        assert_true(std::fabs(q.z) < 1e-6);
    });
    assert_true(maps.report.texels_empty < maps.report.texels_total);
}

struct Shown {
    double area; /* of the cells that can show, in the plane */
    int steps;   /* those of them with a step of more than six pitches of 1/32 */
};

static Shown count_steps(const Maps &maps)
{
    const gtx_patch &p = maps.patches[0];
    int cells = 0, steps = 0;
    for (unsigned j = 0; j + 1 < p.rect[3]; ++j) {
        for (unsigned i = 0; i + 1 < p.rect[2]; ++i) {
            int low = 255, high = 0, trim = 255;
            for (unsigned k = 0; k < 4; ++k) {
                size_t at = size_t(p.rect[1] + j + k / 2) * maps.page_width + p.rect[0] + i + k % 2;
                low = std::min<int>(low, maps.height[at]);
                high = std::max<int>(high, maps.height[at]);
                trim = std::min<int>(trim, maps.trim[at]);
            }
            bool shows = low > 0 && trim <= 128 + 4;
            cells += shows;
            steps += shows && (high - low) / 254. * p.extent_z > 6. / 32;
        }
    }
    return {cells * (p.extent_x / p.rect[2]) * (p.extent_y / p.rect[3]), steps};
}

/* Two terraces, 16 pitches apart in depth and half a texel in the plane: a steep slope between them
 * is surface, and without it no cell may look like one. */
static void a_cliff_is_not_bridged_but_a_slope_is(void **)
{
    Mesh slope = shapes::field(64, [](double u, double v) {
        return Vec3d(u, v, u <= 0.5 ? 0 : 0.5);
    });
    Mesh cliff = slope;
    cliff.triangles.clear();
    for (const auto &t : slope.triangles)
        if (slope.positions[t[0]].z == slope.positions[t[1]].z &&
            slope.positions[t[0]].z == slope.positions[t[2]].z)
            cliff.triangles.push_back(t);
    cliff.normals.assign(3 * cliff.triangle_count(), Vec3f(0, 0, 1));

    auto bake_flat = [](const Mesh &mesh) {
        Partition partition = shapes::split(mesh, shapes::all_in_one(), 32);
        Chart &chart = partition.charts[0];
        chart.frame = shapes::frame_along(mesh, chart.triangles, {0, 0, 1});
        partition.pitch = 1 / 32.;
        return bake_valid(mesh, partition);
    };
    Shown whole = count_steps(bake_flat(slope)), parted = count_steps(bake_flat(cliff));
    assert_true(whole.steps >= 32);
    assert_int_equal(parted.steps, 0);
    /* But for two columns, a cell's margin at each end. */
    assert_true(parted.area + 4 * 34 / (32. * 32) >= whole.area);
}

/* A terrace over a slope, at one end of their border as high as that: what lies below is reached
 * from there, and joined by a wall besides, but no cell of the terrace goes down to it. */
static void a_core_ends_at_a_drop(void **)
{
    const Mesh mesh = shapes::field(64, [](double u, double v) {
        return Vec3d(u, v, u <= 0.5 ? 0 : -v);
    });
    auto is_below = [&](size_t t) {
        const auto &corners = mesh.triangles[t];
        return int(std::any_of(corners.begin(), corners.end(),
                               [&](uint32_t v) { return mesh.positions[v].x > 0.5; }));
    };
    Partition partition = shapes::split(mesh, is_below, 32);
    for (Chart &chart : partition.charts)
        chart.frame = shapes::frame_along(mesh, chart.triangles, {0, 0, 1});
    partition.pitch = 1 / 32.;
    const Shown terrace = count_steps(bake_valid(mesh, partition));
    assert_int_equal(terrace.steps, 0);
    assert_true(terrace.area >= 0.5);
}

static void a_needle_and_a_speck_bake(void **)
{
    for (const Vec3d &tip : {Vec3d(1, 1e-4, 0), Vec3d(1e-6, 1e-6, 0)}) {
        Mesh mesh;
        mesh.positions = {{0, 0, 0}, {tip.x, 0, 0}, tip, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
        mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
        shapes::add_normals(mesh);
        bake_valid(mesh, shapes::split(mesh, [](size_t t) { return int(t); }, 128));
    }
}

static void a_chart_that_faces_away_bakes(void **)
{
    Mesh mesh = shapes::field(4, [](double u, double v) { return Vec3d(u, v, 0); });
    Partition partition = shapes::split(mesh, shapes::all_in_one(), 16);
    partition.charts[0].frame =
        shapes::frame_along(mesh, partition.charts[0].triangles, Vec3d(0, 0, -1));
    bake_valid(mesh, partition);
    partition.charts[0].frame =
        shapes::frame_along(mesh, partition.charts[0].triangles, Vec3d(1, 0, 0));
    bake_valid(mesh, partition);
}

static void an_edge_on_closed_shred_bakes(void **)
{
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
    mesh.normals.assign(6, Vec3f(0, 0, 1));
    Partition partition = shapes::split(mesh, shapes::all_in_one(), 32);
    partition.charts[0].frame = shapes::frame_along(mesh, {0, 1}, Vec3d(0, 0, 1));
    partition.pitch = 1 / 32.;
    bake_valid(mesh, partition);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(one_triangle_bakes),
        cmocka_unit_test(a_cliff_is_not_bridged_but_a_slope_is),
        cmocka_unit_test(a_core_ends_at_a_drop),
        cmocka_unit_test(a_needle_and_a_speck_bake),
        cmocka_unit_test(a_chart_that_faces_away_bakes),
        cmocka_unit_test(an_edge_on_closed_shred_bakes),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
