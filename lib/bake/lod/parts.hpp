/* The inside of the LOD mesh's making: where a patch has normals, and fewer triangles. */
#pragma once

#include "bake/height_field.hpp"
#include "bake/lod/lod.hpp"

#include <memory>

namespace gtx::baking {

/* Of a triangle. */
using Corners = std::array<Vec3d, 3>;

/* Where a triangle of a patch may lie in its maps. */
class PatchRegion {
public:
    PatchRegion() = default;
    PatchRegion(const Maps &maps, uint32_t patch);

    /* Texel (i, j) of the patch covers i..i+1, j..j+1. */
    std::array<double, 2> place(const Vec3d &point) const
    {
        return {dot(row_[0], point) + shift_[0], dot(row_[1], point) + shift_[1]};
    }
    /* Whether the patch has a normal at every texel that the triangle touches. */
    bool holds(const std::array<double, 2> (&corner)[3]) const;
    /* Whether it has one at this place. */
    bool holds(const std::array<double, 2> &place) const;
    /* Whether a triangle that changes stays where the patch can show it. One that never was there
     * may go anywhere; several that cover the same area as before are where they were. */
    bool keeps(const Corners &before, const Corners &after, bool same_area) const;
    /* Whether this is on the patch's rectangle, or at most half a texel beside it. */
    bool near(const std::array<double, 2> &place) const
    {
        return place[0] >= -0.5 && place[1] >= -0.5 && place[0] <= w_ + 0.5 &&
               place[1] <= h_ + 0.5;
    }

private:
    Vec3d row_[2];
    double shift_[2] = {};
    int w_ = 0, h_ = 0;
    Vector<uint8_t> clear_;      /* texels to the nearest one without a normal; 0: has none */
};

Vector<PatchRegion> patch_regions(const Maps &maps, Task &task);

/* Twice the area, positive when the corners go round as the patch sees them. */
inline double winding(const std::array<double, 2> (&c)[3])
{
    return (c[1][0] - c[0][0]) * (c[2][1] - c[0][1]) - (c[1][1] - c[0][1]) * (c[2][0] - c[0][0]);
}

/* The straight cuts around a chart's core, in texels of its grid. */
class ChartCuts {
public:
    ChartCuts() = default;
    ChartCuts(const Chart &chart, const Vec3d &anchor);

    bool any() const { return any_; }
    /* The core is the rectangle 0..size; `point` is relative to the anchor. */
    std::array<double, 2> place(const Vec3d &point) const
    {
        return {dot(row_[0], point) + shift_[0], dot(row_[1], point) + shift_[1]};
    }
    /* How far a place lies outside the core; negative inside. */
    double outside(const std::array<double, 2> &place) const;
    /* How far it lies beyond a side, the low or high one along an axis; -infinity: not cut
     * there. */
    double beyond(const std::array<double, 2> &place, int axis, bool high) const
    {
        return high ? place[axis] - high_[axis] : low_[axis] - place[axis];
    }

private:
    Vec3d row_[2];
    double shift_[2] = {}, size_[2] = {};
    double low_[2] = {-INFINITY, -INFINITY}, high_[2] = {INFINITY, INFINITY};
    bool any_ = false;
};

/* Splits those triangles of `source` that reach so far across a cut that their patch cannot show
 * them. Its triangles are numbered as those of the mesh, `cuts` and `regions` as the patches. */
void split_at_cuts(const Partition &partition, const Maps &maps, const Vector<ChartCuts> &cuts,
                   const Vector<PatchRegion> &regions, LodSource &source, Task &task);

constexpr uint32_t NO_PATCH = 0xffffffffu, NO_VERTEX = 0xffffffffu;

/* Takes vertices away, cheapest first. */
class Simplifier {
public:
    Simplifier(const LodSource &source, const Vector<PatchRegion> &regions, Task &task);
    ~Simplifier();

    /* Goes on until `wanted` triangles are left, and on from there while that costs no more than an
     * error of `free`; stops where it would cost more than `most`. */
    void reduce(size_t wanted, double free, double most);

    /* From now on triangles need not lie in their patches. */
    void cross_patches();

    /* Moves the vertices that are left to where they are nearest to the surface that they stand
     * for: merging alone cuts all that bulges off. Then, while triangles lie in their patches, out
     * to what is still outside. */
    void settle();

    /* Takes triangles away, a value each. */
    void drop(const Vector<uint8_t> &dropped);

    const Vector<Vec3d> &positions() const;
    const Vector<std::array<uint32_t, 3>> &triangles() const;
    const Vector<uint32_t> &patch() const;
    const Vector<uint8_t> &kept() const; /* as in LodSource */
    /* The greatest at a vertex, so far, when they settled: root of the mean square of the distances
     * to the planes that it stands for. The farthest point of the source is up to three times as
     * far away. */
    double error() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/* Of triangles that cross patches: in which patch each is looked up. */
Vector<uint32_t> find_far_homes(const Simplifier &simplified, const Maps &maps,
                                const Vector<PatchRegion> &regions, Task &task);

/* Of each triangle the diagonal of the box of its connected part. */
Vector<double> part_sizes(const Vector<Vec3d> &positions,
                          const Vector<std::array<uint32_t, 3>> &triangles);

} // namespace gtx::baking
