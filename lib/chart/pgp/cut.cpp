/* Cuts triangles along the integer lines of a parameterization (Ray et al. 2006, section 5).
 *
 * Coordinates are multiples of a power of two, no end of an edge is near a line without being on
 * it, and an edge is cut once for both its sides: so tests for equality are exact and pieces
 * meet. */
#include "chart/pgp/pgp.hpp"

#include <algorithm>

namespace gtx {

namespace {

/* Limits. Cells in a triangle: what is larger stays whole, for a cell's lines are meant to be far
 * apart on triangles. Pieces: of needles there may be more than could be stored. */
constexpr double MAX_CELLS = 1024, MAX_PIECES = 3e7;
/* A guard: two lines that cross an edge closer than this, as a share of its length, cross in one
 * point. */
constexpr double SAME_POINT = 1e-6;

/* Where lines cross an edge, from the start of the half-edge that is cut. */
struct EdgePoint {
    uint32_t vertex;
    double at; /* 0 to 1 */
    Uv uv;     /* in the triangle of that half-edge */
};

struct EdgeCuts {
    uint32_t points, count, seams; /* the first of each; there is a seam more than points */
};

struct Corner {
    PieceCorner piece;
    Uv uv;
    uint32_t side; /* of the seam to the next corner: twice its number, or one more */
};
using Polygon = Vector<Corner>;

double next_line(double coordinate)
{
    return std::floor(coordinate) + 1;
}

double lines_between(double a, double b)
{
    return std::max(0., std::ceil(std::max(a, b)) - next_line(std::min(a, b)));
}

bool on_one_line(const Uv &a, const Uv &b)
{
    return (a[0] == b[0] && a[0] == std::floor(a[0])) || (a[1] == b[1] && a[1] == std::floor(a[1]));
}

class LineCutter {
public:
    LineCutter(const Mesh &mesh, const HalfEdges &edges, const CrossField &field,
               const Periodic &map)
        : mesh_(mesh), edges_(edges), field_(field), map_(map), whole_(map.singular)
    {
    }
    Pieces run();

private:
    void leave_whole();
    uint32_t owner(uint32_t half_edge) const;
    Vector<EdgePoint> crossings(uint32_t half_edge) const;
    void cut_edge(uint32_t half_edge);
    Polygon outline(uint32_t triangle) const;
    template <class Visit> void each_strip(Polygon polygon, size_t axis, Visit visit);
    bool cut_off(Polygon &polygon, size_t axis, double line, Polygon &below);
    Polygon chain(const Corner &from, const Corner &to, size_t axis);
    void finish(const Polygon &polygon, uint32_t triangle);

    uint32_t add_point(const Vec3d &point);
    uint32_t add_seam(uint32_t a, uint32_t b, bool line);
    const Vec3d &position(uint32_t vertex) const
    {
        size_t own = mesh_.positions.size();
        return vertex < own ? mesh_.positions[vertex] : out_.points[vertex - own];
    }

