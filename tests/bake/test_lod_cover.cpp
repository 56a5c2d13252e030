/* What lies all over a triangle is known without a look at its points, and nothing else is. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "bake/lod/cover.hpp"
#include "measure/sample.hpp"

using namespace gtx;
using namespace gtx::baking;

/* Squares of a side of 1 from -2 to 6 along x and y, each two triangles, over the triangle. */
struct Ground {
    static constexpr int SIDE = 9;
    Vector<Vec3d> positions;
    Vector<std::array<uint32_t, 3>> triangles;

    Ground()
    {
        for (int j = 0; j < SIDE; ++j)
            for (int i = 0; i < SIDE; ++i)
                positions.push_back({i - 2.0, j - 2.0, 0});
        for (int j = 0; j + 1 < SIDE; ++j)
            for (int i = 0; i + 1 < SIDE; ++i) {
                const uint32_t from = at(i, j), to = at(i + 1, j + 1);
                triangles.push_back({from, at(i + 1, j), to});
                triangles.push_back({from, to, at(i, j + 1)});
            }
    }
    static uint32_t at(int i, int j) { return uint32_t(j * SIDE + i); }
    bool covers(const Corners &t, double most) const
    {
        Task task(1, nullptr, nullptr);
        const SortedSurface surface(positions, triangles, task, 0);
        return covering(t, surface, most, NO_PATCH) != NO_PATCH;
    }
};

static const Corners low = {{{0.3, 0.4, 0.1}, {3.2, 0.6, 0.1}, {1.1, 3.7, 0.1}}};
static const Corners turned = {{low[1], low[0], low[2]}};

static void all_of_it_or_nothing(void **)
{
    Ground ground;
    assert_true(ground.covers(low, 0.11));
    assert_false(ground.covers(low, 0.09));
    assert_false(ground.covers(turned, 0.11));
    ground.positions[Ground::at(3, 3)].z = 0.15; /* within */
    assert_true(ground.covers(low, 0.11));
    ground.positions[Ground::at(3, 3)].z = 0.3; /* a peak */
    assert_false(ground.covers(low, 0.11));
    assert_true(ground.covers(low, 0.21));
}

static void holes_and_borders_are_seen(void **)
{
    for (size_t t = 0; t < Ground().triangles.size(); ++t) {
        Ground ground;
        Vec3d middle = {0, 0, 0};
        for (uint32_t v : ground.triangles[t])
            middle = middle + ground.positions[v] / 3;
        ground.triangles.erase(ground.triangles.begin() + std::ptrdiff_t(t));
        const bool over = middle.x > 0.9 && middle.x < 1.9 && middle.y > 0.9 && middle.y < 1.9;
        const bool beside = middle.x < 0 || middle.y < 0 || middle.x > 4 || middle.y > 4;
        if (over || beside)
            assert_int_equal(ground.covers(low, 0.11), beside);
    }
    Corners beyond = low;
    beyond[2].y = 6.1;
    assert_false(Ground().covers(beyond, 0.11));
    Ground empty;
    empty.triangles.resize(1);
    assert_false(empty.covers(low, 10));
}

/* What is turned over, or there twice. */
static void folds_cover_nothing(void **)
{
    Ground over;
    std::swap(over.triangles[54][0], over.triangles[54][1]);
    assert_false(over.covers(low, 0.11));
    Ground doubled;
    doubled.triangles.push_back(doubled.triangles[54]);
    assert_false(doubled.covers(low, 0.11));
}

/* From all that is a few steps away, or else from what is nearest to the middle. Another sheet
 * above is no matter to who begins below it, and covers by itself if it is whole. */
static void what_is_close_by_begins(void **)
{
    Task task(1, nullptr, nullptr);
    Ground ground;
    const uint32_t above = uint32_t(ground.positions.size());
    for (const Vec3d &p : {Vec3d(0, 0, 0.12), Vec3d(3, 0, 0.12), Vec3d(0, 3, 0.12)})
        ground.positions.push_back(p);
    for (bool both : {false, true}) {
        if (both)
            ground.triangles.push_back({above, above + 1, above + 2});
        const SortedSurface surface(ground.positions, ground.triangles, task, 0);
        for (uint32_t near = 0; near < surface.size(); ++near) {
            const bool higher = surface.given(near) == 128;
            const uint32_t over = covering(low, surface, 0.11, near);
            assert_int_equal(over == NO_PATCH, higher);
            if (!higher)
                assert_in_range(surface.given(over), 54, 55); /* its square has the middle */
        }
        assert_int_equal(covering(low, surface, 0.11, NO_PATCH) == NO_PATCH, both);
    }
}

