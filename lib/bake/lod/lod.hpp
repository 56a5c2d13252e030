/* The LOD mesh: the source surface as a few meshes of ever fewer triangles, for what is far
 * away. */
#pragma once

#include "bake/bake.hpp"
#include "bake/lod_normals.hpp"

#include <algorithm>
#include <memory>

namespace gtx {

namespace baking {
class PatchRegion;
}

/* Surface with a patch a triangle, and vertices that patches share, relative to the anchor. */
struct LodSource {
    Vector<Vec3d> positions;
    Vector<std::array<uint32_t, 3>> triangles;
    Vector<uint32_t> patch;      /* a triangle each */
    size_t model = 0;            /* triangles of the model, that levels are a share of; 0: these */
    Vector<uint8_t> kept;        /* 1: the vertex stays, until triangles may be larger than patches;
                                    or empty */
    std::shared_ptr<const Vector<baking::PatchRegion>> regions = nullptr; /* where they are known:
                                    of each patch, where it shows triangles */

    Vec3d centre(size_t triangle) const
    {
        const auto &[a, b, c] = triangles[triangle];
        return (positions[a] + positions[b] + positions[c]) / 3;
    }
};

/* One level as the asset keeps it (format/gtx.md, "LOD mesh"). */
struct LodLevel {
    float origin[3] = {0, 0, 0}, step = 0;
    float error = 0;                 /* nothing of it or of the source is farther from the other */
    float rms = 0;                   /* distance of the source's vertices from it */
    bool far = false;                /* triangles reach across patches */
    Vector<uint32_t> first;          /* of each patch, and the end */
    Vector<uint32_t> indices;        /* 3 a triangle */
    Vector<uint16_t> positions;      /* 3 a vertex */
    LodNormals normals;

    size_t triangle_count() const { return indices.size() / 3; }
    /* As gtx_create takes it, without normals; of the level's arrays, which must stay. */
    gtx_lod_mesh mesh() const
    {
        gtx_lod_mesh out = {};
        std::copy_n(origin, 3, out.origin);
        out.step = step;
        out.error = error;
        out.vertex_count = uint32_t(positions.size() / 3);
        out.triangle_count = uint32_t(triangle_count());
        out.flags = far ? GTX_LOD_FAR : 0;
        out.first = first.data();
        out.indices = indices.data();
        out.positions = positions.data();
        return out;
    }
};

/* What the charts show; `maps` is what bake made of them. A triangle has the patch of its chart; of
 * several charts that share it, that in whose core its centre lies. One that reaches farther across
 * a straight cut than the maps of its patch do is split there, its neighbours with it.
 * Deterministic for any thread count. Stage of `task`: "LOD mesh". */
LodSource lod_source(const Mesh &mesh, const Partition &partition, const Maps &maps,
                     Task &task);

/* What the maps show, without a mesh: height fields are cut where they overlap and welded along the
 * cuts. Deterministic for any thread count. Stage of `task`: "LOD mesh". */
LodSource lod_source(const Maps &maps, Task &task);

/* Simplifies the surface across all patches at once, down to at most `levels` levels, the finest
 * first, and to at most three more for models of a few pixels, whose triangles reach across
 * patches. Deterministic for any thread count. Stage of `task`: "LOD mesh". */
Vector<LodLevel> make_lod(const LodSource &source, const Maps &maps, unsigned levels,
                          Task &task);

} // namespace gtx
