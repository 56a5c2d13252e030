/* Frames of charts: the axis of projection, the rectangle around it, the tilt. */
#pragma once

#include "chart/chart.hpp"
#include "chart/surface.hpp"

namespace gtx {

/* A unit vector across `z`. */
Vec3d any_perpendicular(const Vec3d &z);

/* The component-wise median of the triangles' normals, normalised (paper, section 5). `normals`,
 * where they are known, are the raw ones of all triangles of the mesh. */
Vec3d median_axis(const Mesh &mesh, const Vector<uint32_t> &triangles,
                  const Vector<Vec3f> *normals = nullptr);

/* The axis of the smallest cone around the smoothed normals, but for the most deviant 0.5 % of
 * the area. */
Vec3d cone_axis(const Surface &surface, const Vector<uint32_t> &triangles);

/* The frame along unit `z`: the rectangle of least area, longer side first, tilted where that
 * takes away height. */
Frame make_frame(const Mesh &mesh, const Vector<uint32_t> &triangles, const Vec3d &z);

/* The frame of the same axis and tilt, turned by `radians` about z. */
Frame turned_frame(const Mesh &mesh, const Vector<uint32_t> &triangles, const Frame &frame,
                   double radians);

/* The part of a frame between `low` and `high` along its x and y, tilted where that takes height
 * from `points`, which are in the frame's coordinates. */
Frame part_of_frame(const Frame &whole, const double low[2], const double high[2],
                    const Vector<Vec3d> &points);

/* Affine coordinates in a frame, for many points. */
struct FrameInverse {
    Vec3d origin, rows[3];
    explicit FrameInverse(const Frame &frame);
    Vec3d operator()(const Vec3d &point) const
    {
        Vec3d d = point - origin;
        return {dot(d, rows[0]), dot(d, rows[1]), dot(d, rows[2])};
    }
};

} // namespace gtx
