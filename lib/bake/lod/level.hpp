/* A level of the LOD mesh while it is made: triangles of patches, with vertices on a lattice. */
#pragma once

#include "bake/lod/fan.hpp"
#include "bake/lod/parts.hpp"

namespace gtx::baking {

using Place = std::array<uint16_t, 3>; /* of a vertex, in steps */

/* The places that positions are rounded to. */
struct Lattice {
    float origin[3] = {0, 0, 0}, step = 0;

    /* Over the box of the points, with steps as `wanted` where so many are few enough. */
    Lattice(const Vector<Vec3d> &points, double wanted);

    Place round(const Vec3d &point) const;
    Vec3d point(const Place &place) const
    {
        return {origin[0] + double(step) * place[0], origin[1] + double(step) * place[1],
                origin[2] + double(step) * place[2]};
    }
};

struct LevelMesh {
    Vector<Triangle> triangles;
    Vector<uint32_t> patch;      /* of each triangle; NO_PATCH: it is left out */
    Vector<Place> places;        /* of each vertex */
    Vector<uint8_t> kept;        /* as in LodSource */

    /* Whether nothing of it is left. */
    bool empty() const;
    Corners corners(const Triangle &t, const Lattice &lattice) const
    {
        return {lattice.point(places[t[0]]), lattice.point(places[t[1]]),
                lattice.point(places[t[2]])};
    }
    bool collapses(const Triangle &t) const
    {
        return places[t[0]] == places[t[1]] || places[t[1]] == places[t[2]] ||
               places[t[2]] == places[t[0]];
    }
    /* Whether a level may have the triangle: it has an area, and lies on the rectangle of its patch
     * or next to it. */
    bool fits(const PatchRegion &region, const Triangle &t, const Lattice &lattice) const;
};

/* What is left, rounded, with the patch of each triangle, or NO_PATCH where none may have it. */
LevelMesh level_mesh(const Simplifier &simplified, const Vector<PatchRegion> &regions,
                     const Lattice &lattice);
/* The same where triangles reach across patches. */
LevelMesh far_level_mesh(const Simplifier &simplified, const Maps &maps,
                         const Vector<PatchRegion> &regions, const Lattice &lattice, Task &task);

/* As the asset keeps it, without the errors: triangles of each of so many patches in an order of
 * few bytes. */
LodLevel stored(const LevelMesh &mesh, size_t patches, const Lattice &lattice);

} // namespace gtx::baking