static void what_has_no_area_is_not_sure(void **)
{
    const Ground ground;
    assert_false(ground.covers({{low[0], low[0], low[1]}}, 1));
    assert_false(ground.covers({{low[0], (low[0] + low[1]) / 2, low[1]}}, 1));
    assert_false(ground.covers({{{0, 0, 0}, {1e-160, 0, 0}, {0, 1e-160, 0}}}, 1));
    assert_false(ground.covers({{{NAN, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 1));
}

/* Where a rough surface is said to cover a triangle, all of its points are as near. */
static void what_is_covered_is_near(void **)
{
    Random random(5);
    unsigned covered = 0;
    for (int n = 0; n < 400; ++n) {
        Ground ground;
        for (Vec3d &p : ground.positions)
            p = p + Vec3d(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5) *
                        (0.002 * n);
        const double most = 0.1 + 0.3 * random.next();
        if (!ground.covers(low, most))
            continue;
        ++covered;
        Task task(1, nullptr, nullptr);
        const SortedSurface surface(ground.positions, ground.triangles, task, 0);
        FarSearch search = {surface, 0, 0};
        for (int i = 0; i <= 20; ++i)
            for (int j = 0; i + j <= 20; ++j) {
                const Vec3d p = low[0] * (i / 20.0) + low[1] * (j / 20.0) +
                                low[2] * ((20 - i - j) / 20.0);
                assert_true(search.distance(p, 0) <= most * (1 + 1e-12));
            }
    }
    assert_in_range(covered, 100, 390);
}

/* Two of a scan that meet at a corner, which rounding puts now on one side of edges, now on the
 * other: clipping gave more corners than there was room for. */
static void a_corner_in_common(void **)
{
    const Corners low_one = {{{0x1.644ddf3cp-6, 0x1.31678a768p-4, -0x1.0b2c4c7p-5},
                              {0x1.6b74796ep-6, 0x1.31beb6608p-4, -0x1.0ebf9989p-5},
                              {0x1.680cc24ap-6, 0x1.2fb3aee48p-4, -0x1.0ebf9989p-5}}};
    const Vector<Vec3d> positions = {{0x1.5edb209cp-6, 0x1.2f0557108p-4, -0x1.094cdae9p-5},
                                     {0x1.780dd24p-6, 0x1.33f553d18p-4, -0x1.114d62e4p-5},
                                     low_one[1]};
    Task task(1, nullptr, nullptr);
    const SortedSurface surface(positions, {{0, 1, 2}}, task, 0);
    assert_int_equal(covering(low_one, surface, 0x1.824e69e97f6a5p-14, NO_PATCH), NO_PATCH);
}

/* Of needles rounding says anything, such as that an edge crosses a side again and again. */
static void needles_are_not_sure(void **)
{
    Random random(9);
    for (int n = 0; n < 2000; ++n) {
        Ground ground;
        for (Vec3d &p : ground.positions)
            p = p + Vec3d(random.next(), random.next(), random.next());
        const Vec3d from(4 * random.next(), 4 * random.next(), random.next());
        const Vec3d to(4 * random.next(), 4 * random.next(), random.next());
        const double thin = std::pow(10, -8 - 10 * random.next());
        const Vec3d beside(thin * random.next(), thin * random.next(), thin * random.next());
        Task task(1, nullptr, nullptr);
        const SortedSurface surface(ground.positions, ground.triangles, task, 0);
        const Vec3d between = from + (to - from) * (0.2 + 0.6 * random.next()) + beside;
        assert_int_equal(covering({{from, to, between}}, surface, 1, NO_PATCH), NO_PATCH);
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(all_of_it_or_nothing),
        cmocka_unit_test(holes_and_borders_are_seen),
        cmocka_unit_test(folds_cover_nothing),
        cmocka_unit_test(what_is_close_by_begins),
        cmocka_unit_test(what_has_no_area_is_not_sure),
        cmocka_unit_test(a_corner_in_common),
        cmocka_unit_test(needles_are_not_sure),
        cmocka_unit_test(what_is_covered_is_near),
    };
    return cmocka_run_group_tests_name("LOD mesh cover", tests, nullptr, nullptr);
}
