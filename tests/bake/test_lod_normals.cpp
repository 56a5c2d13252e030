/* Normals of LOD meshes: near to the maps where they can be, and none where they cannot. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "asset/patch.h"
#include "bake/lod_normals.hpp"
#include "bake/lods.hpp"

using namespace lods;

static constexpr double DEGREE = 0.017453292519943295;

static NormalMaps maps_of(const Maps &maps)
{
    return {maps.patches.data(), uint32_t(maps.patches.size()), maps.page_width, maps.page_height,
            maps.height_bits, maps.height.data(), maps.normal[0].data()};
}

static Lod ball(unsigned bits = 8)
{
    Mesh mesh = shapes::ball(48, [](const Vec3d &) { return 1.0; });
    BakeOptions options;
    options.height_bits = bits;
    return lod_of(mesh, shapes::split(mesh, shapes::by_axis(mesh), 64), 5, 2, options);
}

static void vertices_of_a_ball_look_outward(void **)
{
    for (unsigned bits : {8u, 16u}) {
        const Lod lod = ball(bits);
        Vector<gtx_lod_mesh> levels = describe(lod.levels), again = levels;
        Vector<LodNormals> made, same;
        Task one(1, nullptr, nullptr), three(3, nullptr, nullptr);
        add_lod_normals(levels, maps_of(lod.maps), made, one);
        add_lod_normals(again, maps_of(lod.maps), same, three);
        assert_int_equal(levels[0].flags, GTX_LOD_NORMALS);
        for (size_t k = 0; k < levels.size(); ++k) {
            const gtx_lod_mesh &level = levels[k];
            if (!level.normals) {
                assert_true(k > 0 && level.normal_error == 0);
                continue;
            }
            assert_true(double(level.normal_error) <= 4 * DEGREE);
            assert_true(k == 0 || level.normal_error > levels[k - 1].normal_error);
            assert_memory_equal(level.normals, again[k].normals, 2 * size_t(level.vertex_count));
            for (size_t v = 0; v < level.vertex_count; ++v) {
                float n[3];
                Vec3d at;
                gtx_decode_octahedral(level.normals + 2 * v, n);
                for (int a = 0; a < 3; ++a)
                    at[a] = double(level.origin[a]) +
                            double(level.step) * level.positions[3 * v + size_t(a)];
                const Vec3d apart = normalize(at) - Vec3d(Vec3f(n[0], n[1], n[2]));
                assert_true(length(apart) < 8 * DEGREE);
            }
        }
    }
}

/* As of a texture on a smooth surface: its triangles tell nothing of it. */
static void relief_of_the_maps_alone_leaves_none(void **)
{
    Lod lod = ball();
    const LodNormals smooth = lod_normals(lod.levels[0].mesh(), maps_of(lod.maps));
    assert_false(smooth.codes.empty());
    const size_t texels = lod.maps.normal[0].size() / 2;
    for (size_t i = 0; i < texels; ++i) /* 13 degrees to either side, a few texels wide */
        lod.maps.normal[0][2 * i] = uint8_t(
            std::clamp(lod.maps.normal[0][2 * i] + (i / 3 % 2 ? 26 : -26), 0, 255));
    Vector<gtx_lod_mesh> levels = describe(lod.levels);
    Vector<LodNormals> made;
    Task task(1, nullptr, nullptr);
    add_lod_normals(levels, maps_of(lod.maps), made, task);
    for (const gtx_lod_mesh &level : levels)
        assert_true(!level.normals && !(level.flags & GTX_LOD_NORMALS));
}

/* The octahedron's edges and corners, and vectors that are none. */
static void directions_come_back(void **)
{
    for (int x = -4; x <= 4; ++x)
        for (int y = -4; y <= 4; ++y)
            for (int z = -4; z <= 4; ++z) {
                const Vec3f n = {float(x), float(y), float(z)};
                uint8_t code[2];
                float back[3];
                gtx_encode_octahedral(&n.x, code);
                gtx_decode_octahedral(code, back);
                const Vec3d is = normalize(Vec3d(n)), got(Vec3f(back[0], back[1], back[2]));
                assert_true(std::fabs(length(got) - 1) < 1e-5);
                if (x || y || z)
                    assert_true(length(is - got) < 1 * DEGREE);
                else
                    assert_true(code[0] == 128 && code[1] == 128);
            }
    for (float odd : {NAN, INFINITY}) {
        const float n[3] = {odd, 1, odd};
        uint8_t code[2];
        gtx_encode_octahedral(n, code);
        assert_int_equal(code[1], 128); /* whatever the other is */
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(vertices_of_a_ball_look_outward),
        cmocka_unit_test(relief_of_the_maps_alone_leaves_none),
        cmocka_unit_test(directions_come_back),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
