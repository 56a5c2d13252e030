/* The surface peeled along few directions (Santos, de Toledo, Gattass, Solid height-map sets, SPM
 * 2008): each part of it faces one of three axes or its opposite. What lies above itself there is
 * split into layers, and a chart is a connected piece of a layer, or several small ones. */
#pragma once

#include "chart/split.hpp"

namespace gtx {

/* The axes of the object and their opposites. */
Vector<Vec3d> object_directions();

/* Three axes and their opposites, front and back in pairs: those of the object, unless the surface
 * faces three others that are square to each other clearly better. */
Vector<Vec3d> peel_directions(const Surface &surface);

/* Which of some directions a vector is nearest to; the first of equals. */
size_t nearest_direction(const Vector<Vec3d> &directions, const Vec3d &vector);

/* Connected pieces of triangles that face the same of six directions: a label a triangle, and their
 * number in `count`. Normals that smoothing has turned away from their triangles' are these' own
 * again. `pitch` is the expected size of a texel. */
Vector<uint32_t> peel(Surface &surface, const Vector<Vec3d> &directions, double pitch,
                      uint32_t &count, Task &task);

/* Puts small charts of one direction that lie beside each other, none above another, into one
 * chart where that takes fewer texels: the leaves of a tree, the links of a chain. `grain` and
 * `side` are of CutPlan. */
void gather_charts(const Surface &surface, const Bounds &bounds, unsigned grain, unsigned side,
                   Vector<Region> &regions, Vector<Frame> &frames);

/* Which of object_directions() sees each triangle best, through a grid of `resolution` texels along
 * the longest side of the box; their number where none sees it. */
Vector<uint32_t> see_from_sides(const Surface &surface, unsigned resolution, Task &task);

} // namespace gtx
