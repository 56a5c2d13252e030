/* Fewer triangles: what stands out is drawn out again, and height fields that meet stay
 * together. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "bake/lod/outlier.hpp"
#include "bake/lod/parts.hpp"
#include "bake/lod/quadric.hpp"
#include "bake/shapes.hpp"

#include <map>

using namespace gtx;
using namespace gtx::baking;

static bool is_near(double a, double b)
{
    return std::fabs(a - b) < 1e-12;
}

/* Around vertex 0: a roof, 1 high along y = 0, that falls to 0 at y = -1 and 1. */
struct Roof {
    Vector<Vec3d> positions = {{0, 0, 1}, {-1, 0, 1}, {0, -1, 0}, {1, 0, 1}, {0, 1, 0}};
    Vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
    Vector<uint32_t> start = {0, 4, 6, 8, 10, 12};
    Vector<uint32_t> around = {0, 1, 2, 3, 0, 3, 0, 1, 1, 2, 2, 3};

    /* To a point that vertex 0 stands for; returns how often a vertex was moved. */
    int draw_out_to(const Vec3d &point, double most)
    {
        Task task(1, nullptr, nullptr, {"lod"}, {1});
        task.begin("lod");
        int moved = 0;
        draw_out({positions, triangles, start, around, {0, 1, 1, 1, 1, 1}, {point}}, most,
                 [&](uint32_t vertex, const Vec3d &way) {
                     positions[vertex] += way;
                     return ++moved > 0;
                 },
                 task, 1);
        return moved;
    }
    double above(const Triangle &t, const Vec3d &point) const
    {
        const Vec3d &a = positions[t[0]];
        return dot(point - a, normalize(cross(positions[t[1]] - a, positions[t[2]] - a)));
    }
};

/* The cube of an area of 1e-110 is 0. */
static void a_vertex_of_no_area_stays(void **)
{
    Quadric q;
    q.add_plane({0, 0, 1}, -1, 1e-110);
    q.weight = 1e-110;
    const Vec3d way = q.way_down({1, 2, 3}, 0.003);
    assert_true(way.x == 0 && way.y == 0 && way.z == 0);
}

static void points_outside_are_reached(void **)
{
    const Vec3d up = normalize(Vec3d(0, -1, 1)), on = {-0.25, -0.5, 0.5};
    Roof roof;
    assert_int_equal(roof.draw_out_to(on - up * 0.1, 0.02), 0); /* inside */
    assert_int_equal(roof.draw_out_to(on + up * 0.02, 0.02), 0);
    assert_int_equal(roof.draw_out_to(on + up * 0.1, 0.02), 3); /* the corners below, once */
    const double left = roof.above(roof.triangles[0], on + up * 0.1);
    assert_true(left > 0.015 && left < 0.02 + 1e-12);
    assert_true(roof.positions[4].y == 1 && roof.positions[3].x == 1);

    Roof corner;
    assert_int_equal(corner.draw_out_to({0, 0, 2}, 0.5), 1);
    assert_true(is_near(corner.positions[0].z, 1.5));
}

/* A corner that is where another is, as rounding may leave it. */
static void slivers_have_nearest_points(void **)
{
    Roof roof;
    roof.positions[2] = roof.positions[1];
    assert_true(roof.draw_out_to({-0.5, 0, 1.5}, 0.1) > 0);
    assert_true(is_near(roof.positions[0].z, 1.4));
}

static LodSource source_of(const Mesh &mesh)
{
    LodSource source;
    for (const auto &p : mesh.positions)
        source.positions.push_back(Vec3d(p));
    source.triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
    source.patch.assign(mesh.triangle_count(), 0);
    return source;
}

struct Level {
    Vector<Vec3d> positions;
    Vector<Triangle> triangles;
    double error;
};

/* A level of `share` of the triangles, of a surface that its only patch shows everywhere. */
static Level reduced(const LodSource &source, double share, Task &task)
{
    const Vector<PatchRegion> anywhere(1);
    Simplifier level(source, anywhere, task);
    level.reduce(size_t(share * double(source.triangles.size())), 0, INFINITY);
    level.settle();
    return {level.positions(), level.triangles(), level.error()};
}

