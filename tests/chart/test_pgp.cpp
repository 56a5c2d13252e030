/* The periodic parameterization: its field's singularities, lines that meet, squares, bad input. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "chart/pgp.hpp"
#include "shapes.hpp"

#include <algorithm>
#include <numeric>
#include <set>

using namespace gtx;

/* A mesh with all that comes before its charts. */
struct Mapped {
    Task task{2, nullptr, nullptr, {"partition"}};
    Mesh mesh;
    Surface surface;
    HalfEdges edges;
    CrossField field;
    std::vector<double> scale;

    explicit Mapped(Mesh of)
        : mesh(std::move(of)), surface(make_surface(mesh, expected_pitch(mesh, 50))),
          edges(make_half_edges(surface)), field(make_cross_field(surface, edges, task)),
          scale(make_scale(edges, field))
    {
        task.begin("partition");
    }
    Periodic parameterize(double cell)
    {
        return gtx::parameterize(edges, field, scale, cell, task);
    }
    /* Cells of a mean length that cover as much as the surface. */
    double cell_for(double count) const { return std::sqrt(surface.area / count); }
};

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

static CutMesh cells(const Mesh &mesh, uint32_t &count, unsigned threads = 2)
{
    Task task(threads, nullptr, nullptr, {"partition"});
    task.begin("partition");
    Surface surface = make_surface(mesh, expected_pitch(mesh, count));
    return square_cells(surface, count, task);
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
    std::vector<int> around(m.edges.first.size(), 0);
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

/* On a curved sheet with a border the directions are those of its curvature: across and along. */
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

static double area_of(const Mesh &mesh)
{
    double area = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        area += length(mesh.area_vector(t)) / 2;
    return area;
}

/* Directed edges; each is there once. */
static std::set<std::pair<uint32_t, uint32_t>> directed_edges(const Mesh &mesh)
{
    std::set<std::pair<uint32_t, uint32_t>> out;
    for (const auto &t : mesh.triangles)
        for (int k = 0; k < 3; ++k)
            assert_true(out.insert({t[k], t[(k + 1) % 3]}).second);
    return out;
}

/* Length of the borders, and the Euler characteristic. */
static std::pair<double, int> border_and_characteristic(const Mesh &mesh)
{
    std::set<std::pair<uint32_t, uint32_t>> edges = directed_edges(mesh);
    double border = 0;
    size_t single = 0;
    for (auto [a, b] : edges)
        if (!edges.count({b, a})) {
            border += length(mesh.positions[b] - mesh.positions[a]);
            ++single;
        }
    std::set<uint32_t> used;
    for (auto [a, b] : edges)
        used.insert(a);
    assert_int_equal(used.size(), mesh.positions.size());
    return {border, int(used.size()) - int((edges.size() + single) / 2) + int(mesh.triangle_count())};
}

/* A mesh in pieces is the same surface: every edge cut alike from both sides, none lost. */
static void check_cut(const Mesh &mesh, const CutMesh &cut)
{
    auto [border, characteristic] = border_and_characteristic(mesh);
    auto [cut_border, cut_characteristic] = border_and_characteristic(cut.mesh);
    assert_int_equal(cut_characteristic, characteristic);
    assert_true(std::abs(cut_border - border) <= 1e-9 * border);
    double area = area_of(mesh);
    assert_true(std::abs(area_of(cut.mesh) - area) <= 1e-9 * area);
    assert_int_equal(cut.source.size(), cut.mesh.triangle_count());
    assert_int_equal(cut.label.size(), cut.mesh.triangle_count());
    assert_true(std::is_sorted(cut.source.begin(), cut.source.end()));
    std::vector<double> covered(mesh.triangle_count());
    for (uint32_t t = 0; t < cut.source.size(); ++t) {
        Vec3d own = cut.mesh.area_vector(t), whole = mesh.area_vector(cut.source[t]);
        assert_true(dot(own, whole) > 0);
        covered[cut.source[t]] += length(own) / length(whole);
    }
    for (double c : covered)
        assert_true(std::abs(c - 1) < 1e-6);
}

static void cuts_keep_the_surface(void **)
{
    for (const Mesh &mesh :
         {shapes::sphere(30), shapes::torus(40, 0.4), shapes::cube(1), shapes::cube(7),
          shapes::cylinder(40), shapes::bumpy_sphere(30), shapes::plane(1), shapes::plane(37),
          shapes::helicoid(30, 3), shapes::both(shapes::sphere(16), shapes::plane(20), {4, 0, 0})}) {
        Mapped m(mesh);
        for (double count : {10., 100., 1000.}) {
            Periodic map = m.parameterize(m.cell_for(count));
            Pieces pieces = cut_along_lines(mesh, m.edges, m.field, map);
            check_cut(mesh, cut_mesh(mesh, pieces,
                                     std::vector<uint32_t>(pieces.triangle.size())));
            for (const Seam &seam : pieces.seams)
                assert_true(seam.piece[0] != NO_PIECE && seam.piece[0] != seam.piece[1]);
        }
    }
}

/* No piece of a regular triangle reaches over a line, and the lines are where pieces are told to be
 * apart. */
static void pieces_keep_to_their_cells(void **)
{
    for (const Mesh &mesh : {shapes::bumpy_sphere(30), shapes::torus(40, 0.4), shapes::plane(5)}) {
        Mapped m(mesh);
        Periodic map = m.parameterize(m.cell_for(150));
        Pieces pieces = cut_along_lines(mesh, m.edges, m.field, map);
        std::vector<Uv> cell(pieces.triangle.size());
        size_t cut = 0;
        for (uint32_t i = 0; i < pieces.triangle.size(); ++i) {
            uint32_t t = pieces.triangle[i];
            double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
            for (uint32_t c = pieces.first[i]; c < pieces.first[i + 1]; ++c)
                for (size_t a = 0; a < 2; ++a) {
                    double x = 0;
                    for (uint32_t k = 0; k < 3; ++k)
                        x += double(pieces.corners[c].weight[k]) * map.uv[3 * t + k][a];
                    low[a] = std::min(low[a], x);
                    high[a] = std::max(high[a], x);
                }
            for (size_t a = 0; a < 2; ++a)
                cell[i][a] = std::floor((low[a] + high[a]) / 2);
            for (size_t a = 0; a < 2 && !map.singular[t]; ++a)
                assert_true(low[a] > cell[i][a] - 1e-5 && high[a] < cell[i][a] + 1 + 1e-5);
            cut += i && pieces.triangle[i - 1] == t;
        }
        assert_true(cut > 10);
        for (const Seam &seam : pieces.seams) {
            if (seam.piece[1] == NO_PIECE)
                continue;
            uint32_t a = pieces.triangle[seam.piece[0]], b = pieces.triangle[seam.piece[1]];
            if (a == b)
                assert_true(seam.line && cell[seam.piece[0]] != cell[seam.piece[1]]);
            else if (map.singular[a] != map.singular[b])
                assert_true(seam.line);
        }
    }
}

/* On the plane charts are squares, though no edge of it lies on their sides. */
static void charts_are_squares(void **)
{
    Mesh mesh = shapes::plane(37);
    uint32_t count = 25;
    CutMesh cut = cells(mesh, count);
    check_cut(mesh, cut);
    struct Box {
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, area = 0;
    };
    std::vector<Box> boxes(count);
    for (uint32_t t = 0; t < cut.label.size(); ++t) {
        Box &box = boxes[cut.label[t]];
        box.area += length(cut.mesh.area_vector(t)) / 2;
        for (int k = 0; k < 3; ++k)
            for (int a = 0; a < 2; ++a) {
                double x = cut.mesh.position(t, k)[a];
                box.low[a] = std::min(box.low[a], x);
                box.high[a] = std::max(box.high[a], x);
            }
    }
    for (const Box &box : boxes) {
        double full = (box.high[0] - box.low[0]) * (box.high[1] - box.low[1]);
        assert_true(std::abs(box.area - full) < 0.001 * full);
    }
}

/* What corners have, a corner between them has in between. */
static void attributes_are_interpolated(void **)
{
    Mesh mesh = shapes::sphere(12);
    auto at = [](const Vec3d &p) {
        return std::array<float, 2>{float(p.x + 2 * p.y), float(p.z)};
    };
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        mesh.flags.push_back(t % 2);
        mesh.appearance.material.push_back(t);
        for (int k = 0; k < 3; ++k) {
            const Vec3d &p = mesh.position(t, k);
            mesh.normals.push_back(Vec3f(p));
            mesh.colors.push_back({uint8_t(128 + std::lround(100 * p.x)), uint8_t(t), 7, 200});
            mesh.appearance.uv[1].push_back(at(p));
            mesh.appearance.tangents.push_back({1, 0, float(p.x), -1});
        }
    }
    uint32_t count = 60;
    CutMesh cut = cells(mesh, count);
    check_cut(mesh, cut);
    const Mesh &m = cut.mesh;
    assert_true(m.triangle_count() > mesh.triangle_count() + 100);
    for (size_t size : {m.normals.size(), m.colors.size(), m.appearance.uv[1].size(),
                        m.appearance.tangents.size()})
        assert_int_equal(size, 3 * m.triangle_count());
    assert_true(m.appearance.uv[0].empty());
    for (uint32_t t = 0; t < m.triangle_count(); ++t) {
        uint32_t source = cut.source[t];
        assert_int_equal(m.flags[t], source % 2);
        assert_int_equal(m.appearance.material[t], source);
        for (uint32_t k = 0; k < 3; ++k) {
            const Vec3d &p = m.position(t, int(k));
            const size_t c = 3 * t + k;
            assert_true(length(m.normals[c]) > 0.9999f && length(m.normals[c]) < 1.0001f);
            assert_true(length(m.normals[c] - Vec3f(normalize(p))) < 0.02f);
            assert_true(std::abs(m.colors[c].r - (128 + 100 * p.x)) < 4);
            assert_int_equal(m.colors[c].g, uint8_t(source));
            assert_int_equal(m.colors[c].a, 200);
            for (size_t i = 0; i < 2; ++i)
                assert_true(std::abs(m.appearance.uv[1][c][i] - at(p)[i]) < 1e-5f);
            assert_true(std::abs(m.appearance.tangents[c][2] - float(p.x)) < 1e-5f);
            assert_true(std::abs(m.appearance.tangents[c][3] + 1) < 1e-6f);
        }
    }
}

