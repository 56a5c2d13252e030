/* The surface of one tile in memory: its own triangles, then the ring of its neighbours'. */
#pragma once

#include "world/cell.hpp"

#include <memory>

namespace gtx {

/* Equal corners share a vertex; `place` is the index of the first vertex at the same position. */
struct TileSurface {
    CornerTraits traits;
    CellHeader header;               /* of the cell file */
    Vector<Vec3d> positions;
    Vector<Vec3f> normals;           /* per vertex; computed if the cell file has none */
    Vector<Rgba8> colors;
    Vector<CornerLook> looks;        /* if it is textured */
    Vector<uint32_t> place;
    Vector<std::array<uint32_t, 3>> triangles;
    Vector<Rgba8> seen;              /* per triangle: the mean of its textures, once painted */
    size_t own = 0;                  /* number of the tile's own triangles */

    Corner corner(uint32_t vertex) const
    {
        return {positions[vertex], normals[vertex], colors[vertex]};
    }
};

/* Loads a tile's cell file, and its ring: the triangles of neighbouring files that share a position
 * with it. For a leaf these are other leaves' cell files; for other tiles, the simplified surfaces
 * next to its children's. */
TileSurface load_surface(const Plan &plan, const Tile &tile, Task &task);
/* Loads one cell file, without a ring. */
TileSurface load_cell(const std::string &path);

/* The surface as the cooker takes it, without textures. */
Mesh mesh_of(const TileSurface &surface);

/* The traits of simplified surfaces: textures have become colours. */
inline CornerTraits low_traits(const CornerTraits &of)
{
    return {of.doubles, true, of.colors || of.textured, false};
}

/* The tile's own triangles, simplified to `wanted` if possible. Vertices on the border are kept,
 * and all others are vertices of the surface. A position has one normal and one colour, the mean;
 * on a painted surface, the mean of the textures around it. */
struct LowSurface {
    CellWriter cell;
    double deviation = 0;            /* measured distance from `surface` */
};
class NearSurface;
LowSurface simplify_surface(const TileSurface &surface, NearSurface &near, size_t wanted,
                            Task &task);

/* ---- distances ---- */

/* A mesh without attributes, to measure distances. */
struct PlainMesh {
    Vector<Vec3d> positions;
    Vector<std::array<uint32_t, 3>> triangles;
};
PlainMesh plain_mesh_of(const TileSurface &surface, size_t triangles);
/* A tile's surface for distance queries; the first one builds a tree, for all. The surface must
 * outlive it. */
class NearSurface {
public:
    NearSurface(const TileSurface &surface, Task &task);
    ~NearSurface();
    /* The largest distance of points of either from the other: a bounded number of vertices and
     * centres of triangles. The ring gives no points; with `with_ring` distances are to it too. */
    double distance_to(const PlainMesh &mesh, bool with_ring);
    /* The triangle of it that is nearest to each point; the ring's count, too. */
    Vector<uint32_t> nearest_to(const Vector<Vec3d> &points);
    const TileSurface &surface() const { return surface_; }

private:
    struct Tree;
    const Tree &tree();
    const TileSurface &surface_;
    Task &task_;
    std::unique_ptr<Tree> tree_;
};
/* Approximate barycentric coordinates of the point of a triangle that is nearest to p. */
Vec3d weights_at(const Vec3d &p, const Vec3d &a, const Vec3d &b, const Vec3d &c);
/* The triangle of the mesh that is nearest to each point. */
Vector<uint32_t> nearest_triangles(const Vector<Vec3d> &points, const PlainMesh &mesh, Task &task);

/* ---- plain meshes ---- */

/* A GLB of the mesh, with normals and colours of the surface's nearest points; double-sided unless
 * the world is closed. */
std::string glb_of(const PlainMesh &mesh, NearSurface &near, bool closed);

} // namespace gtx
