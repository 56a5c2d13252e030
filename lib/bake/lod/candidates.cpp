/* Which vertices may be merged into a neighbour, and what that costs. */
#include "bake/lod/simplify.hpp"

#include <algorithm>
#include <functional>

namespace gtx::baking {

/* A few bytes change at half and at double, of either. */
/* A triangle may turn by as much as has this cosine. */
constexpr double MIN_TURN_COSINE = 0.25;
/* What moving a vertex along a plane costs, as a share of the squared distance: of two that
 * leave the surface alone, the shorter way makes better triangles. */
constexpr double SLIDE = 1e-5;

/* The link condition (Dey et al. 1999): the surface stays what it is, and nothing vanishes whole.
 * Where height fields meet it is no surface, and only the latter counts. */
bool Simplifier::State::keeps_topology(const Fan &fan, uint32_t from, uint32_t to) const
{
    if (start[to + 1] - start[to] > MAX_FAN)
        return false;
    const int at = int(std::find(fan.ring, fan.ring + fan.ring_count, to) - fan.ring);
    const bool has_before = fan.open ? at > 0 : true, has_after = fan.open ? at < fan.count : true;
    const uint32_t before = has_before ? fan.ring[(at + fan.ring_count - 1) % fan.ring_count]
                                       : NO_VERTEX;
    const uint32_t after = has_after ? fan.ring[(at + 1) % fan.ring_count] : NO_VERTEX;
    bool remains = false;
    for (uint32_t i = start[to]; i < start[to + 1]; ++i) {
        const Triangle &t = triangles[around[i]];
        if (corner_of(t, from) >= 0)
            continue;
        remains = true;
        if (fan.meeting)
            break;
        int common = 0;
        for (uint32_t v : t) {
            const bool beside = v == before || v == after;
            if (v != to && !beside && fan.has(v))
                return false;
            common += beside;
        }
        if (common == 2)
            return false;
    }
    return remains;
}

/* Whether a triangle that changes stays where its patch can show it. One that never was there
 * may go anywhere. */
bool Simplifier::State::keeps_place(uint32_t of, const Corners &before, const Corners &after) const
{
    const PatchRegion &region = regions[of];
    std::array<double, 2> was[3], is[3];
    for (int k = 0; k < 3; ++k)
        is[k] = region.place(after[k]);
    const bool turned = winding(is) <= 0;
    if (!turned && region.holds(is))
        return true;
    for (int k = 0; k < 3; ++k)
        was[k] = region.place(before[k]);
    return (!turned || winding(was) <= 0) && (region.holds(is) || !region.holds(was));
}

/* Whether a triangle does so, and does not turn much, when one of its vertices is at `place`. */
bool Simplifier::State::keeps_shape(uint32_t triangle, uint32_t vertex, const Vec3d &place) const
{
    const Triangle &t = triangles[triangle];
    const Corners before = {positions[t[0]], positions[t[1]], positions[t[2]]};
    Corners after = before;
    const int k = corner_of(t, vertex);
    after[k] = place;
    const Vec3d a = before[(k + 1) % 3], b = before[(k + 2) % 3] - a;
    const Vec3d was = cross(b, before[k] - a), is = cross(b, place - a);
    const double sizes = std::sqrt(dot(was, was) * dot(is, is));
    if (dot(was, was) > 0 && dot(was, is) <= MIN_TURN_COSINE * sizes)
        return false;
    return crossing || keeps_place(patch[triangle], before, after);
}

bool Simplifier::State::keeps_shapes(const Fan &fan, uint32_t from, uint32_t to) const
{
    for (int i = 0; i < fan.count; ++i)
        if (corner_of(triangles[fan.triangle[i]], to) < 0 &&
            !keeps_shape(fan.triangle[i], from, positions[to]))
            return false;
    return true;
}

/* The cheapest neighbour that the vertex may be merged into; `to` is NO_VERTEX when there is
 * none. */
Candidate Simplifier::State::find_candidate(uint32_t vertex, double most) const
{
    Candidate none = {0, vertex, NO_VERTEX};
    Fan fan;
    if (!find_fan(vertex, fan))
        return none;
    Candidate options[MAX_FAN + 1];
    int count = 0;
    for (int i = 0; i < fan.ring_count; i += fan.open ? fan.ring_count - 1 : 1) {
        const Vec3d &target = positions[fan.ring[i]], way = target - positions[vertex];
        const double cost = quadrics[vertex].at(target);
        if (cost <= most)
            options[count++] = {float(cost + SLIDE * dot(way, way)), vertex, fan.ring[i]};
    }
    std::sort(options, options + count, [](const Candidate &a, const Candidate &b) {
        return a.cost != b.cost ? a.cost < b.cost : a.to < b.to;
    });
    for (int i = 0; i < count; ++i)
        if (keeps_topology(fan, vertex, options[i].to) && keeps_shapes(fan, vertex, options[i].to))
            return options[i];
    return none;
}

/* What the vertex costs at least; infinite where it must stay. */
float Simplifier::State::least_cost(uint32_t vertex, double most) const
{
    double least = INFINITY;
    for (uint32_t i = start[vertex]; i < start[vertex + 1]; ++i) {
        const Triangle &t = triangles[around[i]];
        const int k = corner_of(t, vertex);
        for (int other = 1; other < 3; ++other) {
            const Vec3d &target = positions[t[(k + other) % 3]], way = target - positions[vertex];
            const double cost = quadrics[vertex].at(target);
            if (cost <= most)
                least = std::min(least, cost + SLIDE * dot(way, way));
        }
    }
    return float(least);
}

/* Those that a round is about: the cheapest, and all below `free`. Whether they may go is looked at
 * for them alone. */
void Simplifier::State::find_candidates(double free, double most)
{
    const double done = 1 - 0.7 * double(triangles.size()) / double(first_count);
    candidates.resize(positions.size());
    const size_t chunk = 2048;
    auto for_all = [&](const std::function<void(Candidate &, size_t)> &body) {
        task.parallel((candidates.size() + chunk - 1) / chunk, [&](size_t n) {
            const size_t end = std::min(candidates.size(), (n + 1) * chunk);
            for (size_t i = n * chunk; i < end; ++i)
                body(candidates[i], i);
        }, done, done);
    };
    for_all([&](Candidate &c, size_t v) {
        if (std::isnan(costs[v]))
            costs[v] = least_cost(uint32_t(v), most);
        c = {costs[v], uint32_t(v), NO_VERTEX};
    });
    auto keep = [&](auto &&kept) {
        candidates.erase(std::partition(candidates.begin(), candidates.end(), kept),
                         candidates.end());
    };
    keep([](const Candidate &c) { return std::isfinite(c.cost); });
    const size_t count = size_t(double(candidates.size()) * share);
    float limit = INFINITY;
    if (count < candidates.size()) {
        std::nth_element(candidates.begin(), candidates.begin() + count, candidates.end(),
                         is_cheaper);
        limit = std::max(candidates[count].cost, float(free));
        keep([&](const Candidate &c) { return c.cost <= limit; });
    }
    for_all([&](Candidate &c, size_t) {
        c = find_candidate(c.from, most);
        costs[c.from] = c.to == NO_VERTEX ? INFINITY : c.cost;
    });
    keep([&](const Candidate &c) { return c.to != NO_VERTEX && c.cost <= limit; });
    /* Among those that cost nothing neighbours go one after another: so more of them find room. */
    auto paid = std::partition(candidates.begin(), candidates.end(),
                               [&](const Candidate &c) { return c.cost <= free; });
    std::sort(candidates.begin(), paid,
              [](const Candidate &a, const Candidate &b) { return a.from < b.from; });
    std::sort(paid, candidates.end(), is_cheaper);
}

} // namespace gtx::baking