    const Mesh &mesh_;
    const HalfEdges &edges_;
    const CrossField &field_;
    const Periodic &map_;
    Vector<uint8_t> whole_;         /* a triangle: no line cuts it */
    Vector<EdgePoint> points_;      /* of edges */
    Vector<EdgeCuts> cuts_;         /* a half-edge, where it is the one that is cut */
    Pieces out_;
};

void LineCutter::leave_whole()
{
    double pieces = 0;
    for (uint32_t t = 0; t < whole_.size(); ++t) {
        double cells = 1;
        for (size_t axis = 0; axis < 2; ++axis) {
            const Uv *uv = &map_.uv[3 * t];
            auto [low, high] = std::minmax({uv[0][axis], uv[1][axis], uv[2][axis]});
            cells *= 1 + lines_between(low, high);
        }
        whole_[t] = whole_[t] || !(cells <= MAX_CELLS);
        pieces += whole_[t] ? 1 : cells;
    }
    if (pieces > MAX_PIECES)
        throw Error(GTX_ERROR_LIMIT, "the lines of the partition pgp cut too many triangles");
}

/* The side of an edge on which it is cut. */
uint32_t LineCutter::owner(uint32_t h) const
{
    uint32_t o = edges_.opposite[h];
    if (o == NO_EDGE)
        return h;
    if (whole_[h / 3] != whole_[o / 3])
        return whole_[h / 3] ? o : h;
    return std::min(h, o);
}

uint32_t LineCutter::add_point(const Vec3d &point)
{
    out_.points.push_back(point);
    return uint32_t(mesh_.positions.size() + out_.points.size() - 1);
}

uint32_t LineCutter::add_seam(uint32_t a, uint32_t b, bool line)
{
    float size = float(length(position(b) - position(a)));
    out_.seams.push_back({{NO_PIECE, NO_PIECE}, size, line});
    return uint32_t(out_.seams.size() - 1);
}

Vector<EdgePoint> LineCutter::crossings(uint32_t h) const
{
    const Uv &p = map_.uv[h], &q = map_.uv[next_edge(h)];
    Vector<EdgePoint> all, out;
    for (size_t axis = 0; axis < 2 && !whole_[h / 3]; ++axis) {
        auto [low, high] = std::minmax(p[axis], q[axis]);
        for (double line = next_line(low); line < high; ++line) {
            EdgePoint point = {NO_EDGE, (line - p[axis]) / (q[axis] - p[axis]), {}};
            point.uv[axis] = line;
            point.uv[1 - axis] = on_grid(p[1 - axis] + (q[1 - axis] - p[1 - axis]) * point.at);
            all.push_back(point);
        }
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const EdgePoint &a, const EdgePoint &b) { return a.at < b.at; });
    for (const EdgePoint &point : all) {
        if (out.empty() || point.at - out.back().at > SAME_POINT) {
            out.push_back(point);
            continue;
        }
        for (double &x : out.back().uv) /* a line of u and one of v */
            x = std::round(x);
    }
    return out;
}

void LineCutter::cut_edge(uint32_t h)
{
    uint32_t o = edges_.opposite[h];
    uint32_t start = start_of(mesh_, h), end = start_of(mesh_, next_edge(h));
    Vector<EdgePoint> points = crossings(h);
    bool apart = o != NO_EDGE && whole_[h / 3] != whole_[o / 3];
    bool line = apart || (!whole_[h / 3] && on_one_line(map_.uv[h], map_.uv[next_edge(h)]));
    cuts_[h] = {uint32_t(points_.size()), uint32_t(points.size()), uint32_t(out_.seams.size())};
    uint32_t last = start;
    for (EdgePoint &point : points) {
        point.vertex = add_point(position(start) + (position(end) - position(start)) * point.at);
        add_seam(last, point.vertex, line);
        last = point.vertex;
        points_.push_back(point);
    }
    add_seam(last, end, line);
}

/* A triangle with what cuts its edges, as it sees that itself. */
Polygon LineCutter::outline(uint32_t t) const
{
    Polygon out;
    for (uint32_t k = 0; k < 3; ++k) {
        uint32_t h = 3 * t + k, own = owner(h);
        const EdgeCuts &cuts = cuts_[own];
        const bool same = own == h;
        auto side = [&](uint32_t i) {
            return same ? 2 * (cuts.seams + i) : 2 * (cuts.seams + cuts.count - i) + 1;
        };
        Uv shift = {};
        if (!same) {
            Uv start = turned(map_.uv[next_edge(own)], field_.turn[own]);
            shift = {map_.uv[h][0] - start[0], map_.uv[h][1] - start[1]};
        }
        Corner corner = {{start_of(mesh_, h), {}}, map_.uv[h], side(0)};
        corner.piece.weight[k] = 1;
        out.push_back(corner);
        for (uint32_t i = 0; i < cuts.count; ++i) {
            const EdgePoint &point = points_[cuts.points + (same ? i : cuts.count - 1 - i)];
            float at = float(same ? point.at : 1 - point.at);
            corner = {{point.vertex, {}}, point.uv, side(i + 1)};
            corner.piece.weight[k] = 1 - at;
            corner.piece.weight[(k + 1) % 3] = at;
            if (!same) {
                Uv uv = turned(point.uv, field_.turn[own]);
                corner.uv = {uv[0] + shift[0], uv[1] + shift[1]};
            }
            out.push_back(corner);
        }
    }
    return out;
}

/* What the other axis' lines cut out of a line from one corner to another. */
Polygon LineCutter::chain(const Corner &from, const Corner &to, size_t axis)
{
    const size_t other = 1 - axis;
    const bool up = to.uv[other] > from.uv[other];
    auto [low, high] = std::minmax(from.uv[other], to.uv[other]);
    Polygon out;
    for (double line = next_line(low); line < high; ++line) {
        double at = (line - from.uv[other]) / (to.uv[other] - from.uv[other]);
        Vec3d a = position(from.piece.vertex), b = position(to.piece.vertex);
        Corner corner = {{add_point(a + (b - a) * at), {}}, {}, 0};
        for (size_t k = 0; k < 3; ++k)
            corner.piece.weight[k] =
                from.piece.weight[k] + (to.piece.weight[k] - from.piece.weight[k]) * float(at);
        corner.uv[axis] = from.uv[axis];
        corner.uv[other] = line;
        out.push_back(corner);
    }
    if (!up)
        std::reverse(out.begin(), out.end());
    return out;
}

/* Leaves in `polygon`, which is convex, what lies above the line. */
bool LineCutter::cut_off(Polygon &polygon, size_t axis, double line, Polygon &below)
{
    auto on_line = [&](const Corner &c) { return c.uv[axis] == line; };
    auto first = std::find_if(polygon.begin(), polygon.end(), on_line);
    auto last = std::find_if(polygon.rbegin(), polygon.rend(), on_line).base();
    if (last - first < 3 || --last - first > polygon.end() - polygon.begin() - 2)
        return false; /* the corners on it are neighbours, or one */
    Polygon between = chain(*first, *last, axis);
    Polygon one(first, last + 1), two(last, polygon.end());
    two.insert(two.end(), polygon.begin(), first + 1);
    uint32_t from = first->piece.vertex;
    for (size_t i = 0; i <= between.size(); ++i) {
        uint32_t to = i < between.size() ? between[i].piece.vertex : last->piece.vertex;
        two.back().side = 2 * add_seam(from, to, true);
        if (i < between.size())
            two.push_back(between[i]);
        from = to;
    }
    /* The same seams backwards: each lies before a corner of `two`. */
    uint32_t seam = uint32_t(out_.seams.size());
    one.back().side = 2 * --seam + 1;
    for (size_t i = between.size(); i-- > 0;) {
        one.push_back(between[i]);
        one.back().side = 2 * --seam + 1;
    }
    auto low = [&](const Polygon &p) {
        return std::any_of(p.begin(), p.end(), [&](const Corner &c) { return c.uv[axis] < line; });
    };
    const bool first_below = low(one);
    below = std::move(first_below ? one : two);
    polygon = std::move(first_below ? two : one);
    return true;
}

template <class Visit> void LineCutter::each_strip(Polygon polygon, size_t axis, Visit visit)
{
    for (;;) {
        double low = INFINITY, high = -INFINITY;
        for (const Corner &c : polygon) {
            low = std::min(low, c.uv[axis]);
            high = std::max(high, c.uv[axis]);
        }
        Polygon below;
        if (!(next_line(low) < high) || !cut_off(polygon, axis, next_line(low), below))
            break;
        visit(std::move(below));
    }
    visit(std::move(polygon));
}

void LineCutter::finish(const Polygon &polygon, uint32_t t)
{
    uint32_t piece = uint32_t(out_.triangle.size());
    out_.triangle.push_back(t);
    for (const Corner &c : polygon) {
        out_.corners.push_back(c.piece);
        out_.seams[c.side / 2].piece[c.side % 2] = piece;
    }
    out_.first.push_back(uint32_t(out_.corners.size()));
}

Pieces LineCutter::run()
{
    leave_whole();
    cuts_.resize(edges_.opposite.size());
    for (uint32_t h = 0; h < cuts_.size(); ++h)
        if (owner(h) == h)
            cut_edge(h);
    out_.first.push_back(0);
    for (uint32_t t = 0; t < whole_.size(); ++t) {
        auto cell = [&](Polygon polygon) { finish(polygon, t); };
        if (whole_[t])
            cell(outline(t));
        else
            each_strip(outline(t), 0, [&](Polygon strip) {
                each_strip(std::move(strip), 1, cell);
            });
    }
    return std::move(out_);
}

} // namespace

Pieces cut_along_lines(const Mesh &mesh, const HalfEdges &edges, const CrossField &field,
                       const Periodic &map)
{
    return LineCutter(mesh, edges, field, map).run();
}

} // namespace gtx
