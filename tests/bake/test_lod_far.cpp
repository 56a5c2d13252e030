/* The levels of an LOD mesh for models of a few pixels: fewer triangles than patches, and still the
 * same surface, looked up where maps have normals. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "bake/lods.hpp"

using namespace lods;

/* Patches along the six axes, each cut into `n` x `n` of space. */
static std::function<int(size_t)> in_cells(const Mesh &mesh, int n)
{
    return [&mesh, n, axis = shapes::by_axis(mesh)](size_t t) {
        const Vec3d p = (mesh.position(t, 0) + mesh.position(t, 1) + mesh.position(t, 2)) / 3;
        int key = axis(t);
        for (int k = 0; k < 3; ++k)
            key = key * n + (k == axis(t) / 2 ? 0 : std::clamp(int((p[k] + 1) / 2 * n), 0, n - 1));
        return key;
    };
}

static gtx::Vector<LodLevel> far_levels(const Lod &lod)
{
    return {lod.levels.begin() + std::ptrdiff_t(near_levels(lod).size()), lod.levels.end()};
}

static void triangles_cross_many_patches(void **)
{
    Mesh mesh = shapes::ball(64, shapes::bumps);
    Lod lod = lod_of(mesh, shapes::split(mesh, in_cells(mesh, 12), 24));
    const size_t patches = lod.maps.patches.size();
    const gtx::Vector<LodLevel> far = far_levels(lod);
    assert_true(patches > 300 && far.size() >= 2);
    assert_true(far.back().far && far.back().triangle_count() < 2 * patches / 3);
    assert_valid(lod);
    double error = 0;
    for (const LodLevel &level : lod.levels) {
        assert_true(level.error >= error);
        error = level.error;
        assert_int_equal(count_edges(level).open + count_edges(level).crowded, 0);
    }
    for (const LodLevel &level : far)
        for_each(level, [&](size_t, const std::array<Vec3d, 3> &corner) {
            for (const Vec3d &p : corner) {
                const double height = length(p) - shapes::bumps(normalize(p));
                assert_true(std::fabs(height) < 4 * level.error + 2 * level.step);
            }
        });
}

/* The middle of a triangle has a normal in its patch, which faces as it does; but for very few that
 * no patch suits. */
static void middles_are_in_their_patches(void **)
{
    Mesh mesh = shapes::ball(64, shapes::bumps);
    Lod lod = lod_of(mesh, shapes::split(mesh, in_cells(mesh, 12), 24));
    size_t turned = 0, count = 0;
    for (const LodLevel &level : far_levels(lod))
        for_each(level, [&](size_t n, const std::array<Vec3d, 3> &corner) {
            const gtx_patch &p = lod.maps.patches[n];
            const Vec3d middle = (corner[0] + corner[1] + corner[2]) / 3;
            const Vec3d area = cross(corner[1] - corner[0], corner[2] - corner[0]);
            const std::array<double, 2> at = texel(p, middle);
            const Vec3d z(p.axis_z[0], p.axis_z[1], p.axis_z[2]);
            turned += dot(area, z) < 0.25 * length(area);
            ++count;
            assert_true(at[0] > -0.5 && at[0] < p.rect[2] + 0.5);
            assert_true(at[1] > -0.5 && at[1] < p.rect[3] + 0.5);
            assert_true(has_normal(lod.maps, p, int(at[0]), int(at[1])));
        });
    assert_true(100 * turned <= count);
}

/* What is smaller than the error is left out there, and there alone. */
static void specks_are_left_out(void **)
{
    Mesh mesh = shapes::ball(48, shapes::bumps);
    const size_t triangles = mesh.triangle_count();
    const uint32_t vertices = uint32_t(mesh.positions.size());
    for (uint32_t v = 0; v < vertices; ++v)
        mesh.positions.push_back(mesh.positions[v] * 0.004 + Vec3d(1.5, 0, 0));
    for (size_t t = 0; t < triangles; ++t) {
        std::array<uint32_t, 3> speck = mesh.triangles[t];
        for (uint32_t &v : speck)
            v += vertices;
        mesh.triangles.push_back(speck);
    }
    mesh.normals.insert(mesh.normals.end(), mesh.normals.begin(), mesh.normals.end());
    auto cell = in_cells(mesh, 4);
    Lod lod = lod_of(mesh, shapes::split(mesh, [&](size_t t) {
        return cell(t % triangles) + (t < triangles ? 0 : 1000000);
    }, 96));
    auto has_speck = [](const LodLevel &level) {
        bool has = false;
        for_each(level, [&](size_t, const std::array<Vec3d, 3> &c) { has |= c[0].x > 1.45; });
        return has;
    };
    assert_true(has_speck(lod.levels.front()));
    assert_true(lod.levels.back().far && !has_speck(lod.levels.back()));
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(triangles_cross_many_patches),
        cmocka_unit_test(middles_are_in_their_patches),
        cmocka_unit_test(specks_are_left_out),
    };
    return cmocka_run_group_tests_name("far LOD mesh", tests, nullptr, nullptr);
}
