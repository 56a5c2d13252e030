/* Partitions: complete, connected, framed, without a fold. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "chart/chart.hpp"
#include "shapes.hpp"

#include <algorithm>
#include <cstdlib>

using namespace gtx;

static Partition partition(const Mesh &mesh, unsigned threads = 2, ChartOptions options = {})
{
    Task task(threads, nullptr, nullptr, {"partition", "frame"});
    return partition_vsa(mesh, options, task);
}

static size_t pieces(const Chart &chart,
                     const std::vector<std::array<uint32_t, 3>> &neighbours)
{
    std::vector<bool> seen(chart.triangles.size());
    size_t count = 0;
    for (uint32_t first : chart.triangles) {
        std::vector<uint32_t> stack = {first};
        bool fresh = false;
        while (!stack.empty()) {
            uint32_t t = stack.back();
            stack.pop_back();
            auto at = std::lower_bound(chart.triangles.begin(), chart.triangles.end(), t);
            if (t == NO_TRIANGLE || at == chart.triangles.end() || *at != t ||
                seen[size_t(at - chart.triangles.begin())])
                continue;
            seen[size_t(at - chart.triangles.begin())] = fresh = true;
            stack.insert(stack.end(), neighbours[t].begin(), neighbours[t].end());
        }
        count += fresh;
    }
    return count;
}

static void check_frame(const Mesh &mesh, const Chart &chart, double pitch)
{
    const Frame &f = chart.frame;
    for (const Vec3d &axis : {f.x, f.y, f.z})
        assert_true(std::abs(length(axis) - 1) < 1e-9);
    assert_true(dot(f.x, cross(f.y, f.z)) >= 0.1);
    double slack = 1e-6 * (pitch + f.extent[0] + f.extent[1] + f.extent[2]);
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t t : chart.triangles)
        for (int k = 0; k < 3; ++k) {
            Vec3d p = mesh.position(t, k), local = f.local(p);
            assert_true(length(f.point(local) - p) <= slack);
            for (int i = 0; i < 3; ++i) {
                low[i] = std::min(low[i], local[i]);
                high[i] = std::max(high[i], local[i]);
            }
        }
    for (int i = 0; i < 3; ++i) {
        assert_true(std::abs(low[i]) <= slack);
        assert_true(std::abs(high[i] - f.extent[i]) <= slack);
    }
}

static void check(const Mesh &mesh, const Partition &p)
{
    auto neighbours = triangle_neighbours(mesh);
    std::vector<int> used(mesh.triangle_count());
    double longest = 0;
    for (const Chart &chart : p.charts) {
        assert_true(!chart.triangles.empty());
        assert_true(std::is_sorted(chart.triangles.begin(), chart.triangles.end()));
        for (uint32_t t : chart.triangles)
            ++used[t];
        assert_int_equal(pieces(chart, neighbours), 1);
        check_frame(mesh, chart, p.pitch);
        longest = std::max({longest, chart.frame.extent[0], chart.frame.extent[1]});
    }
    assert_true(std::all_of(used.begin(), used.end(), [](int n) { return n == 1; }));
    assert_true(std::abs(longest / p.pitch - 120) < 1e-6);
    assert_int_equal(p.initial_chart.size(), mesh.triangle_count());
    for (uint32_t c : p.initial_chart)
        assert_true(c < p.report.initial_charts);
    assert_int_equal(p.junk.size(), mesh.triangle_count());
    assert_int_equal(p.report.inverted_triangles, 0);
    assert_int_equal(p.report.folding_charts, 0);
}

static double texels(const Partition &p)
{
    double sum = 0;
    for (const Chart &c : p.charts)
        sum += std::ceil(c.frame.extent[0] / p.pitch + 1) * std::ceil(c.frame.extent[1] / p.pitch + 1);
    return sum;
}

static void print(const char *name, const Partition &p)
{
    const ChartReport &r = p.report;
    print_message("%-10s %4zu charts of %4u, inverted %u in %u -> %u in %u, second layer %.4f %%, "
                  "junk %u (%.4f %%), %.0fk texels\n",
                  name, p.charts.size(), unsigned(r.initial_charts), unsigned(r.initial_inverted),
                  unsigned(r.initial_folding), unsigned(r.inverted_triangles),
                  unsigned(r.folding_charts), 100 * r.second_layer_fraction,
                  unsigned(r.junk_triangles), 100 * r.junk_area_fraction, texels(p) / 1000);
}

static void test_shapes(void **)
{
    struct {
        const char *name;
        Mesh mesh;
    } cases[] = {{"plane", shapes::plane(40)},
                 {"sphere", shapes::sphere(24)},
                 {"bumpy", shapes::bumpy_sphere(40)},
                 {"torus", shapes::torus(40, 0.4)},
                 {"ring", shapes::torus(40, 0.02)},
                 {"cylinder", shapes::cylinder(40)},
                 {"helicoid", shapes::helicoid(60, 5)},
                 {"folded", shapes::folded_sheet(30, 0.01)},
                 {"flat fold", shapes::folded_sheet(30, 1e-5)},
                 {"cube", shapes::cube(1)},
                 {"fine cube", shapes::cube(20)},
                 {"two", shapes::both(shapes::sphere(10), shapes::torus(20, 0.3), {5, 0, 0})},
                 {"far", shapes::both(shapes::sphere(10), shapes::sphere(10), {1e7, 0, 0})}};
    for (auto &c : cases) {
        Partition p = partition(c.mesh);
        print(c.name, p);
        check(c.mesh, p);
    }
}

static void test_models(void **)
{
    const char *models = std::getenv("GEOTEX_MODELS");
    if (!models)
        skip();
    struct {
        const char *name, *file;
        unsigned charts;
    } cases[] = {{"bunny", "scans/bunny.ply", 222},
                 {"armadillo", "scans/armadillo_86k.obj.gz", 0},
                 {"horse", "scans/horse.ply.gz", 0},
                 {"nefertiti", "scans/nefertiti.obj.gz", 0},
                 {"gargo", "scans/gargo_3dhop.ply.gz", 0},
                 {"dragon", "scans/dragon_vrip_res2.ply.gz", 453}};
    for (auto &c : cases) {
        Task task(1, nullptr, nullptr, {"read", "partition", "frame"});
        task.begin("read");
        CleanReport report;
        Mesh mesh = clean_mesh(import_mesh(std::string(models) + "/" + c.file, task), task, report);
        ChartOptions options;
        options.charts = c.charts;
        Partition p = partition_vsa(mesh, options, task);
        task.end();
        print(c.name, p);
        print_message("           %.2f s\n", task.seconds()[1] + task.seconds()[2]);
        check(mesh, p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shapes), cmocka_unit_test(test_models)};
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
