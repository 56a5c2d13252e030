/* How far points are from the source, of which only what is near them is looked at. */
#pragma once

#include "bake/height_field.hpp"
#include "mesh/nearest.hpp"

#include <optional>

namespace gtx::baking {

class NearSource {
public:
    /* Distances above `reach`, in object units, may be told as any such one. */
    NearSource(const Job &job, double reach);
    NearSource(const NearSource &) = delete;
    NearSource &operator=(const NearSource &) = delete;

    /* A point that will be asked about, relative to the anchor. */
    void add(const Vec3d &point);
    /* Once, after the last has been added. */
    void gather(Task &task);
    /* That of a triangle as near as `enough` will do. `near` is one to try first, NO_TRIANGLE for
     * none, and becomes the nearest; `looks` as of a NearestTree. */
    double distance(const Vec3d &point, double enough, uint32_t &near, size_t &looks) const;
    /* The nearest point of the source; false where none is within reach, or `looks` are at an end.
     */
    bool find_nearest(const Vec3d &point, Vec3d &nearest, size_t &looks) const;

private:
    struct Triangles {
        Vector<std::array<Vec3d, 3>> corners;

        size_t size() const { return corners.size(); }
        size_t looks(size_t) const { return 1; }
        gtx::Box box(size_t t) const;
        double distance2(size_t t, const Vec3d &p, double) const;
    };
    using Cell = std::array<int64_t, 3>;

    int64_t coordinate(double along) const { return int64_t(std::floor(along / side_)); }
    static size_t hash(const Cell &cell);
    bool may_be_near(const std::array<Vec3d, 3> &corners) const;

    const Job &job_;
    const double reach_, side_;  /* of a cell */
    Vector<bool> marked_;        /* cells with points, by hash */
    Triangles triangles_;
    std::optional<NearestTree<Triangles>> tree_;
};

} // namespace gtx::baking
