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
    uint32_t low = UINT32_MAX, high = 0;
    for (uint32_t t : triangles)
        for (uint32_t vertex : mesh.triangles[t]) {
            low = std::min(low, vertex);
            high = std::max(high, vertex);
        }
    Vector<uint32_t> out;
    if ((high - low) / 64 > 3 * triangles.size()) {
        for (uint32_t t : triangles)
            out.insert(out.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        return out;
    }
    Vector<uint64_t> used((high - low) / 64 + 1);      /* a bit each: indices lie close together */
    for (uint32_t t : triangles)
        for (uint32_t vertex : mesh.triangles[t])
            used[(vertex - low) / 64] |= uint64_t(1) << (vertex - low) % 64;
    for (uint32_t word = 0; word < used.size(); ++word)
        for (uint64_t bits = used[word]; bits; bits &= bits - 1)
            out.push_back(low + 64 * word + uint32_t(__builtin_ctzll(bits)));
    return out;
}

/* Those that may be on the convex hull: the others lie inside of the octagon of the points that are
 * outermost along eight directions (Akl, Toussaint 1978), by more than rounding does. */
Vector<Point> outermost_points(const Vector<Point> &points)
{
    constexpr size_t SIDES = 8;
    constexpr double ROUNDING = 1e-9;
    constexpr double ALONG[SIDES][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1},
                                        {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
    Point outermost[SIDES + 1];
    double most[SIDES];
    std::fill_n(outermost, SIDES, points[0]);
    std::fill_n(most, SIDES, -INFINITY);
    for (const Point &p : points)
        for (size_t k = 0; k < SIDES; ++k) {
            const double along = ALONG[k][0] * p.u + ALONG[k][1] * p.v;
            if (along > most[k]) {
                most[k] = along;
                outermost[k] = p;
            }
        }
    outermost[SIDES] = outermost[0];
    const double width = most[0] + most[4] + most[2] + most[6], least = ROUNDING * width * width;
    Vector<Point> out;
    for (const Point &p : points) {
        bool inside = true;
        for (size_t k = 0; k < SIDES && inside; ++k) {
            const Point &a = outermost[k], &b = outermost[k + 1];
            inside = (a.u == b.u && a.v == b.v) || turn(a, b, p) > least;
        }
        if (!inside)
            out.push_back(p);
    }
    return out.empty() ? points : out; /* all in one place */
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
    Vector<Point> hull = hull_of(outermost_points(points));
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

/* Two numbers that are computed with at once; each rounds as it would alone. */
using Pair = double __attribute__((vector_size(2 * sizeof(double))));

Pair place_of(const Point &p)
{
    return Pair{p.u, p.v};
}

/* A plane h = a u + b v + c. */
struct Plane {
    double a = 0, b = 0, c = 0;
    double above(const Point &p) const { return p.h - a * p.u - b * p.v - c; }
};

/* The weighted least-squares plane, once weights are `scaled`; false when the points do not span
 * one. */
bool fit_plane(const Vector<Point> &points, double scaled, Vector<double> &weights, Plane &out)
{
    double w = 0, h = 0;
    Pair middle = {0, 0}, square = {0, 0}, rise = {0, 0};
    for (size_t i = 0; i < points.size(); ++i) {
        const double weight = weights[i] *= scaled;
        w += weight;
        middle += weight * place_of(points[i]);
        h += weight * points[i].h;
    }
    middle /= w, h /= w;
    double uv = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        const Pair off = place_of(points[i]) - middle, weighed = weights[i] * off;
        square += weighed * off;
        uv += weighed[0] * off[1];
        rise += weighed * (points[i].h - h);
    }
    const double uu = square[0], vv = square[1], uh = rise[0], vh = rise[1];
    double det = uu * vv - uv * uv;
    if (!(det > 1e-9 * uu * vv))
        return false;
    out.a = (uh * vv - vh * uv) / det;
    out.b = (vh * uu - uh * uv) / det;
    out.c = h - out.a * middle[0] - out.b * middle[1];
    return true;
}

/* Weighs points by their distances from the plane, too. Returns the range of these; adds up the
 * weights. */
double weigh_again(const Plane &plane, const Vector<Point> &points, Vector<double> &weights,
                   double &sum)
{
    double low = INFINITY, high = -INFINITY;
    sum = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        const double d = plane.above(points[i]);
        low = std::min(low, d);
        high = std::max(high, d);
        sum += weights[i] *= std::abs(d);
    }
    return high - low;
}

/* The plane above which points have the least range of height: least squares, reweighted by the
 * distances they leave (Lawson 1961), which tends to the minimax plane. */
Plane minimax_plane(const Vector<Point> &points)
{
    Plane best, plane;
    double low = INFINITY, high = -INFINITY, scaled = 1, sum;
    for (const Point &p : points) {
        low = std::min(low, p.h);
        high = std::max(high, p.h);
    }
    double least = high - low;
    Vector<double> weights(points.size(), 1);
    for (int step = 0; step <= LAWSON_STEPS && fit_plane(points, scaled, weights, plane); ++step) {
        cancel_point(points.size());
        const double range = weigh_again(plane, points, weights, sum);
        bool gentle = std::abs(plane.a) <= STEEPEST_TILT && std::abs(plane.b) <= STEEPEST_TILT;
        if (gentle && range < least) {
            least = range;
            best = plane;
        }
        if (!(sum > 0))
            break;
        scaled = double(points.size()) / sum;
    }
    return best;
}

/* Sets the origin and the extents of a frame so that it encloses some vertices. */
void enclose(const Mesh &mesh, const Vector<uint32_t> &vertices, Frame &frame)
{
    FrameInverse inverse(frame);
    Vec3d low(INFINITY, INFINITY, INFINITY), high = -low;
    for (uint32_t vertex : vertices) {
        cancel_point();
        const Vec3d p = inverse(mesh.positions[vertex]);
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
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
    enclose(mesh, vertices, frame);
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
    enclose(mesh, vertices_of(mesh, triangles), out);
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
