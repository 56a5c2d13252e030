/* Whether a region can be a chart, and how to split it when it cannot. */
#pragma once

#include "chart/layers.hpp"

namespace gtx {

/* Texels of surface in a patch that is cut, at a resolution of 128. Half: RMS +60 % (Duck); double:
 * texels +89 % (bunny). */
constexpr double PATCH_TEXELS = 1400;
/* Smaller charts are small islands: not merged but attached, to whatever faces them. Half: patches
 * +4 %; double: +4 % merged, -5 % attached (truck). */
constexpr double SMALL_ISLAND_TEXELS = 64;
/* Texels of a patch beyond its chart's sides: two on each. VSA and PGP: half: patches +1 %; double:
 * patches -1 % (truck). */
constexpr double RIM = 4;
/* Of a chart's area, what may be too steep. Half: patches +2 %; double: RMS +11 % (truck). */
constexpr double STEEP_SHARE = 0.01;

/* What a chart must keep to. */
struct Bounds {
    double side;   /* longest side of its rectangle */
    double pitch;  /* texel at which layers are looked for */
    bool cone;     /* axes are those of the narrowest cone, rather than the paper's median */
    /* Unit axes to choose from, where one of them serves; empty: any. */
    Vector<Vec3d> directions = {};
};

struct Verdict {
    Frame frame;                 /* of the chart, when there are no pieces */
    Vector<Region> pieces;       /* connected, at least two; or none: the region is a chart */
};

/* The axis that a chart of some triangles is tried along first: of the bounds' directions the one
 * that they face most, or else the narrowest cone's. */
Vec3d chart_axis(const Surface &surface, const Vector<uint32_t> &triangles, const Bounds &bounds);

/* Whether a region can be a chart along unit `z`, walls left out: if it has walls, the verdict's
 * `pieces` are they and the rest, which have no axes yet. */
bool fits_along(const Surface &surface, const Region &region, const Vec3d &z, const Bounds &bounds,
                Task &task, Verdict &verdict);

/* Regions are connected. A region of one triangle is always a chart. */
Verdict judge(const Surface &surface, const Region &region, const Bounds &bounds, Task &task);

/* Core triangles with n.z <= 0 and a projected area over a texel, junk left out. */
bool is_inverted(const Surface &surface, uint32_t triangle, const Vec3d &z, double pitch);

/* Likewise, or a wall of some texels that leans back: neither belongs in a chart. `facing` is the
 * cosine of its raw normal with z. */
bool leans_back(const Surface &surface, uint32_t triangle, double facing, const Vec3d &z,
                double pitch);

/* Whether a connected part of the region, of more than `most_texels`, is too upright along unit `z`
 * for a height field to show. */
bool has_wall(const Surface &surface, const Region &region, const Vec3d &z, double pitch,
              double most_texels);

/* Forgets regions without triangles, and their frames. */
void drop_empty(Vector<Region> &regions, Vector<Frame> &frames);

} // namespace gtx
