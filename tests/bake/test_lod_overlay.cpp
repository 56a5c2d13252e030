/* What two surfaces that lie over each other are said to be within, they are, and most is said. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "bake/lod/overlay.hpp"
#include "measure/sample.hpp"

#include <algorithm>

using namespace gtx;
using namespace gtx::baking;

/* A ring of so many squares around and across, each two triangles, with vertices off their places
 * by at most `rough` of a square of the coarsest. */
struct Ring {
    Vector<Vec3d> positions;
    Vector<std::array<uint32_t, 3>> triangles;

    Ring(int around, int across, double rough, Random &random)
    {
        for (int i = 0; i < around; ++i)
            for (int j = 0; j < across; ++j) {
                const Vec3d along = turned(double(i) / around), out = turned(double(j) / across);
                const Vec3d off = {random.next() - 0.5, random.next() - 0.5, random.next() - 0.5};
                positions.push_back(along * (3 + out.x) + Vec3d(0, 0, out.y) + off * rough);
                const auto at = [&](int di, int dj) {
                    return uint32_t((i + di) % around * across + (j + dj) % across);
                };
                triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
                triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
            }
    }
    /* On a square whose corners are rounded, which needs no sine. */
    static Vec3d turned(double share)
    {
        const double way = 4 * share, side = way - double(int(way));
        const Vec3d corners[] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {1, 0, 0}};
        return normalize(corners[int(way)] * (1 - side) + corners[int(way) + 1] * side);
    }
};

static Vec3d point_of(const Corners &c, Random &random)
{
    double a = random.next(), b = random.next();
    if (a + b > 1) {
        a = 1 - a;
        b = 1 - b;
    }
    return c[0] + (c[1] - c[0]) * a + (c[2] - c[0]) * b;
}

static double distance(const SortedSurface &surface, const Vec3d &point)
{
    return FarSearch{surface, 0, 0}.distance(point, 0);
}

struct Sure {
    size_t fine = 0, coarse = 0;
};

/* How many are told, of which points are as near as that. */
static Sure check(const SortedSurface &fine, const SortedSurface &coarse, const Overlay &overlay)
{
    Random random(3);
    Sure sure;
    const double round = 1 + 1e-6;
    for (size_t t = 0; t < fine.size(); ++t) {
        const double most = double(overlay.of_fine[t]);
        if (!(most < INFINITY))
            continue;
        ++sure.fine;
        const Vec3d p = point_of(fine.corners(t), random);
        assert_true(distance(coarse, p) <= most * round);
        bool told = false;
        for (size_t c = 0; c < coarse.size() && !told; ++c) {
            const auto [x, y, z] = coarse.corners(c);
            const double away = overlay.to_coarse.at(c) * round;
            told = triangle_distance2(p, x, y, z) <= away * away;
        }
        assert_true(told);
    }
    for (size_t t = 0; t < coarse.size(); ++t) {
        const double most = overlay.of_coarse.at(t);
        sure.coarse += most < INFINITY;
        for (int n = 0; n < 4 && most < INFINITY; ++n)
            assert_true(distance(fine, point_of(coarse.corners(t), random)) <= most * round);
    }
    return sure;
}

static void what_is_told_is_near(void **)
{
    Task task(2, nullptr, nullptr);
    for (int n = 0; n < 12; ++n) {
        Random random(7 + unsigned(n));
        const Ring many(61, 30, 0.02 * n, random), few(23 + 3 * n, 11 + n, 0.02 * n, random);
        const SortedSurface fine(many.positions, many.triangles, task, 0),
            coarse(few.positions, few.triangles, task, 0);
        const Overlay overlay = lay_over(fine, coarse, nullptr, nullptr, task);
        const Sure sure = check(fine, coarse, overlay);
        if (n == 0) {
            assert_int_equal(sure.fine, fine.size());
            assert_int_equal(sure.coarse, coarse.size());
        }
        if (n < 6) {
            assert_true(double(sure.fine) > 0.9 * double(fine.size()));
            assert_true(double(sure.coarse) > 0.7 * double(coarse.size()));
        }
    }
}

