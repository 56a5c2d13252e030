/* The least rectangle and the minimax tilt of a chart's frame. */
#include "chart/frame.hpp"
#include "base/exact.h"

#include <algorithm>

namespace gtx {

namespace {

/* Steps towards the minimax plane, of which the best counts. Half: texels +9 % (truck); double: RMS
 * +9 %, texels -2 % (Duck). */
constexpr int LAWSON_STEPS = 11;
/* Steepest tilt of each axis: det(x, y, z) is then at least 1 / (1 + 1.5^2) > 0.3. Half: RMS +7 %,
 * double: texels -1 % (truck). */
constexpr double STEEPEST_TILT = 1.5;
/* What parts of a tilted frame may come to. The format asks for 0.1; half and double change
 * nothing. */
constexpr double MIN_DETERMINANT = 0.15;
/* A limit on time: sides of a hull that a rectangle is tried along, evenly. */
constexpr size_t MAX_SIDES = 512;

struct Point {
    double u, v, h;
};

double turn(const Point &a, const Point &b, const Point &c)
{
    return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

Vector<uint32_t> vertices_of(const Mesh &mesh, const Vector<uint32_t> &triangles)
{
    Vector<uint32_t> out;
    out.reserve(triangles.size() * 3);
    for (uint32_t t : triangles)
        out.insert(out.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
    const auto [least, greatest] = std::minmax_element(out.begin(), out.end());
    const uint32_t low = *least, high = *greatest;
    if ((high - low) / 64 > out.size()) {
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        return out;
    }
    Vector<uint64_t> used((high - low) / 64 + 1);      /* a bit each: indices lie close together */
    for (uint32_t vertex : out)
        used[(vertex - low) / 64] |= uint64_t(1) << (vertex - low) % 64;
    out.clear();
    for (uint32_t word = 0; word < used.size(); ++word)
        for (uint64_t bits = used[word]; bits; bits &= bits - 1)
            out.push_back(low + 64 * word + uint32_t(__builtin_ctzll(bits)));
    return out;
}

/* Andrew's monotone chain: the convex hull in the plane, counter-clockwise. */
Vector<Point> hull_of(Vector<Point> points)
{
    std::sort(points.begin(), points.end(),
              [](const Point &a, const Point &b) { return a.u != b.u ? a.u < b.u : a.v < b.v; });
    Vector<Point> hull;
    auto add = [&hull](const Point &p, size_t floor) {
        while (hull.size() >= floor + 2 &&
               turn(hull[hull.size() - 2], hull[hull.size() - 1], p) <= 0)
            hull.pop_back();
        hull.push_back(p);
    };
    for (const Point &p : points)
        add(p, 0);
    size_t upper = hull.size() - 1;
    for (size_t i = points.size() - 1; i-- > 0;)
        add(points[i], upper);
    hull.pop_back();
    return hull;
}

/* The direction (cos, sin) of the longer side of the least rectangle around points in the plane.
 * One side of that rectangle lies along an edge of the hull (Freeman, Shapira 1975). */
Point least_rectangle(const Vector<Point> &points)
{
    Vector<Point> hull = hull_of(points);
    Point best = {1, 0, 0};
    double least = INFINITY;
    for (size_t i = 0; i < hull.size(); i += 1 + hull.size() / MAX_SIDES) {
        cancel_point(hull.size());
        const Point &a = hull[i], &b = hull[(i + 1) % hull.size()];
        double du = b.u - a.u, dv = b.v - a.v, l = length(du, dv);
        if (!(l > 0))
            continue;
        du /= l;
        dv /= l;
        double low = INFINITY, high = -INFINITY, height = 0;
        for (const Point &p : hull) {
            double along = du * p.u + dv * p.v;
            low = std::min(low, along);
            high = std::max(high, along);
            height = std::max(height, du * (p.v - a.v) - dv * (p.u - a.u));
        }
        if ((high - low) * height >= least)
            continue;
        least = (high - low) * height;
        best = high - low >= height ? Point{du, dv, 0} : Point{-dv, du, 0};
    }
    return best;
}

/* A plane h = a u + b v + c. */
struct Plane {
    double a = 0, b = 0, c = 0;
    double above(const Point &p) const { return p.h - a * p.u - b * p.v - c; }
};

/* The weighted least-squares plane; false when the points do not span one. */
bool fit_plane(const Vector<Point> &points, const Vector<double> &weights, Plane &out)
{
    double w = 0, u = 0, v = 0, h = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        w += weights[i];
        u += weights[i] * points[i].u;
        v += weights[i] * points[i].v;
        h += weights[i] * points[i].h;
    }
    u /= w, v /= w, h /= w;
    double uu = 0, uv = 0, vv = 0, uh = 0, vh = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        double du = points[i].u - u, dv = points[i].v - v, dh = points[i].h - h;
        uu += weights[i] * du * du;
        uv += weights[i] * du * dv;
        vv += weights[i] * dv * dv;
        uh += weights[i] * du * dh;
        vh += weights[i] * dv * dh;
    }
    double det = uu * vv - uv * uv;
    if (!(det > 1e-9 * uu * vv))
        return false;
    out.a = (uh * vv - vh * uv) / det;
    out.b = (vh * uu - uh * uv) / det;
    out.c = h - out.a * u - out.b * v;
    return true;
}

double range_above(const Plane &plane, const Vector<Point> &points)
{
    double low = INFINITY, high = -INFINITY;
    for (const Point &p : points) {
        double d = plane.above(p);
        low = std::min(low, d);
        high = std::max(high, d);
    }
    return high - low;
}

/* The plane above which points have the least range of height: least squares, reweighted by the
 * distances they leave (Lawson 1961), which tends to the minimax plane. */
Plane minimax_plane(const Vector<Point> &points)
{
    Plane best, plane;
    double least = range_above(best, points);
    Vector<double> weights(points.size(), 1);
    for (int step = 0; step <= LAWSON_STEPS && fit_plane(points, weights, plane); ++step) {
        cancel_point(points.size());
        double range = range_above(plane, points);
        bool gentle = std::abs(plane.a) <= STEEPEST_TILT && std::abs(plane.b) <= STEEPEST_TILT;
        if (gentle && range < least) {
            least = range;
            best = plane;
        }
        double sum = 0;
        for (size_t i = 0; i < points.size(); ++i)
            sum += weights[i] *= std::abs(plane.above(points[i]));
        if (!(sum > 0))
            break;
        for (double &w : weights)
            w *= double(points.size()) / sum;
    }
    return best;
}

/* Sets the origin and the extents of a frame so that it encloses the triangles. */
void enclose(const Mesh &mesh, const Vector<uint32_t> &triangles, Frame &frame)
{
    FrameInverse inverse(frame);
    Vec3d low(INFINITY, INFINITY, INFINITY), high = -low;
    for (uint32_t t : triangles) {
        cancel_point();
        for (int corner = 0; corner < 3; ++corner) {
            Vec3d p = inverse(mesh.position(t, corner));
            for (int k = 0; k < 3; ++k) {
                low[k] = std::min(low[k], p[k]);
                high[k] = std::max(high[k], p[k]);
            }
        }
    }
    frame.origin = frame.point(low);
    for (int k = 0; k < 3; ++k)
        frame.extent[k] = high[k] - low[k];
}

} // namespace

FrameInverse::FrameInverse(const Frame &frame) : origin(frame.origin)
{
    double det = dot(frame.x, cross(frame.y, frame.z));
    rows[0] = cross(frame.y, frame.z) / det;
    rows[1] = cross(frame.z, frame.x) / det;
    rows[2] = cross(frame.x, frame.y) / det;
}

Vec3d Frame::local(const Vec3d &point) const
{
    return FrameInverse(*this)(point);
}

Frame make_frame(const Mesh &mesh, const Vector<uint32_t> &triangles, const Vec3d &z)
{
    Vector<uint32_t> vertices = vertices_of(mesh, triangles);
    Vec3d base = mesh.positions[vertices[0]], u = any_perpendicular(z), v = cross(z, u);
    Vector<Point> points;
    points.reserve(vertices.size());
    for (uint32_t i : vertices) {
        Vec3d d = mesh.positions[i] - base;
        points.push_back({dot(d, u), dot(d, v), dot(d, z)});
    }
    Point side = least_rectangle(points);
    for (Point &p : points)
        p = {p.u * side.u + p.v * side.v, p.v * side.u - p.u * side.v, p.h};

    Plane plane = minimax_plane(points);
    Frame frame;
    frame.x = normalize(u * side.u + v * side.v + z * plane.a);
    frame.y = normalize(v * side.u - u * side.v + z * plane.b);
    frame.z = z;
    frame.origin = base;
    enclose(mesh, triangles, frame);
    return frame;
}

Frame turned_frame(const Mesh &mesh, const Vector<uint32_t> &triangles, const Frame &frame,
                   double radians)
{
    const Vec3d &z = frame.z;
    const Vec3d u = normalize(frame.x - z * dot(frame.x, z)), v = cross(z, u);
    const double a = dot(frame.x, z) / dot(frame.x, u), b = dot(frame.y, z) / dot(frame.y, v);
    const double c = gtx_cos(radians), s = gtx_sin(radians);
    Frame out = frame;
    out.x = normalize(u * c + v * s + z * (a * c + b * s));
    out.y = normalize(v * c - u * s + z * (b * c - a * s));
    enclose(mesh, triangles, out);
    return out;
}

Frame part_of_frame(const Frame &whole, const double low[2], const double high[2],
                    const Vector<Vec3d> &points)
{
    Vector<Point> heights;
    heights.reserve(points.size());
    for (const Vec3d &p : points)
        heights.push_back({p.x, p.y, p.z});
    Plane plane = heights.empty() ? Plane{} : minimax_plane(heights);
    Vec3d x = whole.x + whole.z * plane.a, y = whole.y + whole.z * plane.b;
    if (dot(normalize(x), cross(normalize(y), whole.z)) < MIN_DETERMINANT) {
        plane = {}; /* the whole is tilted already */
        x = whole.x;
        y = whole.y;
    }
    double lowest = INFINITY, highest = -INFINITY;
    for (const Point &p : heights) {
        double above = p.h - plane.a * p.u - plane.b * p.v;
        lowest = std::min(lowest, above);
        highest = std::max(highest, above);
    }
    if (heights.empty())
        lowest = highest = 0;
    Frame frame;
    frame.origin = whole.point({low[0], low[1], lowest + plane.a * low[0] + plane.b * low[1]});
    frame.x = normalize(x);
    frame.y = normalize(y);
    frame.z = whole.z;
    frame.extent[0] = (high[0] - low[0]) * length(x);
    frame.extent[1] = (high[1] - low[1]) * length(y);
    frame.extent[2] = highest - lowest;
    return frame;
}

} // namespace gtx
