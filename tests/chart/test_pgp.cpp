/* The periodic parameterization: its field's singularities, lines that meet, squares, bad input. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "mapped.hpp"

#include <algorithm>
#include <numeric>
#include <set>

using namespace gtx;

static size_t singular_triangles(const Periodic &map)
{
    return size_t(std::count(map.singular.begin(), map.singular.end(), 1));
}

static int index_sum(const Mapped &m)
{
    return std::accumulate(m.field.index.begin(), m.field.index.end(), 0);
}

static size_t singular_vertices(const Mapped &m)
{
    return m.field.index.size() - size_t(std::count(m.field.index.begin(), m.field.index.end(), 0));
}

/* Of what make_half_edges found. */
static int euler_characteristic(const Mapped &m)
{
    size_t half_edges = m.edges.opposite.size();
    size_t borders = size_t(std::count(m.edges.opposite.begin(), m.edges.opposite.end(), NO_EDGE));
    return int(m.edges.first.size()) - int((half_edges + borders) / 2) +
           int(m.mesh.triangle_count());
}

/* Quarters of a turn around all singularities are four times the Euler characteristic. */
static void singularities_add_up(void **)
{
    const struct {
        const char *name;
        Mesh mesh;
        int characteristic;
        size_t most; /* singular vertices */
    } cases[] = {{"sphere", shapes::sphere(20), 2, 8},
                 {"fine sphere", shapes::sphere(41), 2, 8},
                 {"bumpy", shapes::bumpy_sphere(30), 2, 60},
                 {"cube", shapes::cube(10), 2, 8},
                 {"coarse cube", shapes::cube(1), 2, 8},
                 {"torus", shapes::torus(40, 0.4), 0, 0},
                 {"ring", shapes::torus(40, 0.02), 0, 0},
                 {"two", shapes::both(shapes::sphere(10), shapes::cube(10), {5, 0, 0}), 4, 16}};
    for (auto &c : cases) {
        Mapped m(c.mesh);
        assert_int_equal(euler_characteristic(m), c.characteristic);
        assert_int_equal(index_sum(m), 4 * c.characteristic);
        print_message("%-12s %zu singular vertices\n", c.name, singular_vertices(m));
        assert_true(singular_vertices(m) <= c.most);
    }
    for (const Mesh &mesh : {shapes::plane(20), shapes::cylinder(30), shapes::helicoid(30, 3)})
        assert_int_equal(singular_vertices(Mapped(mesh)), 0);
}

/* Both sides of an edge see the same turn, and all turns around a vertex are its index. */
static void turns_agree(void **)
{
    Mapped m(shapes::bumpy_sphere(20));
    Vector<int> around(m.edges.first.size(), 0);
    for (uint32_t h = 0; h < m.edges.opposite.size(); ++h) {
        uint32_t o = m.edges.opposite[h];
        assert_int_equal(m.edges.opposite[o], h);
        assert_int_equal((m.field.turn[h] + m.field.turn[o]) & 3, 0);
        assert_true(m.field.bend[h] == -m.field.bend[o]);
        assert_true(std::abs(m.field.bend[h]) <= shapes::PI / 4 + 1e-12);
        assert_true(std::abs(m.edges.transport(h) + m.edges.transport(o)) < 1e-12);
        around[m.edges.vertex[next_edge(h)]] += m.field.turn[h];
    }
    for (size_t v = 0; v < around.size(); ++v)
        assert_int_equal((around[v] + m.field.index[v]) & 3, 0);
}

static void quarters_turn_back(void **)
{
    const Uv uv = {0.25, -3};
    for (unsigned a = 0; a < 4; ++a)
        for (unsigned b = 0; b < 4; ++b)
            assert_true(turned(turned(uv, a), b) == turned(uv, a + b));
}

/* On a curved height field with a border the directions are those of its curvature: across and
 * along. */
static void the_field_follows_the_curvature(void **)
{
    Mapped m(shapes::cylinder(40));
    for (uint32_t t = 0; t < m.mesh.triangle_count(); ++t) {
        Vec3d edge = normalize(m.mesh.position(t, 1) - m.mesh.position(t, 0));
        Vec3d left = cross(normalize(m.mesh.area_vector(t)), edge);
        Vec3d axis = edge * std::cos(m.field.angle[t]) + left * std::sin(m.field.angle[t]);
        assert_true(std::abs(axis.z) < 0.02 || std::abs(axis.z) > 0.9998);
    }
}