/* A surface with some of its vertices, where many points are on both. */
static void what_is_on_it_is_at_nothing(void **)
{
    Task task(1, nullptr, nullptr);
    Random random(1);
    const Ring ring(24, 16, 0.1, random);
    const SortedSurface same(ring.positions, ring.triangles, task, 0);
    const Overlay overlay = lay_over(same, same, nullptr, nullptr, task);
    for (size_t t = 0; t < same.size(); ++t) {
        assert_true(overlay.of_fine[t] < 1e-6f);
        assert_true(overlay.of_coarse.at(t) < 1e-6);
    }
}

/* A coarse triangle is not sure to be near where something is missing over it. */
static void holes_are_seen(void **)
{
    Task task(1, nullptr, nullptr);
    Random random(1);
    const Ring many(48, 32, 0, random), few(15, 10, 0, random);
    const SortedSurface coarse(few.positions, few.triangles, task, 0);
    for (size_t gone = 0; gone < many.triangles.size(); gone += 97) {
        Vector<std::array<uint32_t, 3>> rest = many.triangles;
        const auto [a, b, c] = rest[gone];
        const Vec3d middle = (many.positions[a] + many.positions[b] + many.positions[c]) / 3;
        rest.erase(rest.begin() + ptrdiff_t(gone));
        const SortedSurface fine(many.positions, rest, task, 0);
        const Overlay overlay = lay_over(fine, coarse, nullptr, nullptr, task);
        FarSearch search = {coarse, 0, 0};
        search.distance(middle, 0);
        assert_false(overlay.of_coarse.at(search.near) < INFINITY);
        const Sure sure = check(fine, coarse, overlay);
        assert_true(sure.coarse + 12 > coarse.size());
    }
}

static void distances_add_up(void **)
{
    Task task(1, nullptr, nullptr);
    Random random(1);
    const Ring many(48, 32, 0, random), few(15, 10, 0, random);
    const SortedSurface fine(many.positions, many.triangles, task, 0),
        coarse(few.positions, few.triangles, task, 0);
    Reached before(fine.size()), beyond(fine.size());
    for (size_t t = 0; t < fine.size(); ++t) {
        before.set(t, 10);
        beyond.set(t, 20);
    }
    const Overlay alone = lay_over(fine, coarse, nullptr, nullptr, task),
                  more = lay_over(fine, coarse, &before, &beyond, task);
    assert_true(alone.of_fine == more.of_fine);
    for (size_t t = 0; t < coarse.size(); ++t) {
        assert_true(std::abs(more.to_coarse.at(t) - alone.to_coarse.at(t) - 10) < 1e-5);
        assert_true(std::abs(more.of_coarse.at(t) - alone.of_coarse.at(t) - 20) < 1e-5);
    }
}

static void any_thread_count_tells_the_same(void **)
{
    Random random(4);
    const Ring many(161, 80, 0.05, random), few(90, 50, 0.05, random);
    Vector<double> told[2];
    for (unsigned threads : {1u, 5u}) {
        Task task(threads, nullptr, nullptr);
        const SortedSurface fine(many.positions, many.triangles, task, 0),
            coarse(few.positions, few.triangles, task, 0);
        const Overlay overlay = lay_over(fine, coarse, nullptr, nullptr, task);
        Vector<double> &all = told[threads > 1];
        all.assign(overlay.of_fine.begin(), overlay.of_fine.end());
        for (size_t t = 0; t < coarse.size(); ++t) {
            all.push_back(overlay.of_coarse.at(t));
            all.push_back(overlay.to_coarse.at(t));
        }
    }
    assert_true(told[0] == told[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_told_is_near),
        cmocka_unit_test(what_is_on_it_is_at_nothing),
        cmocka_unit_test(holes_are_seen),
        cmocka_unit_test(distances_add_up),
        cmocka_unit_test(any_thread_count_tells_the_same),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
