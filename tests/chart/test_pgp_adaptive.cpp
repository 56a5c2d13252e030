/* Cells that adapt: smaller where the surface is curved, as they were where it is so everywhere. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "mapped.hpp"

#include <algorithm>
#include <random>

using namespace gtx;

/* A cell's length at each vertex over what it is without the option. */
static Vector<double> factors(const Mapped &m, double cells)
{
    Vector<double> scale = m.scale;
    adapt_scale(m.surface, m.edges, m.cell_for(cells), scale);
    for (size_t i = 0; i < scale.size(); ++i)
        scale[i] /= m.scale[i];
    return scale;
}

static double least(const Vector<double> &values)
{
    return *std::min_element(values.begin(), values.end());
}

static double most(const Vector<double> &values)
{
    return *std::max_element(values.begin(), values.end());
}

static Mesh ellipsoid(unsigned n)
{
    Mesh mesh = shapes::sphere(n);
    for (Vec3d &p : mesh.positions)
        p.z *= 3;
    return mesh;
}

/* Bumps, each much smaller than a cell. */
static Mesh rough(Mesh mesh, double height)
{
    std::mt19937 random(7);
    for (Vec3d &p : mesh.positions)
        p.z += height * (double(random()) / double(random.max()) - 0.5);
    return mesh;
}

static void alike_everywhere_stays_so(void **)
{
    const struct {
        const char *name;
        Mesh mesh;
        double within;
    } cases[] = {{"plane", shapes::plane(40), 1e-6},
                 {"oblong", shapes::plane(40, 3, 1), 1e-6},
                 {"rounding", rough(shapes::plane(40), 1e-12), 1e-6},
                 {"rough", rough(shapes::plane(60), 1e-3), 0.05},
                 {"cylinder", shapes::cylinder(40), 0.01},
                 {"sphere", shapes::sphere(40), 0.01}};
    for (auto &c : cases)
        for (double cells : {30., 200.}) {
            Vector<double> factor = factors(Mapped(c.mesh), cells);
            print_message("%-10s %3.0f cells: %.3f to %.3f\n", c.name, cells, least(factor),
                          most(factor));
            assert_true(least(factor) > 1 - c.within && most(factor) < 1 + c.within);
        }
}

/* Most of a cube has no curvature, and its edges have all there can be. */
static void factors_are_bounded(void **)
{
    for (const Mesh &mesh : {shapes::cube(20), shapes::cube(1), shapes::folded_field(30, 0.1),
                             shapes::bumpy_sphere(30), ellipsoid(30)})
        for (double cells : {5., 60., 2000.}) {
            Vector<double> factor = factors(Mapped(mesh), cells);
            assert_true(least(factor) > 0.499 && most(factor) < 2.001);
        }
}

/* The mean area of charts between two heights, those above as those below. */
static double mean_area(const CutMesh &cut, uint32_t count, int axis, double low, double high)
{
    Vector<double> area(count, 0), moment(count, 0);
    for (uint32_t t = 0; t < cut.mesh.triangle_count(); ++t) {
        double a = length(cut.mesh.area_vector(t)) / 2, at = 0;
        for (int k = 0; k < 3; ++k)
            at += cut.mesh.position(t, k)[axis] / 3;
        area[cut.label[t]] += a;
        moment[cut.label[t]] += a * std::abs(at);
    }
    double sum = 0, charts = 0;
    for (uint32_t i = 0; i < count; ++i)
        if (double at = moment[i] / area[i]; at >= low && at < high) {
            sum += area[i];
            ++charts;
        }
    assert_true(charts > 0);
    return sum / charts;
}

/* Charts where the surface is curved against those where it is not, by their area. A height field
 * that bends has cells of one length without the option; an ellipsoid's field draws them together
 * at the tips. */
static void curved_parts_get_smaller_charts(void **)
{
    const struct {
        const char *name;
        Mesh mesh;
        int axis;
        double flat[2], curved[2]; /* along the axis */
        double ratio[2];           /* at least, without the option; at most, with it */
    } cases[] = {{"bent", shapes::folded_field(40, 0.6), 0, {0, 0.8}, {1, 2}, {0.9, 0.45}},
                 {"ellipsoid", ellipsoid(60), 2, {0, 1}, {2.6, 4}, {0.45, 0.41}}};
    for (auto &c : cases) {
        double ratio[2];
        for (bool adaptive : {false, true}) {
            uint32_t count = 300;
            CutMesh cut = cells(c.mesh, count, 2, adaptive);
            assert_in_range(count, 270, 330);
            ratio[adaptive] = mean_area(cut, count, c.axis, c.curved[0], c.curved[1]) /
                              mean_area(cut, count, c.axis, c.flat[0], c.flat[1]);
        }
        print_message("%-10s curved over flat: %.2f, adaptive %.2f\n", c.name, ratio[0], ratio[1]);
        assert_true(ratio[0] > c.ratio[0] && ratio[1] < c.ratio[1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(alike_everywhere_stays_so),
                                       cmocka_unit_test(factors_are_bounded),
                                       cmocka_unit_test(curved_parts_get_smaller_charts)};
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
