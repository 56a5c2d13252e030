/* How far points are from triangles. */
#include "mesh/nearest.hpp"

namespace gtx {

static double segment_distance2(const Vec3d &from_start, const Vec3d &edge)
{
    double square = dot(edge, edge);
    double s = square > 0 ? std::clamp(dot(from_start, edge) / square, 0., 1.) : 0;
    Vec3d off = from_start - edge * s;
    return dot(off, off);
}

/* Where p is over the triangle (by its barycentric coordinates v and w, times `area`) to the plane,
 * else to those sides that p is outside of. Rounding may pick another point of the triangle, never
 * one beside it. */
double triangle_distance2(const Vec3d &p, const Vec3d &a, const Vec3d &b, const Vec3d &c)
{
    const Vec3d ab = b - a, ac = c - a, d = p - a;
    double bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac), db = dot(d, ab), dc = dot(d, ac);
    double area = bb * cc - bc * bc, v = cc * db - bc * dc, w = bb * dc - bc * db;
    bool flat = !(area > 0);
    if (!flat && v >= 0 && w >= 0 && v + w <= area) {
        Vec3d off = d - ab * (v / area) - ac * (w / area);
        return dot(off, off);
    }
    double best = std::numeric_limits<double>::infinity();
    if (flat || w < 0)
        best = segment_distance2(d, ab);
    if (flat || v < 0)
        best = std::min(best, segment_distance2(d, ac));
    if (flat || v + w > area)
        best = std::min(best, segment_distance2(p - b, c - b));
    return best;
}

} // namespace gtx
