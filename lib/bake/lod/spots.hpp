/* The few spots of the source that a level is far from, beside the rest. */
#pragma once

#include "bake/lod/level.hpp"

namespace gtx::baking {

/* A point of the source where there should be a vertex: one that is far from the level, or the
 * nearest to one of the level that is far from the source. */
struct FarPoint {
    Vec3d at;
    Corners source;              /* the triangle that it is of */
    uint32_t patch;              /* of that */
    uint32_t near;               /* the level's triangle: the nearest, or that which is far */
    double away;                 /* how far */
    uint32_t vertex = NO_VERTEX; /* the level's that is far itself */
};

/* Gives the level vertices at such points, or moves one of its own there, the farthest first, where
 * that can be; how near is near enough is `most`. Returns what it changed, as that was. */
Vector<Corners> reach_spots(LevelMesh &mesh, Vector<FarPoint> spots, double most,
                            const Vector<PatchRegion> &regions, const Lattice &lattice);

} // namespace gtx::baking
