/* What it costs to move a vertex: squared distances to planes (Garland and Heckbert 1997). */
#pragma once

#include "bake/lod/fan.hpp"
#include "mesh/task.hpp"
#include "mesh/vec.hpp"

#include <algorithm>
#include <cmath>

namespace gtx::baking {

/* Sum of squared distances to planes, times their weights. */
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, x = 0, y = 0, z = 0, c = 0, weight = 0;

    void add_plane(const Vec3d &n, double d, double w)
    {
        xx += w * n.x * n.x, xy += w * n.x * n.y, xz += w * n.x * n.z;
        yy += w * n.y * n.y, yz += w * n.y * n.z, zz += w * n.z * n.z;
        x += w * n.x * d, y += w * n.y * d, z += w * n.z * d;
        c += w * d * d;
    }
    void add(const Quadric &q)
    {
        xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
        x += q.x, y += q.y, z += q.z, c += q.c, weight += q.weight;
    }
    /* Mean squared distance at a point. */
    double at(const Vec3d &p) const
    {
        double rx = xx * p.x + 2 * (xy * p.y + xz * p.z + x);
        double ry = yy * p.y + 2 * (yz * p.z + y);
        double rz = zz * p.z + 2 * z;
        double sum = rx * p.x + ry * p.y + rz * p.z + c;
        return weight > 0 ? std::max(sum, 0.0) / weight : 0;
    }
    /* From a point to where the mean plus `stay` times the squared way from there is least; nowhere
     * where areas are so small that their cubes are 0. */
    Vec3d way_down(const Vec3d &p, double stay) const
    {
        if (!(weight > 0))
            return {0, 0, 0};
        const double s = stay * weight;
        const Vec3d a = {xx + s, xy, xz}, b = {xy, yy + s, yz}, d = {xz, yz, zz + s};
        const Vec3d down = {-(xx * p.x + xy * p.y + xz * p.z + x),
                            -(xy * p.x + yy * p.y + yz * p.z + y),
                            -(xz * p.x + yz * p.y + zz * p.z + z)};
        const double det = dot(cross(a, b), d); /* at least s^3 */
        const Vec3d way =
            Vec3d{dot(down, cross(b, d)), dot(down, cross(d, a)), dot(down, cross(a, b))} / det;
        return std::isfinite(way.x + way.y + way.z) ? way : Vec3d{0, 0, 0};
    }
};

/* Of each vertex the planes of its triangles, by their area; at open borders also planes that stand
 * on the edge. Vertex v has the triangles around[start[v]] to around[start[v + 1] - 1]. */
Vector<Quadric> vertex_quadrics(const Vector<Vec3d> &positions,
                                const Vector<Triangle> &triangles,
                                const Vector<uint32_t> &start,
                                const Vector<uint32_t> &around, Task &task);

} // namespace gtx::baking