/* On a torus too, though its triangles lean all to one side. */
static void the_field_does_not_lean(void **)
{
    const unsigned n = 40;
    Mapped m(shapes::torus(n, 0.4));
    for (uint32_t t = 0; t < m.mesh.triangle_count(); ++t) {
        uint32_t parallel = 3 * t + t % 2; /* edge: the first of a, b, d, the second of a, d, c */
        double off = m.field.angle[t] - m.edges.direction[parallel];
        assert_true(std::abs(std::remainder(off, shapes::PI / 2)) < 0.05);
    }
}

/* Seen from both sides, a line crosses an edge at the same place: coordinates differ by a quarter
 * turn and by whole numbers, the same at both ends. */
static size_t check_lines_meet(const Mapped &m, const Periodic &map)
{
    size_t checked = 0;
    for (uint32_t h = 0; h < m.edges.opposite.size(); ++h) {
        uint32_t o = m.edges.opposite[h];
        if (o == NO_EDGE || map.singular[h / 3] || map.singular[o / 3])
            continue;
        ++checked;
        unsigned turn = m.field.turn[h];
        Uv here[2] = {turned(map.uv[h], turn), turned(map.uv[next_edge(h)], turn)};
        Uv there[2] = {map.uv[next_edge(o)], map.uv[o]};
        for (size_t i = 0; i < 2; ++i) {
            double shift = std::round(there[0][i] - here[0][i]);
            for (int end = 0; end < 2; ++end)
                assert_true(there[end][i] == here[end][i] + shift);
        }
    }
    return checked;
}

static void lines_meet(void **)
{
    for (const Mesh &mesh : {shapes::sphere(30), shapes::torus(40, 0.4), shapes::cube(20),
                             shapes::cylinder(40), shapes::bumpy_sphere(40), shapes::plane(30),
                             shapes::both(shapes::sphere(16), shapes::plane(20), {4, 0, 0})}) {
        Mapped m(mesh);
        Periodic map = m.parameterize(m.cell_for(60));
        assert_true(check_lines_meet(m, map) > m.edges.opposite.size() * 7 / 10);
    }
}

/* Where the field has no singularity, neither has the map; it keeps area and orientation. */
static void regular_maps(void **)
{
    const struct {
        Mesh mesh;
        double cells;
    } cases[] = {{shapes::plane(40), 40},       {shapes::cylinder(40), 40},
                 {shapes::torus(50, 0.4), 40},  {shapes::torus(40, 0.4), 120},
                 {shapes::torus(30, 0.3), 60},  {shapes::torus(40, 0.2), 50}};
    for (auto &c : cases) {
        Mapped m(c.mesh);
        double covered = 0;
        Periodic map = m.parameterize(m.cell_for(c.cells));
        assert_int_equal(singular_triangles(map), 0);
        for (uint32_t t = 0; t < m.mesh.triangle_count(); ++t) {
            const Uv *p = &map.uv[3 * t];
            double area = ((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) -
                           (p[1][1] - p[0][1]) * (p[2][0] - p[0][0])) / 2;
            assert_true(area > 0);
            covered += area;
        }
        print_message("covers %.2f cells of %.0f\n", covered, c.cells);
        assert_true(covered > 0.85 * c.cells && covered < 1.15 * c.cells);
    }
}

/* On the plane u and v are as straight as the borders, a cell apart. */
static void plane_is_squares(void **)
{
    Mapped m(shapes::plane(40));
    Periodic map = m.parameterize(0.25);
    for (uint32_t h = 0; h < m.edges.opposite.size(); ++h) {
        uint32_t next = next_edge(h);
        double du = std::abs(map.uv[next][0] - map.uv[h][0]);
        double dv = std::abs(map.uv[next][1] - map.uv[h][1]);
        Vec3d e = m.mesh.positions[start_of(m.mesh, next)] - m.mesh.positions[start_of(m.mesh, h)];
        assert_true(std::abs(std::max(du, dv) - 4 * std::max(std::abs(e.x), std::abs(e.y))) < 1e-3);
        assert_true(std::abs(std::min(du, dv) - 4 * std::min(std::abs(e.x), std::abs(e.y))) < 1e-3);
    }
}

