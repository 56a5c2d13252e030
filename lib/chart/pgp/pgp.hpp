/* Periodic global parameterization (Ray, Li, Levy, Sheffer, Alliez 2006; paper, section 5.1). */
#pragma once

#include "chart/surface.hpp"
#include "mesh/edges.hpp"

namespace gtx {

/* Half-edges, and how a direction is carried across them. A corner is the half-edge that leaves it.
 * Angles in a triangle count from its first edge, counter-clockwise. */
struct HalfEdges {
    Vector<uint32_t> opposite;       /* a half-edge; NO_EDGE at a border */
    Vector<uint32_t> vertex;         /* a corner; a vertex here is one fan of triangles */
    Vector<uint32_t> first;          /* a vertex: the corner where a turn to the left begins */
    Vector<double> direction;        /* a half-edge: its angle */
    Vector<double> length;           /* a half-edge */

    /* The next corner of the same vertex, counter-clockwise; NO_EDGE past a border. */
    uint32_t left_of(uint32_t corner) const { return opposite[previous_edge(corner)]; }
    /* The triangle's angle at a corner. */
    double angle(uint32_t corner) const;
    /* What an edge counts for in Laplace's equation: the mean cotangent of the angles that face it,
     * or a little where that would push its ends apart. */
    double weight(uint32_t half_edge) const;
    /* An angle here plus this is the same direction in the triangle across. */
    double transport(uint32_t half_edge) const;
};
HalfEdges make_half_edges(const Surface &surface);

/* Around each vertex, the normal cycle's measure of curvature (Cohen-Steiner, Morvan 2003): each
 * edge bends by its dihedral angle, in its own direction. An edge counts at both its ends. */
using Tensor = std::array<double, 9>; /* symmetric */
Vector<Tensor> vertex_curvatures(const Surface &surface, const HalfEdges &edges);

/* Four directions a triangle, a quarter turn apart, that follow the surface's curvature. */
struct CrossField {
    Vector<double> angle;        /* a triangle: of its first direction */
    Vector<uint8_t> turn;        /* a half-edge: quarter turns from the first direction, carried
                                    across, to that of the triangle there */
    Vector<double> bend;         /* a half-edge: what is left then to turn, at most an eighth */
    Vector<int> index;           /* a vertex: quarter turns that the field makes around it; 0 where
                                    it is regular or on a border */
};
CrossField make_cross_field(const Surface &surface, const HalfEdges &edges);

/* How long a cell is to be at each vertex, against the mean, for the directions to be gradients. */
Vector<double> make_scale(const HalfEdges &edges, const CrossField &field);
/* Makes them shorter where the surface is more curved, down to half, and longer where it is less,
 * up to twice; for cells of about this mean length. */
void adapt_scale(const Surface &surface, const HalfEdges &edges, double cell,
                 Vector<double> &scale);

/* Coordinates in a triangle's directions, as those turned by quarters to the left see them. */
using Uv = std::array<double, 2>;
Uv turned(const Uv &uv, unsigned quarters);

/* Arithmetic: coordinates are multiples of this, so that sums with whole numbers are exact. */
constexpr double UV_GRID = 1. / (uint64_t(1) << 40);
inline double on_grid(double coordinate)
{
    return std::round(coordinate / UV_GRID) * UV_GRID;
}

/* A parameterization: integer lines of u and v follow the directions, a cell apart. */
struct Periodic {
    Vector<Uv> uv;                  /* a corner. Across an edge they are the same but for a turn
                                       and whole numbers, exactly, between regular triangles */
    Vector<uint8_t> singular;       /* a triangle */
};

/* Throws Error: INPUT, CANCELLED. */
Periodic parameterize(const HalfEdges &edges, const CrossField &field,
                      const Vector<double> &scale, double cell);

/* The triangles, cut along the integer lines where they are regular: convex pieces in the order of
 * their triangles. */
constexpr uint32_t NO_PIECE = 0xffffffffu;
struct PieceCorner {
    uint32_t vertex; /* of the mesh, then of the points */
    std::array<float, 3> weight; /* of the triangle's corners */
};
struct Seam {
    uint32_t piece[2]; /* on its sides; NO_PIECE beyond a border */
    float length;
    bool line;         /* it lies on an integer line, or around what is singular */
};
struct Pieces {
    Vector<uint32_t> triangle;        /* a piece: what it is of */
    Vector<uint32_t> first;           /* a piece: its first corner; all corners' number at last */
    Vector<PieceCorner> corners;      /* in the order of the triangle's */
    Vector<Vec3d> points;             /* vertices that the mesh had not */
    Vector<Seam> seams;
};

/* Throws Error: LIMIT. */
Pieces cut_along_lines(const Mesh &mesh, const HalfEdges &edges, const CrossField &field,
                       const Periodic &map);

/* A mesh whose triangles are cut where charts end. */
struct CutMesh {
    Mesh mesh;
    Vector<uint32_t> source;      /* a triangle: what it is of, ascending */
    Vector<uint32_t> label;       /* a triangle */
};

/* `label` is of pieces. */
CutMesh cut_mesh(const Mesh &mesh, const Pieces &pieces, const Vector<uint32_t> &label);

/* Partitions the surface into about `count` connected charts: squares of the parameterization, and
 * what lies around its singularities where that is as large. Where `adaptive`, they are smaller
 * where the surface is more curved. `count` becomes their number. Throws Error: LIMIT, INPUT,
 * CANCELLED. */
CutMesh square_cells(const Surface &surface, uint32_t &count, bool adaptive, Task &task);

} // namespace gtx
