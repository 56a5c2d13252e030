/* A partition and all that it promises. */
#pragma once

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

inline Partition partition(const Mesh &mesh, unsigned threads = 2, ChartOptions options = {})
{
    Task task(threads, nullptr, nullptr, {"partition", "frame"});
    return make_partition(mesh, options, task);
}

inline ChartOptions with(PartitionMethod method, unsigned charts = 0)
{
    ChartOptions options;
    options.method = method;
    options.charts = charts;
    return options;
}

inline bool is_cut(const Chart &chart)
{
    return std::isfinite(chart.clip_low[0]) || std::isfinite(chart.clip_high[0]) ||
           std::isfinite(chart.clip_low[1]) || std::isfinite(chart.clip_high[1]);
}

/* Texels, not more than a patch may have, are as long as relief and the two tilts make them. */
inline void check_cells(const Chart &chart, double pitch)
{
    for (int a = 0; a < 2; ++a) {
        assert_in_range(chart.cells[a], 1, 128);
        assert_in_range(std::lround(1e6 * chart.frame.extent[a] / chart.cells[a] / pitch), 250000,
                        4000000);
    }
}

/* Areas of the connected pieces of a chart, ascending. */
inline Vector<double> pieces(const Mesh &mesh, const Chart &chart,
                             const Vector<std::array<uint32_t, 3>> &neighbours)
{
    Vector<bool> seen(chart.triangles.size());
    Vector<double> areas;
    for (uint32_t first : chart.triangles) {
        Vector<uint32_t> stack = {first};
        double area = 0;
        while (!stack.empty()) {
            uint32_t t = stack.back();
            stack.pop_back();
            auto at = std::lower_bound(chart.triangles.begin(), chart.triangles.end(), t);
            if (t == NO_TRIANGLE || at == chart.triangles.end() || *at != t ||
                seen[size_t(at - chart.triangles.begin())])
                continue;
            seen[size_t(at - chart.triangles.begin())] = true;
            area += length(mesh.area_vector(t)) / 2;
            stack.insert(stack.end(), neighbours[t].begin(), neighbours[t].end());
        }
        if (area > 0)
            areas.push_back(area);
    }
    std::sort(areas.begin(), areas.end());
    return areas;
}

/* A cut chart's frame holds what of its triangles lies between the cuts, in whole texels. Where it
 * ends before a cut, room for its overlap may reach over that. */
inline void check_cut(const Mesh &mesh, const Chart &chart, double pitch)
{
    const Frame &f = chart.frame;
    double low[2], high[2];
    for (int a = 0; a < 2; ++a) {
        assert_true(chart.clip_low[a] <= 1e-9 * pitch);
        assert_true(chart.clip_high[a] >= f.extent[a] - 1e-9 * pitch);
        const double room = 2 * f.extent[a] / chart.cells[a];
        low[a] = std::min(0., chart.clip_low[a] + room);
        high[a] = std::max(f.extent[a], chart.clip_high[a] - room);
    }
    for (uint32_t t : chart.triangles) {
        Vec3d middle;
        for (int k = 0; k < 3; ++k)
            middle += f.local(mesh.position(t, k)) / 3;
        bool inside = true;
        for (int a = 0; a < 2; ++a)
            inside = inside && middle[a] > low[a] && middle[a] < high[a];
        if (inside)
            for (int a = 0; a < 2; ++a)
                assert_true(middle[a] >= -3 * pitch && middle[a] <= f.extent[a] + 3 * pitch);
    }
}

inline void check_frame(const Mesh &mesh, const Chart &chart, double pitch)
{
    const Frame &f = chart.frame;
    for (const Vec3d &axis : {f.x, f.y, f.z})
        assert_true(std::abs(length(axis) - 1) < 1e-9);
    assert_true(dot(f.x, cross(f.y, f.z)) >= 0.1);
    double slack = 1e-6 * (pitch + f.extent[0] + f.extent[1] + f.extent[2]);
    assert_int_equal(chart.cells[0] > 0, chart.cells[1] > 0);
    if (chart.cells[0])
        check_cells(chart, pitch);
    if (is_cut(chart))
        return check_cut(mesh, chart, pitch);
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

/* `largest_island`: texels of what may join a chart without touching it; 0: any. */
inline void check(const Mesh &source, const Partition &p, double largest_island = 0)
{
    const Mesh &mesh = p.charted(source);
    auto neighbours = triangle_neighbours(mesh);
    Vector<int> used(mesh.triangle_count());
    uint64_t owned = 0;
    bool cut = false;
    double longest = 0;
    for (const Chart &chart : p.charts) {
        assert_true(!chart.triangles.empty());
        assert_true(std::is_sorted(chart.triangles.begin(), chart.triangles.end()));
        for (uint32_t t : chart.triangles)
            ++used[t];
        owned += chart.source_triangles;
        cut = cut || is_cut(chart);
        if (largest_island > 0) {
            Vector<double> areas = pieces(mesh, chart, neighbours);
            areas.pop_back(); /* beside one piece only islands */
            for (double area : areas)
                assert_true(area < largest_island * p.pitch * p.pitch);
        }
        check_frame(mesh, chart, p.pitch);
        longest = std::max({longest, chart.frame.extent[0], chart.frame.extent[1]});
    }
    assert_true(std::all_of(used.begin(), used.end(),
                            [=](int n) { return cut ? n >= 1 : n == 1; }));
    assert_int_equal(owned, source.triangle_count());
    assert_true(p.report.initial_inverted <= source.triangle_count());
    if (!cut)
        assert_true(longest / p.pitch < 128 + 1e-6);
    assert_int_equal(p.initial_chart.size(), mesh.triangle_count());
    for (uint32_t c : p.initial_chart)
        assert_true(c < p.report.initial_charts);
    assert_int_equal(p.junk.size(), mesh.triangle_count());
    assert_int_equal(p.report.inverted_triangles, 0);
    assert_int_equal(p.report.folding_charts, 0);
}

inline double texels(const Partition &p)
{
    double sum = 0;
    for (const Chart &c : p.charts)
        sum += std::ceil(c.frame.extent[0] / p.pitch + 1) *
               std::ceil(c.frame.extent[1] / p.pitch + 1);
    return sum;
}

inline void print(const char *name, const Partition &p)
{
    const ChartReport &r = p.report;
    print_message("%-10s %4zu charts of %4u, inverted %u in %u -> %u in %u, second layer %.4f %%, "
                  "junk %u (%.4f %%), %.0fk texels\n",
                  name, p.charts.size(), unsigned(r.initial_charts), unsigned(r.initial_inverted),
                  unsigned(r.initial_folding), unsigned(r.inverted_triangles),
                  unsigned(r.folding_charts), 100 * r.second_layer_fraction,
                  unsigned(r.junk_triangles), 100 * r.junk_area_fraction, texels(p) / 1000);
}
