/* Joins the pieces of a surface that end along the same lines: their border vertices become common,
 * borders are split at each other's vertices, and what is left open between them is closed. */
#include "bake/shell_sheets.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <unordered_set>

namespace gtx::baking {

/* Vertices of borders this near to each other become one. Texels of the finer sheet. */
constexpr double NEAR = 0.5;
/* Those of one surface do not face away from each other. */
constexpr double LEAST_COSINE = 0.2;
/* An opening of no more than so many texels around is a gap between pieces; so is a larger one, of so
 * many edges at most, where sheets show something beyond this share of them, so far from the edge. */
constexpr double SURELY_A_GAP = 3.5, SHOWN_SHARE = 0.5, BEYOND = 0.5;
constexpr size_t MOST_EDGES = 128;
constexpr int ROUNDS = 3;
/* An edge is followed no farther than this for vertices beside it, in cells of `Places`. */
constexpr double MOST_STEPS = 64;

using Edge = std::array<uint32_t, 2>;
using OpenEdge = std::pair<Edge, uint32_t>; /* and the triangle that has it */

namespace {

/* Points to be found by place. */
class Places {
public:
    explicit Places(double size) : size_(size) {}
    void add(const Vec3d &at, uint32_t value) { cells_[key(at, 0, 0, 0)].push_back(value); }
    /* Calls with all values within one cell's size of the box, and some beyond, in the order of
     * cells and of adding. */
    template <class Body> void around(const Vec3d &at, Body body) const
    {
        for (int k = 0; k < 27; ++k) {
            const auto found = cells_.find(key(at, k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
            if (found != cells_.end())
                for (uint32_t value : found->second)
                    body(value);
        }
    }

private:
    using Key = std::array<int64_t, 3>;
    struct Hash {
        size_t operator()(const Key &k) const
        {
            return size_t(k[0]) * 73856093u ^ size_t(k[1]) * 19349663u ^ size_t(k[2]) * 83492791u;
        }
    };
    Key key(const Vec3d &at, int x, int y, int z) const
    {
        auto cell = [&](double v) { return int64_t(std::clamp(v / size_, -1e15, 1e15) + 2e15); };
        return {cell(at.x) + x, cell(at.y) + y, cell(at.z) + z};
    }
    double size_;
    std::unordered_map<Key, std::vector<uint32_t>, Hash> cells_;
};

/* All pieces as one, and their common border vertices. */
class Welder {
public:
    Welder(const std::vector<MapSheet> &sheets, std::vector<SheetPiece> pieces,
           const std::vector<std::vector<uint32_t>> &others);

    void join_vertices();
    void split_edges();
    void drop_folds();
    void close_gaps();

    ShellSource source;

private:
    double reach(uint32_t vertex) const { return NEAR * sheets_[piece_[vertex]].pitch(); }
    bool facing(uint32_t a, uint32_t b) const
    {
        return dot(normals_[a], normals_[b]) >= LEAST_COSINE;
    }
    uint32_t find_common(uint32_t vertex) const;
    void drop_collapsed();
    std::vector<OpenEdge> open_edges() const;
    bool goes_on(const OpenEdge &open) const;
    bool is_gap(const std::vector<OpenEdge> &edges) const;
    void close(const std::vector<OpenEdge> &edges);
    void close_around_middle(const std::vector<uint32_t> &ring,
                             const std::vector<uint32_t> &patch);
    void add(const Triangle &t, uint32_t patch);
    static uint64_t pair_of(uint32_t from, uint32_t to) { return uint64_t(from) << 32 | to; }

    const std::vector<MapSheet> &sheets_;
    const std::vector<std::vector<uint32_t>> &others_;
    std::vector<Vec3d> normals_;
    std::vector<uint32_t> piece_;   /* of a vertex: the first that had it */
    std::vector<uint8_t> at_border_;
    Places places_;                 /* of the common vertices */
    std::unordered_set<uint64_t> used_; /* edges of triangles, while gaps are closed */
};

double widest(const std::vector<MapSheet> &sheets)
{
    double most = 0;
    for (const MapSheet &sheet : sheets)
        most = std::max(most, sheet.pitch());
    return most;
}

} // namespace

Welder::Welder(const std::vector<MapSheet> &sheets, std::vector<SheetPiece> pieces,
               const std::vector<std::vector<uint32_t>> &others)
    : sheets_(sheets), others_(others), places_(NEAR * widest(sheets))
{
    for (uint32_t p = 0; p < pieces.size(); ++p) {
        SheetPiece piece = std::move(pieces[p]);
        const uint32_t first = uint32_t(source.positions.size());
        source.positions.insert(source.positions.end(), piece.positions.begin(),
                                piece.positions.end());
        normals_.insert(normals_.end(), piece.normals.begin(), piece.normals.end());
        at_border_.insert(at_border_.end(), piece.at_border.begin(), piece.at_border.end());
        piece_.resize(source.positions.size(), p);
        for (Triangle t : piece.triangles) {
            for (uint32_t &v : t)
                v += first;
            source.triangles.push_back(t);
            source.patch.push_back(p);
        }
    }
}

/* The nearest common vertex that this one may become. */
uint32_t Welder::find_common(uint32_t vertex) const
{
    uint32_t best = NO_VERTEX;
    double least = INFINITY;
    places_.around(source.positions[vertex], [&](uint32_t other) {
        const double apart = length(source.positions[other] - source.positions[vertex]);
        if (apart <= std::min(reach(vertex), reach(other)) && facing(vertex, other) &&
            (apart < least || (apart == least && other < best))) {
            least = apart;
            best = other;
        }
    });
    return best;
}

/* A vertex without a common one near becomes one itself, so that they keep a distance; then each
 * becomes the nearest. */
void Welder::join_vertices()
{
    const uint32_t count = uint32_t(source.positions.size());
    for (uint32_t v = 0; v < count; ++v)
        if (at_border_[v] && find_common(v) == NO_VERTEX)
            places_.add(source.positions[v], v);
    std::vector<uint32_t> name(count);
    for (uint32_t v = 0; v < count; ++v)
        name[v] = at_border_[v] ? find_common(v) : v;
    for (Triangle &t : source.triangles)
        for (uint32_t &v : t)
            v = name[v];
    drop_collapsed();
}

void Welder::drop_collapsed()
{
    size_t left = 0;
    for (size_t t = 0; t < source.triangles.size(); ++t) {
        const Triangle &v = source.triangles[t];
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
            continue;
        source.triangles[left] = v;
        source.patch[left++] = source.patch[t];
    }
    source.triangles.resize(left);
    source.patch.resize(left);
}

/* Where two pieces claim the same triangle, or the same sliver lies on both its sides; and of several
 * triangles on one side of an edge, all but the first: the gap that is left is closed as any. */
void Welder::drop_folds()
{
    struct Use {
        Edge edge;
        uint32_t triangle;
        bool operator<(const Use &b) const
        {
            return edge != b.edge ? edge < b.edge : triangle < b.triangle;
        }
    };
    std::vector<uint8_t> dropped(source.triangles.size(), 0);
    std::map<Triangle, uint32_t> known;
    std::vector<Use> uses;
    for (uint32_t t = 0; t < source.triangles.size(); ++t) {
        const Triangle &v = source.triangles[t];
        if (at_border_[v[0]] + at_border_[v[1]] + at_border_[v[2]] < 2)
            continue;
        Triangle sorted = v;
        std::sort(sorted.begin(), sorted.end());
        const auto [at, is_new] = known.try_emplace(sorted, t);
        if (!is_new) {
            const Triangle &other = source.triangles[at->second];
            const bool same = other[(corner_of(other, v[0]) + 1) % 3] == v[1];
            dropped[t] = 1;
            dropped[at->second] |= !same;
        }
    }
    for (uint32_t t = 0; t < source.triangles.size(); ++t)
        for (int k = 0; k < 3 && !dropped[t]; ++k) {
            const Edge edge = {source.triangles[t][k], source.triangles[t][(k + 1) % 3]};
            if (at_border_[edge[0]] && at_border_[edge[1]])
                uses.push_back({edge, t});
        }
    std::sort(uses.begin(), uses.end());
    for (size_t i = 1; i < uses.size(); ++i)
        if (uses[i].edge == uses[i - 1].edge)
            dropped[uses[i].triangle] = 1;
    size_t left = 0;
    for (size_t t = 0; t < source.triangles.size(); ++t) {
        if (dropped[t]) {
            for (uint32_t v : source.triangles[t])
                at_border_[v] = 1;
            continue;
        }
        source.triangles[left] = source.triangles[t];
        source.patch[left++] = source.patch[t];
    }
    source.triangles.resize(left);
    source.patch.resize(left);
}

/* Edges with a triangle on one side alone, and that triangle. */
std::vector<OpenEdge> Welder::open_edges() const
{
    std::vector<OpenEdge> edges;
    for (uint32_t t = 0; t < source.triangles.size(); ++t) {
        const Triangle &v = source.triangles[t];
        for (int k = 0; k < 3; ++k)
            if (at_border_[v[k]] && at_border_[v[(k + 1) % 3]])
                edges.push_back({{v[k], v[(k + 1) % 3]}, t});
    }
    std::sort(edges.begin(), edges.end());
    auto has = [&](const Edge &e) {
        const auto at = std::lower_bound(edges.begin(), edges.end(), std::make_pair(e, 0u));
        return at != edges.end() && at->first == e;
    };
    std::vector<OpenEdge> open;
    for (const auto &edge : edges)
        if (!has({edge.first[1], edge.first[0]}))
            open.push_back(edge);
    return open;
}

/* An open edge that passes by a common vertex of another piece goes through it. */
void Welder::split_edges()
{
    const std::vector<OpenEdge> open = open_edges();
    std::vector<uint8_t> is_open(source.positions.size(), 0);
    const double grain = NEAR * widest(sheets_);
    Places ends(grain);
    std::vector<std::vector<uint32_t>> next(source.positions.size());
    for (const auto &[edge, t] : open) {
        next[edge[0]].push_back(edge[1]);
        next[edge[1]].push_back(edge[0]);
        for (uint32_t v : edge) {
            if (!is_open[v])
                ends.add(source.positions[v], v);
            is_open[v] = 1;
        }
    }
    struct Stop {
        double at;
        uint32_t vertex;
        bool operator<(const Stop &b) const { return at != b.at ? at < b.at : vertex < b.vertex; }
    };
    std::vector<uint8_t> divided(source.triangles.size(), 0);
    for (const auto &[edge, t] : open) {
        if (divided[t])
            continue;
        const auto [a, b] = edge;
        const Vec3d from = source.positions[a], way = source.positions[b] - from;
        std::vector<Stop> stops;
        const double size = std::min(reach(a), reach(b)), far = length(way);
        std::vector<uint32_t> seen;
        const int steps = int(std::min(far / grain, MOST_STEPS)) + 1;
        for (int s = 0; s <= steps; ++s)
            ends.around(from + way * (double(s) / steps), [&](uint32_t v) { seen.push_back(v); });
        std::sort(seen.begin(), seen.end());
        seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
        for (uint32_t v : seen) {
            auto beside_of = [&](uint32_t end) {
                return std::find(next[end].begin(), next[end].end(), v) != next[end].end();
            };
            const Vec3d to = source.positions[v] - from;
            const double at = dot(to, way) / (far * far);
            const Triangle &corner = source.triangles[t];
            if (corner_of(corner, v) >= 0 || at <= 0 || at >= 1 || (beside_of(a) && beside_of(b)))
                continue;
            if (length(to - way * at) <= std::min(reach(v), size) && facing(v, a))
                stops.push_back({at, v});
        }
        if (stops.empty())
            continue;
        std::sort(stops.begin(), stops.end());
        divided[t] = 1;
        const Triangle whole = source.triangles[t];
        const uint32_t apex = whole[(corner_of(whole, b) + 1) % 3];
        stops.push_back({1, b});
        uint32_t before = a;
        for (size_t i = 0; i < stops.size(); ++i) {
            const Triangle part = {before, stops[i].vertex, apex};
            if (i == 0) {
                source.triangles[t] = part;
            } else {
                source.triangles.push_back(part);
                source.patch.push_back(source.patch[t]);
            }
            before = stops[i].vertex;
        }
    }
}

/* Whether any sheet shows the surface going on beyond an open edge. */
bool Welder::goes_on(const OpenEdge &open) const
{
    const auto [a, b] = open.first;
    const Triangle &t = source.triangles[open.second];
    const Vec3d from = source.positions[a], way = source.positions[b] - from;
    const Vec3d normal = cross(source.positions[t[1]] - source.positions[t[0]],
                               source.positions[t[2]] - source.positions[t[0]]);
    const uint32_t patch = source.patch[open.second];
    const Vec3d at = from + way * 0.5 +
                     normalize(cross(way, normal)) * (BEYOND * sheets_[patch].pitch());
    auto on = [&](uint32_t p) { return sheets_[p].trim(at, normals_[a]) <= SHOWN; };
    return on(patch) || std::any_of(others_[patch].begin(), others_[patch].end(), on);
}

bool Welder::is_gap(const std::vector<OpenEdge> &edges) const
{
    double around = 0, shown = 0;
    for (const auto &[edge, t] : edges)
        around += length(source.positions[edge[0]] - source.positions[edge[1]]) /
                  sheets_[source.patch[t]].pitch();
    if (around <= SURELY_A_GAP)
        return true;
    for (const OpenEdge &edge : edges)
        shown += goes_on(edge);
    return edges.size() <= MOST_EDGES && shown >= SHOWN_SHARE * double(edges.size());
}

/* Cuts one ear after the other off the ring, that with the shortest side first. */
void Welder::close(const std::vector<OpenEdge> &edges)
{
    std::vector<uint32_t> ring, patch;
    for (const auto &[edge, t] : edges) {
        ring.push_back(edge[0]);
        patch.push_back(source.patch[t]);
    }
    while (ring.size() > 2) {
        const size_t n = ring.size();
        size_t best = n;
        double least = INFINITY;
        for (size_t i = 0; i < n; ++i) {
            const uint32_t from = ring[i], to = ring[(i + 2) % n];
            const double side = length(source.positions[from] - source.positions[to]);
            if (side < least && !(n > 3 && used_.count(pair_of(from, to)))) {
                least = side;
                best = i;
            }
        }
        if (best == n)
            return close_around_middle(ring, patch);
        const size_t tip = (best + 1) % n;
        add({ring[(best + 2) % n], ring[tip], ring[best]}, patch[best]);
        ring.erase(ring.begin() + ptrdiff_t(tip));
        patch.erase(patch.begin() + ptrdiff_t(tip));
    }
}

/* Where every ear would take an edge that others have. */
void Welder::close_around_middle(const std::vector<uint32_t> &ring,
                                 const std::vector<uint32_t> &patch)
{
    const uint32_t middle = uint32_t(source.positions.size());
    Vec3d at;
    for (uint32_t v : ring)
        at += source.positions[v] / double(ring.size());
    source.positions.push_back(at);
    normals_.push_back(normals_[ring[0]]);
    piece_.push_back(piece_[ring[0]]);
    at_border_.push_back(1);
    for (size_t i = 0; i < ring.size(); ++i)
        add({ring[(i + 1) % ring.size()], ring[i], middle}, patch[i]);
}

void Welder::add(const Triangle &t, uint32_t patch)
{
    source.triangles.push_back(t);
    source.patch.push_back(patch);
    for (int k = 0; k < 3; ++k)
        used_.insert(pair_of(t[k], t[(k + 1) % 3]));
}

/* Follows open edges; where a way comes back to a vertex, a ring is complete. */
void Welder::close_gaps()
{
    const std::vector<OpenEdge> open = open_edges();
    std::vector<uint8_t> gone(open.size(), 0);
    used_.clear();
    for (const Triangle &t : source.triangles)
        for (int k = 0; k < 3; ++k)
            if (at_border_[t[k]] && at_border_[t[(k + 1) % 3]])
                used_.insert(pair_of(t[k], t[(k + 1) % 3]));
    constexpr uint32_t OFF = 0xffffffffu;
    std::vector<uint32_t> step(source.positions.size(), OFF); /* of a vertex that is on the way */
    for (size_t start = 0; start < open.size(); ++start) {
        std::vector<OpenEdge> way;
        for (uint32_t here = open[start].first[0];;) {
            if (step[here] != OFF) {
                const std::vector<OpenEdge> ring(way.begin() + step[here], way.end());
                way.resize(step[here]);
                for (const OpenEdge &edge : ring)
                    step[edge.first[0]] = OFF;
                if (ring.size() > 2 && is_gap(ring))
                    close(ring);
            }
            auto next = std::lower_bound(open.begin(), open.end(), OpenEdge{{here, 0}, 0});
            while (next != open.end() && next->first[0] == here && gone[next - open.begin()])
                ++next;
            if (next == open.end() || next->first[0] != here)
                break;
            gone[next - open.begin()] = 1;
            step[here] = uint32_t(way.size());
            way.push_back(*next);
            here = next->first[1];
        }
        for (const OpenEdge &edge : way)
            step[edge.first[0]] = OFF;
    }
}

ShellSource weld(const std::vector<MapSheet> &sheets, std::vector<SheetPiece> pieces,
                 const std::vector<std::vector<uint32_t>> &others)
{
    Welder welder(sheets, std::move(pieces), others);
    welder.join_vertices();
    welder.split_edges();
    for (int n = 0; n < ROUNDS; ++n) { /* what closes a gap may fold in its turn */
        welder.drop_folds();
        welder.close_gaps();
    }
    return std::move(welder.source);
}

} // namespace gtx::baking
