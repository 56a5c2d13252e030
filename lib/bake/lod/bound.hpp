/* How far an LOD mesh strays from the surface that it was made of. */
#pragma once

#include "bake/lod/lod.hpp"
#include "mesh/nearest.hpp"

namespace gtx::baking {

/* Triangles, for NearestTree. */
struct Surface {
    const Vector<Vec3d> &positions;
    const Vector<std::array<uint32_t, 3>> &triangles;

    size_t size() const { return triangles.size(); }
    size_t looks(size_t) const { return 1; }
    std::array<Vec3d, 3> corners(size_t t) const
    {
        const auto &[a, b, c] = triangles[t];
        return {positions[a], positions[b], positions[c]};
    }
    gtx::Box box(size_t t) const
    {
        gtx::Box box;
        for (const Vec3d &p : corners(t))
            box.add(p);
        return box;
    }
    double distance2(size_t t, const Vec3d &p, double) const
    {
        const std::array<Vec3d, 3> c = corners(t);
        return triangle_distance2(p, c[0], c[1], c[2]);
    }
};

/* A surface and a tree of its triangles, which have the order of the tree. */
class SortedSurface {
public:
    SortedSurface(Vector<Vec3d> positions, Vector<std::array<uint32_t, 3>> triangles, Task &task,
                  double done);
    SortedSurface(const SortedSurface &) = delete;
    SortedSurface &operator=(const SortedSurface &) = delete;

    size_t size() const { return triangles_.size(); }
    std::array<Vec3d, 3> corners(size_t t) const { return shapes_.corners(t); }
    const NearestTree<Surface> &tree() const { return tree_; }
    /* Which of those that were given triangle t is. */
    uint32_t given(size_t t) const { return given_[t]; }

private:
    Vector<Vec3d> positions_;
    Vector<std::array<uint32_t, 3>> triangles_;
    Surface shapes_;
    NearestTree<Surface> tree_;
    Vector<uint32_t> given_;
};

/* Object units. */
struct Strayed {
    double most = 0;             /* a bound, both ways */
    double rms = 0;              /* of the surface's vertices from the level */
};

class Bounds {
public:
    /* `source` outlives it; texels are `pitch` apart. */
    Bounds(const LodSource &source, double pitch, Task &task);

    /* Parts of the source that are no longer than `speck` need not be in the level. */
    Strayed of(const LodLevel &level, double speck) const;

private:
    double pitch_;
    Task &task_;
    SortedSurface source_;
    Vector<double> parts_;       /* how long the connected part of each triangle given is */
    double largest_part_;
};

} // namespace gtx::baking
