/* One chart -> the maps of its patch. */
#pragma once

#include "asset/patch.h"
#include "bake/bake.hpp"
#include "bake/field/flatten.hpp"

namespace gtx::baking {

using Levels = Vector<Vector<uint8_t>>;

/* What ends at the outline nearest to a texel: a chart, the model itself, or a face at a convex
 * edge beyond which the next one faces away. */
enum Ending : uint8_t { AT_CHART, AT_BORDER, AT_CREASE };

/* Such an edge, relative to the anchor, and the planes that meet there: the patch's own, and the
 * other's. */
struct Crease {
    Vec3d from, to, normal, other;
};

/* The maps of one patch, `rect` still without its place on a page. */
struct PatchMaps {
    gtx_patch record = {};
    Vector<uint16_t> height;                  /* codes */
    Vector<float> room;                       /* how far each may yet rise, object units */
    Vector<uint8_t> trim;
    Vector<uint8_t> ending;                   /* as Ending */
    Vector<Crease> creases;                   /* those that a texel is near to */
    Levels normal;                            /* a level each, 2 bytes a texel */
    Levels color, material, emission;         /* 4, 4 and 3 bytes a texel, or none */
    Vec3d low, high;                          /* of the coded texels' points */
    uint64_t coded = 0;                       /* 0: nothing of the chart is there */
};

/* What every chart's bake reads. */
struct Job {
    const Mesh &mesh;
    const Neighbours &neighbours;
    const BakeOptions &options;
    AppearanceNeeds needs;
    double pitch;
    Vec3d anchor;
    size_t charts;
    bool sharp; /* texels are finer for the sake of outlines */
};

PatchMaps bake_chart(const Job &job, const Chart &chart);

/* Texels that a patch shows beyond a straight cut, the border of a tile included: the neighbour's
 * height field is along the same axis, and crosses it. Bunny: RMS +6 % at double, -0.4 % at
 * half. */
constexpr double CUT_OVERLAP = 0.15;

/* Coverage, sphere and the box of the coded texels. */
void measure_patch(unsigned height_bits, PatchMaps &maps);
/* Trim where there is no height, by the rule that readers know. */
void fill_trim(PatchMaps &maps);
/* A texel and a half inside: deeper, no cell reaches the limit, so that no depth need be told. */
constexpr float DEEPEST_TRIM = -1.5f;
/* Signed distances to the outline in texels, as codes. */
uint8_t trim_code(float distance);

/* A vector as a record keeps it, and back. */
inline void store(float out[3], const Vec3d &v)
{
    for (int k = 0; k < 3; ++k)
        out[k] = float(v[k]);
}
inline Vec3d loaded(const float v[3])
{
    return {v[0], v[1], v[2]};
}

} // namespace gtx::baking
