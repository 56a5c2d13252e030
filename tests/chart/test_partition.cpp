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
    return make_partition(mesh, options, task);
}

static ChartOptions with(PartitionMethod method, unsigned charts = 0)
{
    ChartOptions options;
    options.method = method;
    options.charts = charts;
    return options;
}

static bool is_cut(const Chart &chart)
{
    return std::isfinite(chart.clip_low[0]) || std::isfinite(chart.clip_high[0]) ||
           std::isfinite(chart.clip_low[1]) || std::isfinite(chart.clip_high[1]);
}

/* Texels, not more than a patch may have, are as long as relief and the two tilts make them. */
static void check_cells(const Chart &chart, double pitch)
{
    for (int a = 0; a < 2; ++a) {
        assert_in_range(chart.cells[a], 1, 128);
        assert_in_range(std::lround(1e6 * chart.frame.extent[a] / chart.cells[a] / pitch), 250000,
                        4000000);
    }
}

/* Areas of the connected pieces of a chart, ascending. */
static std::vector<double> pieces(const Mesh &mesh, const Chart &chart,
                                  const std::vector<std::array<uint32_t, 3>> &neighbours)
{
    std::vector<bool> seen(chart.triangles.size());
    std::vector<double> areas;
    for (uint32_t first : chart.triangles) {
        std::vector<uint32_t> stack = {first};
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
static void check_cut(const Mesh &mesh, const Chart &chart, double pitch)
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

static void check_frame(const Mesh &mesh, const Chart &chart, double pitch)
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

/* `largest_guest`: texels of what may join a chart without touching it; 0: any. */
static void check(const Mesh &source, const Partition &p, double largest_guest = 0)
{
    const Mesh &mesh = p.charted(source);
    auto neighbours = triangle_neighbours(mesh);
    std::vector<int> used(mesh.triangle_count());
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
        if (largest_guest > 0) {
            std::vector<double> areas = pieces(mesh, chart, neighbours);
            areas.pop_back(); /* beside one piece only crumbs */
            for (double area : areas)
                assert_true(area < largest_guest * p.pitch * p.pitch);
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

static double texels(const Partition &p)
{
    double sum = 0;
    for (const Chart &c : p.charts)
        sum += std::ceil(c.frame.extent[0] / p.pitch + 1) *
               std::ceil(c.frame.extent[1] / p.pitch + 1);
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
                 {"folded", shapes::folded_field(30, 0.01)},
                 {"flat fold", shapes::folded_field(30, 1e-5)},
                 {"cube", shapes::cube(1)},
                 {"fine cube", shapes::cube(20)},
                 {"two", shapes::both(shapes::sphere(10), shapes::torus(20, 0.3), {5, 0, 0})},
                 {"far", shapes::both(shapes::sphere(10), shapes::sphere(10), {1e7, 0, 0})}};
    for (auto &c : cases) {
        Partition p = partition(c.mesh);
        print(c.name, p);
        check(c.mesh, p);
        for (PartitionMethod method : {PartitionMethod::VSA, PartitionMethod::PGP})
            check(c.mesh, partition(c.mesh, 2, with(method)), 64);
    }
}

static void test_small(void **)
{
    Mesh one;
    one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    one.triangles = {{0, 1, 2}};
    Partition p = partition(one, 2, with(PartitionMethod::PGP));
    assert_int_equal(p.charts.size(), 1);
    p = partition(one);
    check(one, p);
    assert_int_equal(p.charts.size(), 1);
    assert_true(length(p.charts[0].frame.z - Vec3d(0, 0, 1)) < 1e-6);
    assert_true(p.charts[0].frame.extent[2] < 1e-12);

    Mesh box = shapes::cube(1); /* a face is a chart */
    p = partition(box);
    check(box, p);
    assert_int_equal(p.charts.size(), 6);

    for (double scale : {1e-30, 1e-6, 1e30}) {
        Mesh ball = shapes::bumpy_sphere(10);
        for (Vec3d &v : ball.positions)
            v *= scale;
        check(ball, partition(ball));
        check(ball, partition(ball, 2, with(PartitionMethod::PGP)), 64);
    }
    Mesh needle = shapes::plane(10, 1, 1e-6);
    check(needle, partition(needle));
    check(needle, partition(needle, 2, with(PartitionMethod::PGP)), 64);
}

static void test_empty(void **)
{
    try {
        partition(Mesh());
        fail();
    } catch (const Error &e) {
        assert_int_equal(e.result, GTX_ERROR_EMPTY);
    }
}

/* What folds must be split, however few charts were asked for. */
static void test_folds_are_split(void **)
{
    const ChartOptions one = with(PartitionMethod::VSA, 1);
    for (const Mesh &mesh : {shapes::sphere(16), shapes::torus(30, 0.4), shapes::helicoid(60, 5),
                             shapes::folded_field(30, 0.02), shapes::cylinder(40),
                             shapes::bumpy_sphere(30)}) {
        Partition p = partition(mesh, 2, one);
        check(mesh, p);
        assert_int_equal(p.report.initial_charts, 1);
        assert_true(p.charts.size() > 1);
    }
    Mesh ramp = shapes::helicoid(60, 5); /* every normal faces up, and yet it folds */
    Partition p = partition(ramp, 2, one);
    assert_int_equal(p.report.initial_inverted, 0);
    assert_true(p.charts.size() >= 5);

    Mesh flat = shapes::plane(20);
    assert_int_equal(partition(flat, 2, one).charts.size(), 1);
}

static void check_single_layer(const Mesh &source, const Partition &p)
{
    const Mesh &mesh = p.charted(source);
    const double apart = 1e-4 * 6 + 1e-9;
    for (const Chart &chart : p.charts) {
        size_t noise = 0; /* as the junk rule has it: a few samples, and shallow */
        for (uint32_t t : chart.triangles) {
            Vec3d sum;
            for (int k = 0; k < 3; ++k)
                sum += mesh.position(t, k) / 3;
            Vec3d at = chart.frame.local(sum);
            bool inside = true;
            for (int a = 0; a < 2; ++a)
                inside = inside && at[a] > chart.clip_low[a] && at[a] < chart.clip_high[a];
            if (!inside)
                continue;
            size_t deep = 0;
            for (uint32_t o : chart.triangles) {
                Vec3d c[3];
                for (int k = 0; k < 3; ++k)
                    c[k] = chart.frame.local(mesh.position(o, k));
                double area = (c[1].x - c[0].x) * (c[2].y - c[0].y) -
                              (c[1].y - c[0].y) * (c[2].x - c[0].x);
                double b = ((at.x - c[0].x) * (c[2].y - c[0].y) -
                            (at.y - c[0].y) * (c[2].x - c[0].x)) / area;
                double d = ((c[1].x - c[0].x) * (at.y - c[0].y) -
                            (c[1].y - c[0].y) * (at.x - c[0].x)) / area;
                double z = c[0].z + b * (c[1].z - c[0].z) + d * (c[2].z - c[0].z);
                bool meets = b >= 0 && d >= 0 && b + d <= 1;
                deep += meets && std::abs(z - at.z) > 4 * p.pitch;
                noise += meets && std::abs(z - at.z) > apart;
            }
            assert_int_equal(deep, 0);
        }
        assert_true(noise <= 4);
    }
}

/* No line along z may meet a chart twice, but for what the rules call one layer. */
static void test_single_layer(void **)
{
    Mesh mesh = shapes::both(shapes::helicoid(50, 4), shapes::folded_field(20, 0.03), {4, 0, 0});
    for (PartitionMethod method :
         {PartitionMethod::VSA, PartitionMethod::PGP, PartitionMethod::CUTS}) {
        Partition p = partition(mesh, 2, with(method, 2));
        check(mesh, p);
        check_single_layer(mesh, p);
    }
}

static void test_wanted_count(void **)
{
    Mesh mesh = shapes::bumpy_sphere(40);
    for (unsigned wanted : {20u, 100u, 400u}) {
        Partition p = partition(mesh, 2, with(PartitionMethod::VSA, wanted));
        assert_int_equal(p.report.initial_charts, wanted);
        assert_in_range(p.charts.size(), wanted, wanted * 5 / 4);
        check(mesh, p, 64);
        p = partition(mesh, 2, with(PartitionMethod::CUTS, wanted));
        assert_in_range(p.charts.size(), wanted * 9 / 10, wanted + (wanted == 20 ? 10 : 0));
        check(mesh, p);
    }
    assert_int_equal(partition(mesh, 2, with(PartitionMethod::VSA)).report.initial_charts,
                     std::lround(10 * std::pow(double(mesh.triangle_count()), 0.28)));
}

/* Distant components get their charts by area; tiny ones get one and take nobody's. */
static void test_components(void **)
{
    Mesh mesh = shapes::sphere(20);
    for (int i = 0; i < 50; ++i) {
        Mesh crumb = shapes::sphere(1);
        for (Vec3d &v : crumb.positions)
            v *= 0.003;
        mesh = shapes::both(mesh, crumb, {2, 0.1 * i, 0});
    }
    Partition p = partition(mesh, 2, with(PartitionMethod::VSA, 60));
    check(mesh, p, 64);
    size_t large = 0;
    for (const Chart &c : p.charts)
        large += c.triangles.front() < shapes::sphere(20).triangle_count();
    assert_in_range(large, 55, 75);
}

/* Texels are no finer than the wanted number of full rectangles would have them, or than small
 * charts need. */
static void test_density(void **)
{
    ChartOptions options = with(PartitionMethod::VSA);
    options.resolution = 256;
    Partition p = partition(shapes::bumpy_sphere(30), 2, options);
    double longest = 0;
    for (const Chart &c : p.charts)
        longest = std::max({longest, c.frame.extent[0], c.frame.extent[1]});
    assert_true(std::abs(longest / p.pitch - 248) < 1e-6);

    Mesh mesh;
    for (int i = 0; i < 300; ++i)
        mesh = shapes::both(mesh, shapes::cube(1), {4. * i, 0, 0});
    p = partition(mesh, 2, with(PartitionMethod::VSA));
    assert_in_range(p.charts.size(), 1800, 2800);
    assert_true(texels(p) < 1.2 * 120 * 120 * 10 * std::pow(3600., 0.28));
    p = partition(mesh);
    assert_int_equal(p.charts.size(), 1800); /* a face each */
    assert_true(texels(p) > 0.99 * 100 * 1800);
    assert_true(texels(p) < 1.5 * 100 * 1800);

    mesh = shapes::sphere(8); /* a blade: its rectangles are all rim */
    for (Vec3d &v : mesh.positions)
        v = {1e6 * v.x, v.y, 1e-6 * v.z};
    assert_true(partition(mesh).charts.size() < 10 * 10 * std::pow(mesh.triangle_count(), 0.28));

    double pitch = partition(shapes::bumpy_sphere(30)).pitch;
    options = {};
    options.resolution = 256;
    assert_true(std::abs(partition(shapes::bumpy_sphere(30), 2, options).pitch - pitch / 2) <
                1e-9 * pitch);
}

/* The side of a texel along an axis of a chart. */
static double texel(const Chart &chart, int axis)
{
    return chart.frame.extent[axis] / chart.cells[axis];
}

/* Texels go where the surface bends, and along the axis along which it does; as many in all. */
static void test_spread(void **)
{
    auto square = [](double height, double k, double l) {
        return shapes::field(200, 200, [=](double u, double v) {
            return Vec3d(u, v, height * std::cos(k * u) * std::cos(l * v));
        });
    };
    Mesh mesh = shapes::both(square(0, 0, 0), square(0.005, 150, 75), {2, 0, 0});
    ChartOptions options;
    options.pitch = 1 / 50.;
    Partition p = partition(mesh, 2, options);
    check(mesh, p);
    assert_int_equal(p.charts.size(), 2);
    const bool first = p.charts[0].frame.origin.x < 1.5;
    const Chart &flat = p.charts[!first], &rough = p.charts[first];
    const double texels[] = {double(flat.cells[0]) * flat.cells[1],
                             double(rough.cells[0]) * rough.cells[1]};
    print_message("texels of a flat square: %.0f, of a rough one: %.0f\n", texels[0], texels[1]);
    assert_true(texels[1] > 2 * texels[0]);
    assert_in_range(texels[0] + texels[1], 0.95 * 2 * 50 * 50, 1.05 * 2 * 50 * 50);

    p = partition(square(0.005, 150, 0), 2, options); /* it bends along x alone */
    assert_int_equal(p.charts.size(), 1);
    const Chart &c = p.charts[0];
    const int along = std::abs(c.frame.x.x) > std::abs(c.frame.y.x) ? 0 : 1;
    assert_true(texel(c, !along) > 1.2 * texel(c, along));
}

/* Where texels are finer, empty ones cost more: cuts go there. */
static void test_cuts_by_relief(void **)
{
    auto wedge = [](double height) {
        return shapes::field(200, 200, [=](double u, double v) {
            return Vec3d(u, u * v, height * std::cos(150 * u) * std::cos(150 * u * v));
        });
    };
    ChartOptions options;
    options.pitch = 1 / 100.;
    options.charts = 12;
    Partition p = partition(shapes::both(wedge(0), wedge(0.005), {2, 0, 0}), 2, options);
    size_t rough = 0;
    for (const Chart &chart : p.charts)
        rough += chart.frame.origin.x > 1.5;
    print_message("patches of a flat wedge: %zu, of a rough one: %zu\n", p.charts.size() - rough,
                  rough);
    assert_true(p.charts.size() <= 12);
    assert_true(rough > p.charts.size() - rough);
}

/* Crumbs that touch a chart beside it join it; those that hang over it do not. */
static void test_crumbs(void **)
{
    Mesh mesh = shapes::plane(30);
    const ChartOptions vsa = with(PartitionMethod::VSA);
    size_t alone = partition(mesh, 2, vsa).charts.size();
    auto add = [&mesh](size_t vertex, const Vec3d &b, const Vec3d &c) {
        auto v = uint32_t(mesh.positions.size());
        Vec3d a = mesh.positions[vertex];
        mesh.positions.insert(mesh.positions.end(), {a, a + b, a + c});
        mesh.triangles.push_back({v, v + 1, v + 2});
    };
    for (size_t row = 5; row < 25; ++row)
        add(31 * row, {-0.002, 0.002, 0}, {-0.002, -0.002, 0});
    Partition p = partition(mesh, 2, vsa);
    check(mesh, p, 64);
    assert_in_range(p.charts.size(), alone - 3, alone + 3);
    for (size_t row = 5; row < 25; ++row)
        add(31 * row + 15, {0.006, 0, 0.006}, {0, 0.006, 0.006});
    p = partition(mesh, 2, vsa);
    check(mesh, p, 64);
    assert_in_range(p.charts.size(), alone + 17, alone + 23);
    assert_int_equal(p.report.junk_triangles, 0);
}

/* No chart of a model of few, large triangles has one that stands upright, whoever it was given to
 * and however few charts face it. */
static void test_walls(void **)
{
    for (uint32_t seed = 0; seed < 40; ++seed) {
        uint32_t random = seed;
        Mesh mesh = shapes::sphere(5);
        for (Vec3d &v : mesh.positions) {
            random = random * 1664525 + 1013904223;
            const double radii[] = {0.5, 0.7, 1, 1, 1.3, 1.8};
            v *= radii[(random >> 16) % 6];
        }
        const Partition p = partition(mesh, 2, with(PartitionMethod::CUTS));
        for (const Chart &chart : p.charts)
            for (uint32_t t : chart.triangles) {
                const Vec3d area = mesh.area_vector(t) / 2;
                if (!p.junk[t] && length(area) > 16 * p.pitch * p.pitch)
                    assert_true(dot(normalize(area), chart.frame.z) > 0.1);
            }
    }
}

static void test_two_sided(void **)
{
    Mesh mesh = shapes::both(shapes::sphere(8), shapes::plane(10), {3, 0, 0});
    mesh.flags.assign(mesh.triangle_count(), 0);
    size_t first = shapes::sphere(8).triangle_count();
    std::fill(mesh.flags.begin() + ptrdiff_t(first), mesh.flags.end(), TRIANGLE_TWO_SIDED);
    for (const Chart &c : partition(mesh).charts)
        assert_int_equal(c.two_sided, c.triangles.front() >= first);
}

static void assert_same(const Partition &a, const Partition &b)
{
    assert_true(a.pitch == b.pitch);
    assert_true(a.initial_chart == b.initial_chart);
    assert_true(a.junk == b.junk);
    assert_int_equal(a.charts.size(), b.charts.size());
    for (size_t i = 0; i < a.charts.size(); ++i) {
        const Frame &f = a.charts[i].frame, &g = b.charts[i].frame;
        assert_true(a.charts[i].triangles == b.charts[i].triangles);
        assert_true(f.origin == g.origin && f.x == g.x && f.y == g.y && f.z == g.z);
        assert_memory_equal(f.extent, g.extent, sizeof f.extent);
    }
}

static void test_deterministic(void **)
{
    Mesh mesh = shapes::both(shapes::bumpy_sphere(30), shapes::helicoid(40, 3), {4, 0, 0});
    assert_same(partition(mesh, 1), partition(mesh, 3));
    const ChartOptions pgp = with(PartitionMethod::PGP, 40);
    assert_same(partition(mesh, 1, pgp), partition(mesh, 3, pgp));
}

/* Scanner noise: a few triangles turned over within a good surface drive no split. */
static void test_junk(void **)
{
    Mesh mesh = shapes::plane(60);
    size_t before = partition(mesh).charts.size();
    mesh.positions[61 * 30 + 30] = mesh.positions[61 * 30 + 31] + Vec3d(0.0005, 0.0003, 0.0002);
    Partition p = partition(mesh);
    check(mesh, p);
    print("noisy", p);
    assert_true(p.report.junk_triangles > 0);
    assert_true(p.report.junk_area_fraction < 1e-3);
    assert_true(p.charts.size() <= before + 1);
}

static int cancel(const gtx_progress *, void *)
{
    return 1;
}

static void test_cancel(void **)
{
    Task task(2, cancel, nullptr, {"partition", "frame"});
    Mesh mesh = shapes::sphere(10);
    try {
        make_partition(mesh, {}, task);
        fail();
    } catch (const Error &e) {
        assert_int_equal(e.result, GTX_CANCELLED);
    }
}

static std::string read_file(const std::string &path)
{
    std::FILE *file = std::fopen(path.c_str(), "rb");
    assert_non_null(file);
    std::string text(1 << 22, 0);
    text.resize(std::fread(&text[0], 1, text.size(), file));
    std::fclose(file);
    return text;
}

static void test_charts_ply(void **)
{
    Mesh mesh = shapes::torus(10, 0.4);
    /* half of it faces away */
    Partition p = partition(mesh, 2, with(PartitionMethod::VSA, 1));
    std::string path = "/tmp/geotex_charts_" + std::to_string(uintptr_t(&p)) + ".ply";
    write_charts_ply(path, mesh, p);
    std::string text = read_file(path);
    std::remove(path.c_str());
    assert_int_equal(text.compare(0, 4, "ply\n"), 0);
    size_t data = text.find("end_header\n") + 11;
    assert_int_equal(text.size() - data, 24 * mesh.positions.size() + 20 * mesh.triangle_count());
    size_t green = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        green += !text.compare(data + 24 * mesh.positions.size() + 20 * t + 13, 3, "\0\xff\0", 3);
    assert_int_equal(green, p.report.initial_inverted);
    assert_true(green > mesh.triangle_count() / 4);
    try {
        write_charts_ply("/nowhere/charts.ply", mesh, p);
        fail();
    } catch (const Error &e) {
        assert_int_equal(e.result, GTX_ERROR_WRITE);
    }
}

/* Pieces have their charts' colours; a triangle that folds counts once, in however many pieces. */
static void test_charts_ply_of_pieces(void **)
{
    Mesh mesh = shapes::torus(12, 0.4);
    Partition p = partition(mesh, 2, with(PartitionMethod::PGP, 6));
    assert_true(p.mesh.triangle_count() > mesh.triangle_count());
    std::string path = "/tmp/geotex_pieces_" + std::to_string(uintptr_t(&p)) + ".ply";
    write_charts_ply(path, p.charted(mesh), p);
    Task task(1, nullptr, nullptr, {"import"});
    task.begin("import");
    Mesh read = import_mesh(path, task);
    std::remove(path.c_str());
    assert_int_equal(read.triangle_count(), p.mesh.triangle_count());
    assert_int_equal(read.colors.size(), 3 * read.triangle_count());
    std::vector<uint32_t> green;
    for (uint32_t t = 0; t < read.triangle_count(); ++t)
        if (read.colors[3 * t] == Rgba8{0, 255, 0, 255})
            green.push_back(p.source_of(t));
    green.erase(std::unique(green.begin(), green.end()), green.end());
    assert_int_equal(green.size(), p.report.initial_inverted);
    assert_true(!green.empty() && p.report.initial_folding > 0);
}

static void test_models(void **)
{
    const char *models = std::getenv("GEOTEX_MODELS");
    if (!models)
        skip();
    struct {
        const char *name, *file;
        unsigned charts;
        PartitionMethod method = PartitionMethod::CUTS;
    } cases[] = {{"bunny", "scans/bunny.ply", 222},
                 {"squares", "scans/bunny.ply", 222, PartitionMethod::PGP},
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
        Partition p = make_partition(mesh, with(c.method, c.charts), task);
        task.end();
        print(c.name, p);
        print_message("           %.2f s\n", task.seconds()[1] + task.seconds()[2]);
        check(mesh, p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes), cmocka_unit_test(test_small), cmocka_unit_test(test_empty),
        cmocka_unit_test(test_folds_are_split), cmocka_unit_test(test_single_layer),
        cmocka_unit_test(test_wanted_count), cmocka_unit_test(test_components),
        cmocka_unit_test(test_density), cmocka_unit_test(test_spread),
        cmocka_unit_test(test_cuts_by_relief), cmocka_unit_test(test_crumbs),
        cmocka_unit_test(test_walls), cmocka_unit_test(test_two_sided),
        cmocka_unit_test(test_deterministic), cmocka_unit_test(test_junk),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_charts_ply), cmocka_unit_test(test_charts_ply_of_pieces),
        cmocka_unit_test(test_models)};
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