/* Along the ray from the middle of a star-shaped surface. */
static double radius_along(const Level &level, const Vec3d &way)
{
    double most = 0;
    for (const Triangle &t : level.triangles) {
        const Vec3d &a = level.positions[t[0]], &b = level.positions[t[1]];
        const Vec3d &c = level.positions[t[2]];
        const double u = dot(way, cross(b, c)), v = dot(way, cross(c, a));
        const double w = dot(way, cross(a, b));
        const double sum = u + v + w; /* a ray along an edge meets both its triangles */
        if (sum > 0 && std::min({u, v, w}) >= -1e-9 * sum)
            most = std::max(most, dot(a, cross(b, c)) / sum);
    }
    return most;
}

static void little_is_left_outside(void **)
{
    Task task(2, nullptr, nullptr, {"lod"}, {1});
    const LodSource source = source_of(shapes::ball(32, shapes::bumps));
    for (double share : {0.2, 0.05, 0.02}) {
        const Level level = reduced(source, share, task);
        double most = 0, mean = 0;
        for (const Vec3d &p : source.positions) {
            const double out = length(p) - radius_along(level, normalize(p));
            most = std::max(most, out);
            mean += out / double(source.positions.size());
        }
        assert_true(most < 1.7 * level.error);
        assert_true(mean <= 0); /* half of it inside, and more */
    }
}

/* Three leaves of a book, 16 x 16 squares each, along the z axis. */
static LodSource book()
{
    LodSource source;
    constexpr uint32_t N = 16, LEAVES = 3;
    auto at = [](uint32_t leaf, uint32_t i, uint32_t j) {
        return i ? (N + 1) + (leaf * N + i - 1) * (N + 1) + j : j;
    };
    for (uint32_t j = 0; j <= N; ++j)
        source.positions.push_back({0, 0, double(j) / N});
    for (uint32_t leaf = 0; leaf < LEAVES; ++leaf) {
        const double angle = 2 * M_PI / LEAVES * leaf;
        for (uint32_t i = 1; i <= N; ++i)
            for (uint32_t j = 0; j <= N; ++j)
                source.positions.push_back({std::cos(angle) * i / N, std::sin(angle) * i / N,
                                            double(j) / N});
        for (uint32_t i = 0; i < N; ++i)
            for (uint32_t j = 0; j < N; ++j) {
                const uint32_t a = at(leaf, i, j), b = at(leaf, i + 1, j);
                const uint32_t c = at(leaf, i, j + 1), d = at(leaf, i + 1, j + 1);
                source.triangles.push_back({a, b, d});
                source.triangles.push_back({a, d, c});
            }
    }
    source.patch.assign(source.triangles.size(), 0);
    return source;
}

static bool is_on_axis(const Vec3d &p)
{
    return std::hypot(p.x, p.y) < 1e-9;
}

/* Where the leaves meet vertices go as they do elsewhere, and no leaf comes off. */
static void leaves_stay_bound(void **)
{
    Task task(2, nullptr, nullptr, {"lod"}, {1});
    const Level level = reduced(book(), 0.1, task);
    std::map<std::array<uint32_t, 2>, int> uses; /* of edges on the axis */
    for (const Triangle &t : level.triangles)
        for (int k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
            if (is_on_axis(level.positions[a]) && is_on_axis(level.positions[b]))
                ++uses[{a, b}];
        }
    double bound = 0;
    for (const auto &[edge, count] : uses) {
        assert_int_equal(count, 3);
        bound += std::fabs(level.positions[edge[0]].z - level.positions[edge[1]].z);
    }
    double area = 0;
    for (const auto &[a, b, c] : level.triangles)
        area += length(cross(level.positions[b] - level.positions[a],
                             level.positions[c] - level.positions[a])) / 2;
    assert_true(uses.size() < 8);
    assert_true(std::fabs(bound - 1) < 1e-6 && std::fabs(area - 3) < 1e-6);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_vertex_of_no_area_stays),
        cmocka_unit_test(points_outside_are_reached),
        cmocka_unit_test(slivers_have_nearest_points),
        cmocka_unit_test(little_is_left_outside),
        cmocka_unit_test(leaves_stay_bound),
    };
    return cmocka_run_group_tests_name("LOD mesh simplification", tests, nullptr, nullptr);
}
