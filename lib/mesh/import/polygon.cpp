/* Cutting polygons into triangles: a fan where that is right, ears where it is not. */
#include "mesh/import/import.hpp"

#include <cmath>

namespace gtx {

/* Clipping ears takes time in the cube of the corners at worst, which a hostile file would choose.
 * Larger polygons are the caps of cylinders and the like, and convex. Corners looked at, for each
 * that a polygon has: a star, half of whose corners are ears, needs as many as it has. */
constexpr size_t MAX_EAR_CORNERS = 512;
constexpr size_t MAX_LOOKS = 2 * MAX_EAR_CORNERS;

namespace {
struct Point {
    double x, y;
};
} // namespace

/* Twice the signed area. */
static double turn(Point a, Point b, Point c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* The polygon along the largest component of its normal (Newell's), counter-clockwise. */
static Vector<Point> flatten(const Vector<Vec3d> &polygon)
{
    Vec3d normal;
    for (size_t i = 0; i < polygon.size(); ++i) {
        /* From the first corner, since far from the origin the products would cancel. */
        Vec3d a = polygon[i] - polygon[0], b = polygon[(i + 1) % polygon.size()] - polygon[0];
        normal += cross(a, b);
    }
    int axis = 0;
    for (int i = 1; i < 3; ++i)
        if (std::abs(normal[i]) > std::abs(normal[axis]))
            axis = i;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (normal[axis] < 0)
        std::swap(u, v);
    Vector<Point> flat;
    for (const Vec3d &p : polygon)
        flat.push_back({p[u] - polygon[0][u], p[v] - polygon[0][v]});
    return flat;
}

static bool is_convex(const Vector<Point> &flat)
{
    size_t n = flat.size();
    for (size_t i = 0; i < n; ++i)
        if (!(turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) > 0))
            return false;
    return true;
}

static bool inside(Point p, Point a, Point b, Point c)
{
    auto same = [&](Point q) { return p.x == q.x && p.y == q.y; };
    return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0 && !same(a) && !same(b) &&
           !same(c);
}

/* Meisters, "Polygons have ears", 1975. A polygon that crosses itself may have none left, or show
 * one too late; then the corner at hand is cut off, so that the count of triangles holds. */
static void clip_ears(const Vector<Point> &flat, Vector<std::array<uint32_t, 3>> &out)
{
    uint32_t n = uint32_t(flat.size());
    Vector<uint32_t> next(n), previous(n);
    for (uint32_t i = 0; i < n; ++i) {
        next[i] = (i + 1) % n;
        previous[i] = (i + n - 1) % n;
    }
    size_t looks = 0;
    auto is_ear = [&](uint32_t i) {
        uint32_t a = previous[i], c = next[i];
        ++looks;
        if (!(turn(flat[a], flat[i], flat[c]) > 0))
            return false;
        for (uint32_t j = next[c]; j != a; j = next[j], ++looks)
            if (inside(flat[j], flat[a], flat[i], flat[c]))
                return false;
        return true;
    };
    uint32_t i = 0, misses = 0;
    for (uint32_t left = n; left > 3;) {
        if (misses < left && looks < MAX_LOOKS * n && !is_ear(i)) {
            ++misses;
            i = next[i];
            continue;
        }
        out.push_back({previous[i], i, next[i]});
        next[previous[i]] = next[i];
        previous[next[i]] = previous[i];
        i = next[i];
        misses = 0;
        --left;
    }
    out.push_back({previous[i], i, next[i]});
}

void triangulate(const Vector<Vec3d> &polygon, Vector<std::array<uint32_t, 3>> &out)
{
    if (polygon.size() > 3 && polygon.size() <= MAX_EAR_CORNERS) {
        Vector<Point> flat = flatten(polygon);
        if (!is_convex(flat)) {
            clip_ears(flat, out);
            return;
        }
    }
    for (uint32_t i = 2; i < polygon.size(); ++i)
        out.push_back({0, i - 1, i});
}

} // namespace gtx