/* Labels are of connected charts, all used, about as many as were asked for. */
static void wanted_count(void **)
{
    for (const Mesh &mesh : {shapes::sphere(24), shapes::torus(40, 0.4), shapes::bumpy_sphere(30),
                             shapes::plane(40)})
        for (uint32_t wanted : {24u, 60u, 150u}) {
            uint32_t count = wanted;
            CutMesh cut = cells(mesh, count);
            print_message("%u charts of %u\n", count, wanted);
            assert_in_range(count, wanted * 8 / 10, wanted * 12 / 10);
            assert_int_equal(std::set<uint32_t>(cut.label.begin(), cut.label.end()).size(), count);
            Task task(1, nullptr, nullptr, {"partition"});
            Surface surface = make_surface(cut.mesh, 1, task);
            Vector<uint32_t> pieces = cut.label;
            assert_int_equal(connected_pieces(surface.whole, pieces), count);
        }
}

/* The same where cells adapt. */
static gtx_result result_of(const Mesh &mesh)
{
    gtx_result results[2] = {GTX_OK, GTX_OK};
    for (bool adaptive : {false, true}) {
        uint32_t count = 20;
        try {
            cells(mesh, count, 2, adaptive);
        } catch (const Error &e) {
            results[adaptive] = e.result;
        }
    }
    assert_int_equal(results[true], results[false]);
    return results[false];
}

/* An error or an answer, but soon. */
static void degenerate_meshes(void **)
{
    Mesh point = shapes::sphere(10);
    for (Vec3d &v : point.positions)
        v = {1, 2, 3};
    assert_int_equal(result_of(point), GTX_ERROR_INPUT);

    Mesh lost = shapes::sphere(10);
    lost.positions[7].x = NAN;
    assert_int_equal(result_of(lost), GTX_ERROR_INPUT);
    lost.positions[7].x = 1e200;
    assert_int_equal(result_of(lost), GTX_ERROR_INPUT);

    Mesh line = shapes::plane(10, 1, 0);
    assert_int_equal(result_of(line), GTX_ERROR_INPUT);
    assert_int_equal(result_of(shapes::plane(10, 1, 1e-9)), GTX_OK);

    Mesh partly = shapes::plane(20); /* a row of it has no area */
    for (uint32_t i = 0; i <= 20; ++i)
        partly.positions[21 * 10 + i] = partly.positions[21 * 11 + i];
    assert_int_equal(result_of(partly), GTX_OK);

    for (double scale : {1e-30, 1e30}) {
        Mesh ball = shapes::bumpy_sphere(10);
        for (Vec3d &v : ball.positions)
            v *= scale;
        assert_int_equal(result_of(ball), GTX_OK);
    }
}

/* The unit of length is no part of the answer, nor is the number of threads. */
static void same_answer(void **)
{
    const Mesh mesh = shapes::both(shapes::bumpy_sphere(20), shapes::torus(20, 0.3), {4, 0, 0});
    Mesh large = mesh;
    for (Vec3d &v : large.positions)
        v *= 8;
    for (bool adaptive : {false, true}) {
        uint32_t count = 50, other = 50;
        CutMesh cut = cells(mesh, count, 1, adaptive), again = cells(mesh, other, 4, adaptive);
        assert_true(again.label == cut.label && again.mesh.positions == cut.mesh.positions);
        assert_true(again.mesh.triangles == cut.mesh.triangles);
        assert_int_equal(other, count);
        other = 50;
        assert_true(cells(large, other, 2, adaptive).label == cut.label);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(singularities_add_up), cmocka_unit_test(turns_agree),
        cmocka_unit_test(quarters_turn_back), cmocka_unit_test(the_field_follows_the_curvature),
        cmocka_unit_test(the_field_does_not_lean),
        cmocka_unit_test(lines_meet), cmocka_unit_test(regular_maps),
        cmocka_unit_test(plane_is_squares), cmocka_unit_test(wanted_count),
        cmocka_unit_test(degenerate_meshes),
        cmocka_unit_test(same_answer)};
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