/* Triangles far larger than a cell, and needles that thousands of lines would cross. */
static void large_triangles(void **)
{
    Mapped square(shapes::plane(1));
    Periodic map = square.parameterize(1 / 16.);
    Pieces pieces = cut_along_lines(square.mesh, square.edges, square.field, map);
    assert_in_range(pieces.triangle.size(), 256, 17 * 19);
    map = square.parameterize(1e-4); /* stay whole */
    pieces = cut_along_lines(square.mesh, square.edges, square.field, map);
    assert_int_equal(pieces.triangle.size(), 2);

    Mesh mesh = shapes::plane(20);
    for (Vec3d &p : mesh.positions)
        p.x = p.x < 0.5 ? 1e-3 * p.x : 1e3 + p.x;
    uint32_t count = 400;
    check_cut(mesh, cells(mesh, count));
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
            Surface surface = make_surface(cut.mesh, 1);
            std::vector<uint32_t> pieces = cut.label;
            assert_int_equal(connected_pieces(surface.whole, pieces), count);
        }
}

static void small_meshes(void **)
{
    Mesh one;
    one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    one.triangles = {{0, 1, 2}};
    uint32_t count = 1;
    check_cut(one, cells(one, count));
    assert_int_equal(count, 1);

    Mesh many; /* each a component, and less than a chart was meant to be */
    for (int i = 0; i < 300; ++i)
        many = shapes::both(many, one, {2. * i, 0, 0});
    count = 10;
    check_cut(many, cells(many, count));
    assert_int_equal(count, 300);

    Mesh box = shapes::cube(1);
    for (uint32_t wanted : {1u, 6u, 12u}) {
        count = wanted;
        check_cut(box, cells(box, count));
        assert_in_range(count, 1, 12);
    }
}

