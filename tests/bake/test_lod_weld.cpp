/* Welding: pieces of a surface, each of one patch, become one where their borders meet. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

#include "bake/lod/fields.hpp"
#include "bake/lods.hpp"

using namespace gtx;
using namespace gtx::baking;

/* The maps of [0, 1]^2 at z = 0 in two patches, which part at x = 0.5; no surface where `hole`
 * says so. A texel is 1/64. */
struct Halves {
    Maps maps;
    Vector<MapField> fields;
    Vector<Vector<uint32_t>> others;

    explicit Halves(const std::function<bool(const Vec3d &)> &hole)
    {
        Task task(2, nullptr, nullptr, {"bake", "pack", "lod"}, {1, 1, 1});
        const Mesh whole = shapes::field(32, [](double u, double v) { return Vec3d(u, v, 0); });
        auto centre = [&](const Mesh &of, size_t t) {
            return (of.position(t, 0) + of.position(t, 1) + of.position(t, 2)) / 3;
        };
        Mesh mesh = whole;
        mesh.triangles.clear();
        mesh.normals.clear();
        for (size_t t = 0; t < whole.triangle_count(); ++t)
            if (!hole(centre(whole, t)))
                mesh.triangles.push_back(whole.triangles[t]);
        shapes::add_normals(mesh);
        Partition partition = shapes::split(mesh, [&](size_t t) {
            return centre(mesh, t).x > 0.5;
        }, 64);
        maps = bake(mesh, partition, {}, task);
        fields = map_fields(maps);
        others = touching(fields);
    }

    /* What welding makes of two pieces of them. */
    LodSource welded(Vector<FieldPiece> pieces) const
    {
        for (FieldPiece &piece : pieces)
            for (Vec3d &p : piece.positions)
                p = p - Vec3d(maps.anchor[0], maps.anchor[1], maps.anchor[2]);
        return weld(fields, std::move(pieces), others);
    }
};

static bool nowhere(const Vec3d &)
{
    return false;
}

/* `columns` x `rows` squares from x = low to high, without those at which `hole`. Every vertex is
 * taken for one of the border, as those are that cut_field leaves in a narrow piece. */
static FieldPiece grid(double low, double high, uint32_t columns, uint32_t rows,
                       const std::function<bool(const Vec3d &)> &hole)
{
    FieldPiece piece;
    for (uint32_t j = 0; j <= rows; ++j)
        for (uint32_t i = 0; i <= columns; ++i)
            piece.positions.push_back({low + (high - low) * i / columns, double(j) / rows, 0});
    for (uint32_t j = 0; j < rows; ++j)
        for (uint32_t i = 0; i < columns; ++i) {
            const uint32_t a = j * (columns + 1) + i, b = a + 1, c = a + columns + 1, d = c + 1;
            if (hole((piece.positions[a] + piece.positions[d]) / 2))
                continue;
            piece.triangles.push_back({a, b, d});
            piece.triangles.push_back({a, d, c});
        }
    piece.normals.assign(piece.positions.size(), {0, 0, 1});
    piece.at_border.assign(piece.positions.size(), 1);
    return piece;
}

static lods::Edges edges_of(const LodSource &source)
{
    LodLevel level;
    for (const Triangle &t : source.triangles)
        level.indices.insert(level.indices.end(), t.begin(), t.end());
    return lods::count_edges(level);
}

static double area_of(const LodSource &source)
{
    double area = 0;
    for (const auto &[a, b, c] : source.triangles)
        area += cross(source.positions[b] - source.positions[a],
                      source.positions[c] - source.positions[a]).z / 2;
    return area;
}

/* Where one piece has a vertex and the other none the edge there is split. */
static void borders_of_other_steps_become_one(void **)
{
    const Halves maps(nowhere);
    const LodSource both = maps.welded({grid(0, 0.5, 4, 8, nowhere),
                                        grid(0.5, 1, 4, 12, nowhere)});
    assert_true(std::fabs(area_of(both) - 1) < 1e-9);
    const lods::Edges edges = edges_of(both);
    assert_int_equal(edges.crowded, 0);
    assert_int_equal(edges.open, 8 + 8 + 8 + 12);
    /* They have 5 vertices in common: 4 others of the one split edges, and 8 of the other. */
    assert_int_equal(both.triangles.size(), 2 * 4 * 8 + 2 * 4 * 12 + 4 + 8);
}

/* As rounding to texels moves them, but no farther, and not to a surface that faces away. */
static void only_near_vertices_are_joined(void **)
{
    const Halves maps(nowhere);
    const double pitch = maps.fields[0].fine_texel();
    auto open_at = [&](double away, const Vec3d &normal) {
        FieldPiece other = grid(0.5 + away * pitch, 1, 4, 8, nowhere);
        other.normals.assign(other.positions.size(), normal);
        return edges_of(maps.welded({grid(0, 0.5, 4, 8, nowhere), other})).open;
    };
    assert_int_equal(open_at(0, {0, 0, 1}), 2 * (8 + 8));
    assert_int_equal(open_at(0.45, {0, 0, 1}), 2 * (8 + 8));
    assert_int_equal(open_at(0.55, {0, 0, 1}), 2 * 2 * (4 + 8));
    assert_int_equal(open_at(0, {0, 0, -1}), 2 * 2 * (4 + 8));
}

/* What the pieces leave out is closed where a height field shows it, and is the model's own
 * elsewhere. */
static void gaps_are_closed_and_holes_stay(void **)
{
    auto hole = [](const Vec3d &p) {
        return std::fabs(p.x - 0.25) < 0.0625 && std::fabs(p.y - 0.5) < 0.0625;
    };
    for (bool is_gap : {true, false}) {
        const Halves maps(is_gap ? nowhere : std::function<bool(const Vec3d &)>(hole));
        const LodSource both = maps.welded({grid(0, 0.5, 8, 16, hole),
                                            grid(0.5, 1, 8, 16, nowhere)});
        const lods::Edges edges = edges_of(both);
        assert_int_equal(edges.crowded, 0);
        assert_int_equal(edges.open, 2 * (16 + 16) + (is_gap ? 0 : 8));
        assert_true(std::fabs(area_of(both) - (is_gap ? 1 : 1 - 0.125 * 0.125)) < 1e-9);
    }
}

/* One square of both pieces: it is there once. */
static void what_two_pieces_claim_is_there_once(void **)
{
    const Halves maps(nowhere);
    const FieldPiece other = grid(0.375, 1, 5, 8, [](const Vec3d &p) {
        return p.x < 0.5 && std::fabs(p.y - 0.4375) > 0.01;
    });
    const LodSource both = maps.welded({grid(0, 0.5, 4, 8, nowhere), other});
    const lods::Edges edges = edges_of(both);
    assert_int_equal(edges.crowded, 0);
    assert_int_equal(edges.open, 2 * (8 + 8));
    assert_int_equal(both.triangles.size(), 2 * 8 * 8);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(borders_of_other_steps_become_one),
        cmocka_unit_test(only_near_vertices_are_joined),
        cmocka_unit_test(gaps_are_closed_and_holes_stay),
        cmocka_unit_test(what_two_pieces_claim_is_there_once),
    };
    return cmocka_run_group_tests_name("welding", tests, nullptr, nullptr);
}
