/* A chart laid out flat: the working grid in which its height field is made. */
#pragma once

#include "chart/chart.hpp"

#include <algorithm>

namespace gtx::baking {

using Neighbours = Vector<std::array<uint32_t, 3>>;

/* The working grid of a chart: texel space (u, v, c), where texel (i, j) lies at u = i, v = j, and
 * c stays in object units along the frame's z. */
struct Grid {
    Vec3d origin;          /* of the frame */
    Vec3d dual[3];         /* reciprocal axes: local coordinate k is dot(dual[k], p - origin) */
    double pitch[2] = {};  /* object units a texel */
    double corner[2] = {}; /* local (a, b) of the outer corner of texel (0, 0) */
    int w = 0, h = 0;
    bool aligned[2] = {};  /* the core's sides lie on texels, not midway between two */
    double clip_low[2] = {}, clip_high[2] = {}; /* of the core, texel space; infinite: none */

    /* How far (u, v) lies outside the straight cuts; negative inside. */
    double outside(double u, double v) const
    {
        return std::max(std::max(clip_low[0] - u, u - clip_high[0]),
                        std::max(clip_low[1] - v, v - clip_high[1]));
    }
    Vec3d texel(const Vec3d &point) const
    {
        Vec3d p = point - origin;
        return {(dot(dual[0], p) - corner[0]) / pitch[0] - 0.5,
                (dot(dual[1], p) - corner[1]) / pitch[1] - 0.5, dot(dual[2], p)};
    }
    double coarse_pitch() const { return pitch[0] > pitch[1] ? pitch[0] : pitch[1]; }
    size_t texels() const { return size_t(w) * h; }
};

/* A triangle of the chart (or of its overlap) in texel space. */
struct FlatTriangle {
    Vec3d corner[3];
    uint32_t source;       /* its index in the mesh */
    bool front;            /* faces the frame, so that it can be seen in the map */

    /* Twice its area in texels; negative where it faces away. */
    double signed_area() const
    {
        Vec3d e = corner[1] - corner[0], f = corner[2] - corner[0];
        return e.x * f.y - e.y * f.x;
    }
};

/* The true surface of a chart: first `core` triangles of its own, then those of its overlap. */
struct FlatChart {
    Grid grid;
    Vector<FlatTriangle> triangles;
    size_t core = 0;
    size_t of = 1; /* so many charts it is one: the share it has of what all may take */
    /* mate[t][k] is the index here of the front-facing triangle across edge k, or NO_TRIANGLE. */
    Neighbours mate;
};

/* Whether the plane of the triangle beyond an edge of the model turns down from this one's sharply.
 */
bool is_crease(const Mesh &mesh, const Neighbours &neighbours, uint32_t triangle, int side);

/* Lays a chart out at the model's pitch, or `finer` times as fine. */
FlatChart flatten(const Mesh &mesh, const Neighbours &neighbours, const Chart &chart, double pitch,
                  double finer);
/* The same triangles in another number of cells, those that the chart has now. */
void flatten_again(const Mesh &mesh, const Chart &chart, FlatChart &flat);

} // namespace gtx::baking
