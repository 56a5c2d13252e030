/* Triangles cut along integer lines: nothing lost, nothing open, straight sides, attributes. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "mapped.hpp"

#include <algorithm>
#include <set>

using namespace gtx;

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
    const int count = int((edges.size() + single) / 2);
    return {border, int(used.size()) - count + int(mesh.triangle_count())};
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
    Vector<double> covered(mesh.triangle_count());
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
          shapes::helicoid(30, 3),
          shapes::both(shapes::sphere(16), shapes::plane(20), {4, 0, 0})}) {
        Mapped m(mesh);
        for (double count : {10., 100., 1000.}) {
            Periodic map = m.parameterize(m.cell_for(count));
            Pieces pieces = cut_along_lines(mesh, m.edges, m.field, map);
            check_cut(mesh, cut_mesh(mesh, pieces,
                                     Vector<uint32_t>(pieces.triangle.size())));
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
        Vector<Uv> cell(pieces.triangle.size());
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
    Vector<Box> boxes(count);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cuts_keep_the_surface), cmocka_unit_test(pieces_keep_to_their_cells),
        cmocka_unit_test(charts_are_squares), cmocka_unit_test(attributes_are_interpolated),
        cmocka_unit_test(large_triangles), cmocka_unit_test(small_meshes)};
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
