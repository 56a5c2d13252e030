/* What is still open or lies double between welded pieces. */
#include "bake/lod/weld.hpp"

#include <map>

namespace gtx::baking {

/* An opening of no more than so many texels around is a gap between pieces; so is a larger one, of
 * so many edges at most, where height fields show something beyond this share of them, so far from
 * the edge. Measured on LOD meshes of the bunny's and Duck's maps: the finest mesh errs by up to
 * 7 % more or less at half and at double; MAX_EDGES is a limit: at half Duck's errs 3 % more. */
constexpr double SURELY_A_GAP = 3.5, SHOWN_SHARE = 0.5, BEYOND = 0.5;
constexpr size_t MAX_EDGES = 128;

/* Marks triangles of the same corners but one; those that lie on each other's back, both. */
static void mark_twins(const Vector<Triangle> &triangles,
                       const Vector<uint8_t> &at_border, Vector<uint8_t> &dropped)
{
    std::map<Triangle, uint32_t> known;
    for (uint32_t t = 0; t < triangles.size(); ++t) {
        const Triangle &v = triangles[t];
        if (at_border[v[0]] + at_border[v[1]] + at_border[v[2]] < 2)
            continue;
        Triangle sorted = v;
        std::sort(sorted.begin(), sorted.end());
        const auto [at, is_new] = known.try_emplace(sorted, t);
        if (is_new)
            continue;
        const Triangle &other = triangles[at->second];
        dropped[t] = 1;
        dropped[at->second] |= other[(corner_of(other, v[0]) + 1) % 3] != v[1];
    }
}

/* Where two pieces claim the same, and of several triangles on one side of an edge all but the
 * first: the gap that is left is closed as any. */
void Welder::drop_folds()
{
    Vector<uint8_t> dropped(source.triangles.size(), 0);
    mark_twins(source.triangles, at_border_, dropped);
    Vector<OpenEdge> edges;
    for (uint32_t t = 0; t < source.triangles.size(); ++t)
        for (int k = 0; k < 3 && !dropped[t]; ++k) {
            const Edge edge = {source.triangles[t][k], source.triangles[t][(k + 1) % 3]};
            if (at_border_[edge[0]] && at_border_[edge[1]])
                edges.push_back({edge, t});
        }
    std::sort(edges.begin(), edges.end());
    for (size_t i = 1; i < edges.size(); ++i)
        if (edges[i].first == edges[i - 1].first)
            dropped[edges[i].second] = 1;
    for (size_t t = 0; t < dropped.size(); ++t)
        for (int k = 0; k < 3 && dropped[t]; ++k)
            at_border_[source.triangles[t][k]] = 1;
    drop(dropped);
}

/* Whether any height field shows the surface going on beyond an open edge. */
bool Welder::goes_on(const OpenEdge &open) const
{
    const uint32_t a = open.first[0];
    const Triangle &t = source.triangles[open.second];
    const Vec3d from = source.positions[a], way = source.positions[open.first[1]] - from;
    const Vec3d normal = cross(source.positions[t[1]] - source.positions[t[0]],
                               source.positions[t[2]] - source.positions[t[0]]);
    const uint32_t patch = source.patch[open.second];
    const Vec3d at = from + way * 0.5 +
                     normalize(cross(way, normal)) * (BEYOND * fields_[patch].fine_texel());
    auto on = [&](uint32_t p) { return fields_[p].trim_at(at, normals_[a]) <= GTX_TRIM_SHOWN; };
    return on(patch) || std::any_of(others_[patch].begin(), others_[patch].end(), on);
}

bool Welder::is_gap(const Vector<OpenEdge> &edges) const
{
    double around = 0, shown = 0;
    for (const auto &[edge, t] : edges)
        around += length(source.positions[edge[0]] - source.positions[edge[1]]) /
                  fields_[source.patch[t]].fine_texel();
    if (around <= SURELY_A_GAP)
        return true;
    for (const OpenEdge &edge : edges)
        shown += goes_on(edge);
    return edges.size() <= MAX_EDGES && shown >= SHOWN_SHARE * double(edges.size());
}

/* Cuts one ear after the other off the ring, that with the shortest side first. */
void Welder::close(const Vector<OpenEdge> &edges)
{
    Vector<uint32_t> ring, patch;
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
void Welder::close_around_middle(const Vector<uint32_t> &ring,
                                 const Vector<uint32_t> &patch)
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
    const Vector<OpenEdge> open = open_edges();
    Vector<uint8_t> gone(open.size(), 0);
    used_.clear();
    for (const Triangle &t : source.triangles)
        for (int k = 0; k < 3; ++k)
            if (at_border_[t[k]] && at_border_[t[(k + 1) % 3]])
                used_.insert(pair_of(t[k], t[(k + 1) % 3]));
    constexpr uint32_t OFF = 0xffffffffu;
    Vector<uint32_t> step(source.positions.size(), OFF);      /* of a vertex that is on the way */
    for (size_t start = 0; start < open.size(); ++start) {
        Vector<OpenEdge> way;
        for (uint32_t here = open[start].first[0];;) {
            if (step[here] != OFF) {
                const Vector<OpenEdge> ring(way.begin() + step[here], way.end());
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

} // namespace gtx::baking
