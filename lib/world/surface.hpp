/* The surface of one tile in memory: its own triangles, then the ring of its neighbours'. */
#pragma once

#include "world/cell.hpp"

#include <memory>

namespace gtx {

/* Corners that have all alike are one vertex; `place` names the first vertex at the same
 * position. */
struct TileSurface {
    CornerTraits traits;
    CellHeader header;               /* of the cell file */
    Vector<Vec3d> positions;
    Vector<Vec3f> normals;           /* a vertex each; those of places where the cell has none */
    Vector<Rgba8> colors;
    Vector<CornerLook> looks;        /* where it is textured */
    Vector<uint32_t> place;
    Vector<std::array<uint32_t, 3>> triangles;
    Vector<Rgba8> seen;              /* a triangle each: its textures' mean, once painted */
    size_t own = 0;                  /* triangles that are the tile's own */

    Corner corner(uint32_t vertex) const
    {
        return {positions[vertex], normals[vertex], colors[vertex]};
    }
};

/* The tile's cell file, and its ring: triangles of the files around that share a position with
 * its own. For a leaf these are the other leaves'; for others the low surfaces next to its
 * children's. */
TileSurface load_surface(const Plan &plan, const Tile &tile, Task &task);
/* A surface of one file alone. */
TileSurface load_cell(const std::string &path);

/* As a binary PLY file, which the cooker reads; without textures. */
std::string ply_of(const TileSurface &surface);

/* Of surfaces made for parents: what textures show has become colours. */
inline CornerTraits low_traits(const CornerTraits &of)
{
    return {of.doubles, true, of.colors || of.textured, false};
}

/* The tile's own triangles, as few of them as `wanted` where that can be: vertices on their common
 * border stay, and those that are left are the surface's. A position has one normal and one colour,
 * the mean; of a painted surface the mean of what is seen around it. */
struct LowSurface {
    CellWriter cell;
    double deviation = 0;            /* from `surface`, as measured */
};
class NearSurface;
LowSurface simplify_surface(const TileSurface &surface, NearSurface &near, size_t wanted,
                            Task &task);

/* ---- distances ---- */

/* Triangles to measure from and to. */
struct Sheet {
    Vector<Vec3d> positions;
    Vector<std::array<uint32_t, 3>> triangles;
};
Sheet sheet_of(const TileSurface &surface, size_t triangles);
/* A tile's surface, from the first on ready for several of them. It outlives this. */
class NearSurface {
public:
    NearSurface(const TileSurface &surface, Task &task);
    ~NearSurface();
    /* The farthest that points of either are from the other: vertices and centres of triangles, as
     * many as take little time. The ring is asked for none, and counts where `with_ring`. */
    double distance_to(const Sheet &sheet, bool with_ring);

private:
    struct Tree;
    const TileSurface &surface_;
    Task &task_;
    std::unique_ptr<Tree> tree_;
};
/* The weights of a triangle's corners at the point of it nearest to p, about. */
Vec3d weights_at(const Vec3d &p, const Vec3d &a, const Vec3d &b, const Vec3d &c);
/* The triangle of the sheet that is nearest to each point. */
Vector<uint32_t> nearest_triangles(const Vector<Vec3d> &points, const Sheet &sheet, Task &task);

/* ---- plain meshes ---- */

/* A GLB of the mesh, with normals and colours of the surface's nearest points; seen from both sides
 * unless the whole is closed. */
std::string glb_of(const Sheet &mesh, const TileSurface &surface, bool closed, Task &task);

} // namespace gtx
