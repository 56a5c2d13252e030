/* Which triangles of a surface share an edge, whether it is a manifold or not. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "chart/places.hpp"
#include "chart/surface.hpp"
#include "shapes.hpp"

#include <map>

using namespace gtx;

static Vector<std::array<uint32_t, 3>> neighbours_of(Vector<std::array<uint32_t, 3>> triangles)
{
    Mesh mesh;
    mesh.positions = {{0, 0, 0},   {1, 0, 0}, {0, 1, 0}, {0, 0, 1},
                      {-1, -1, 0}, {1, 1, 1}, {2, 1, 1}};
    mesh.triangles = std::move(triangles);
    Task task(2, nullptr, nullptr, {"partition"}, {1});
    return make_surface(mesh, 1, task).whole.neighbours;
}

/* The k-th neighbour is across the edge that ends at corner k. */
static void a_manifold_has_its_neighbours(void **)
{
    const auto closed = neighbours_of({{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
    assert_true((closed[0] == std::array<uint32_t, 3>{1, 3, 2}));
    assert_true((closed[1] == std::array<uint32_t, 3>{3, 0, 2}));
    const auto open = neighbours_of({{0, 2, 1}, {0, 1, 3}, {1, 2, 3}});
    assert_true((open[0] == std::array<uint32_t, 3>{1, NO_TRIANGLE, 2}));
    assert_true((open[2] == std::array<uint32_t, 3>{1, 0, NO_TRIANGLE}));
}

/* A triangle that no manifold has room for stands alone, as OpenMesh has it. */
static void what_is_no_manifold_stands_alone(void **)
{
    const std::array<uint32_t, 3> alone = {NO_TRIANGLE, NO_TRIANGLE, NO_TRIANGLE};
    const auto edge = neighbours_of({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}); /* one of three */
    assert_int_equal(edge[0][1], 1);
    assert_true(edge[2] == alone);
    const auto alike = neighbours_of({{0, 1, 2}, {0, 1, 3}}); /* one that both go the same way */
    assert_true(alike[0] == alone && alike[1] == alone);
    /* A vertex that is closed around, and a triangle more there that touches nothing else. */
    const auto vertex = neighbours_of({{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {0, 5, 6}, {3, 2, 5}});
    assert_true(vertex[3] == alone);
    assert_int_equal(vertex[4][1], 1);
}

static void places_are_found(void **)
{
    Places places(0);
    std::map<uint32_t, uint32_t> expected;
    for (uint32_t i = 0; i < 5000; ++i) {
        const uint32_t triangle = i % 2 ? i * 4096 : i * 7;
        assert_true(places.add(triangle, i) == expected.insert({triangle, i}).second);
    }
    for (uint32_t triangle = 0; triangle < 40000; ++triangle) {
        const auto at = expected.find(triangle);
        assert_int_equal(places.find(triangle), at == expected.end() ? NO_TRIANGLE : at->second);
    }
    for (const auto &[triangle, place] : expected)
        assert_true(places.has(triangle) && places.find(triangle) == place);
}

/* As hypot() has it, on both sides of whole numbers too. */
static void lengths_are_rounded_down(void **)
{
    for (int n = 1; n < 1000; ++n)
        for (double off : {-1e-13, -1e-15, 0., 1e-15, 1e-13}) {
            const double x = 0.3 * n * (1 + off), y = 0.4 * n;
            assert_int_equal(whole_length(2, x, y), int(2 * std::hypot(x, y)));
        }
    assert_int_equal(whole_length(2, 3e-200, 4e-200), 0);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_manifold_has_its_neighbours),
        cmocka_unit_test(what_is_no_manifold_stands_alone),
        cmocka_unit_test(places_are_found),
        cmocka_unit_test(lengths_are_rounded_down),
    };
    return cmocka_run_group_tests_name("surfaces", tests, nullptr, nullptr);
}