static gtx_result result_of(const Mesh &mesh)
{
    uint32_t count = 20;
    try {
        cells(mesh, count);
    } catch (const Error &e) {
        return e.result;
    }
    return GTX_OK;
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
    Mesh mesh = shapes::both(shapes::bumpy_sphere(20), shapes::torus(20, 0.3), {4, 0, 0});
    uint32_t count = 50, other = 50;
    CutMesh cut = cells(mesh, count, 1), again = cells(mesh, other, 4);
    assert_true(again.label == cut.label && again.mesh.positions == cut.mesh.positions);
    assert_true(again.mesh.triangles == cut.mesh.triangles);
    assert_int_equal(other, count);
    for (Vec3d &v : mesh.positions)
        v *= 8;
    other = 50;
    assert_true(cells(mesh, other).label == cut.label);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(singularities_add_up), cmocka_unit_test(turns_agree),
        cmocka_unit_test(quarters_turn_back), cmocka_unit_test(the_field_follows_the_curvature),
        cmocka_unit_test(the_field_does_not_lean),
        cmocka_unit_test(lines_meet), cmocka_unit_test(regular_maps),
        cmocka_unit_test(plane_is_squares), cmocka_unit_test(cuts_keep_the_surface),
        cmocka_unit_test(pieces_keep_to_their_cells), cmocka_unit_test(charts_are_squares),
        cmocka_unit_test(attributes_are_interpolated), cmocka_unit_test(large_triangles),
        cmocka_unit_test(wanted_count),
        cmocka_unit_test(small_meshes), cmocka_unit_test(degenerate_meshes),
        cmocka_unit_test(same_answer)};
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
