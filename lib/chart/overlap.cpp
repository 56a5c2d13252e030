/* The surface around a chart that its maps may show too. */
#include "chart/frame.hpp"
#include "chart/places.hpp"

#include <algorithm>

namespace gtx {

namespace {

/* Least cosine with the axis: what is steeper, other charts show better. Half: 1 hole (truck),
 * texels +2 % (Spot); double: bytes -5 % for less overlap (Spot). */
constexpr double MIN_FACING = 0.24;
/* Surface is reached from one edge of the border, and stays within this many reaches of it: the
 * height field that passes below a silhouette is not followed from where the two meet. Half: bytes
 * -1 %, double: RMS +2 % (truck). */
constexpr double TETHER = 1.5;

struct Point {
    double a, b;
};

double distance2(const Point &p, const Point &s, const Point &e)
{
    double da = e.a - s.a, db = e.b - s.b, l = da * da + db * db;
    double t = l > 0 ? ((p.a - s.a) * da + (p.b - s.b) * db) / l : 0;
    t = std::clamp(t, 0., 1.);
    double a = p.a - s.a - t * da, b = p.b - s.b - t * db;
    return a * a + b * b;
}

double side(const Point &p, const Point &s, const Point &e)
{
    return (e.a - s.a) * (p.b - s.b) - (e.b - s.b) * (p.a - s.a);
}

/* Whether two segments come as near as `reach`. */
bool near(const Point &p, const Point &q, const Point &s, const Point &e, double reach)
{
    double r2 = reach * reach;
    if (distance2(p, s, e) <= r2 || distance2(q, s, e) <= r2 || distance2(s, p, q) <= r2 ||
        distance2(e, p, q) <= r2)
        return true;
    return (side(p, s, e) > 0) != (side(q, s, e) > 0) && (side(s, p, q) > 0) != (side(e, p, q) > 0);
}

/* The border edges of a core in the frame's plane, in columns along a: each column lists the
 * edges that reach into it, widened by the reach. */
class Outline {
public:
    Outline(double width, double reach, size_t edges)
        : reach_(reach), step_(width / double(edges + 1) + reach), columns_(edges + 2)
    {
    }

    void add(const Point &s, const Point &e)
    {
        edges_.push_back({s, e});
        size_t last = column(std::max(s.a, e.a) + reach_);
        for (size_t c = column(std::min(s.a, e.a) - reach_); c <= last; ++c)
            columns_[c].push_back(uint32_t(edges_.size() - 1));
    }

    bool near_triangle(const Point corner[3]) const
    {
        size_t first = column(std::min({corner[0].a, corner[1].a, corner[2].a}));
        size_t last = column(std::max({corner[0].a, corner[1].a, corner[2].a}));
        for (size_t c = first; c <= last; ++c)
            for (uint32_t edge : columns_[c])
                if (near_edge(corner, edges_[edge], reach_))
                    return true;
        return false;
    }

    bool tethered(const Point corner[3], uint32_t edge) const
    {
        return near_edge(corner, edges_[edge], TETHER * reach_);
    }

private:
    size_t column(double a) const
    {
        return size_t(std::clamp(a / step_, 0., double(columns_.size() - 1)));
    }

    static bool near_edge(const Point corner[3], const std::array<Point, 2> &edge, double reach)
    {
        auto [s, e] = edge;
        if (std::max({corner[0].b, corner[1].b, corner[2].b}) < std::min(s.b, e.b) - reach ||
            std::min({corner[0].b, corner[1].b, corner[2].b}) > std::max(s.b, e.b) + reach ||
            std::max({corner[0].a, corner[1].a, corner[2].a}) < std::min(s.a, e.a) - reach ||
            std::min({corner[0].a, corner[1].a, corner[2].a}) > std::max(s.a, e.a) + reach)
            return false;
        bool left = true, right = true;
        for (int k = 0; k < 3; ++k) {
            const Point &p = corner[k], &q = corner[(k + 1) % 3];
            if (near(p, q, s, e, reach))
                return true;
            left = left && side(s, p, q) >= 0;
            right = right && side(s, p, q) <= 0;
        }
        return left || right; /* the edge lies inside the triangle */
    }

    double reach_, step_;
    Vector<std::array<Point, 2>> edges_;
    Vector<Vector<uint32_t>> columns_;
};

} // namespace

Vector<uint32_t> overlap_triangles(const Mesh &mesh,
                                   const Vector<std::array<uint32_t, 3>> &neighbours,
                                   const Chart &chart, double reach)
{
    const Vector<uint32_t> &core = chart.triangles;
    Places in_core(core.size());
    for (uint32_t t : core)
        in_core.add(t, 0);
    FrameInverse inverse(chart.frame);
    auto plan = [&](uint32_t t, int k) {
        Vec3d p = inverse(mesh.position(t, k));
        return Point{p.x, p.y};
    };

    auto beyond_cut = [&](const Point &p, const Point &q) {
        return std::max(p.a, q.a) < chart.clip_low[0] || std::min(p.a, q.a) > chart.clip_high[0] ||
               std::max(p.b, q.b) < chart.clip_low[1] || std::min(p.b, q.b) > chart.clip_high[1];
    };
    Vector<std::pair<uint32_t, int>> border;
    for (uint32_t t : core)
        for (int k = 0; k < 3; ++k)
            if (neighbours[t][k] != NO_TRIANGLE && !in_core.has(neighbours[t][k]) &&
                !beyond_cut(plan(t, k), plan(t, (k + 1) % 3)))
                border.emplace_back(t, k);
    Outline outline(chart.frame.extent[0], reach, border.size());
    Vector<std::pair<uint32_t, uint32_t>> found;      /* triangle, edge it was reached from */
    Places seen(border.size());
    auto visit = [&](uint32_t t, uint32_t edge) {
        if (t == NO_TRIANGLE || in_core.has(t) || seen.has(t))
            return;
        Vec3d normal = normalize(mesh.area_vector(t));
        Point corner[3] = {plan(t, 0), plan(t, 1), plan(t, 2)};
        if (!outline.tethered(corner, edge))
            return; /* it may be nearer to another edge */
        seen.add(t, 0);
        if (dot(normal, chart.frame.z) >= MIN_FACING && outline.near_triangle(corner))
            found.emplace_back(t, edge);
    };
    for (auto [t, k] : border)
        outline.add(plan(t, k), plan(t, (k + 1) % 3));
    for (uint32_t edge = 0; edge < border.size(); ++edge)
        visit(neighbours[border[edge].first][border[edge].second], edge);
    for (size_t next = 0; next < found.size(); ++next) {
        auto [t, edge] = found[next];
        for (uint32_t n : neighbours[t])
            visit(n, edge);
    }
    Vector<uint32_t> out;
    for (const auto &[t, edge] : found)
        out.push_back(t);
    std::sort(out.begin(), out.end());
    return out;
}

} // namespace gtx
