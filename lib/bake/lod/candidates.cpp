/* Which vertices may be merged into a neighbour, and what that costs. */
#include "bake/lod/simplify.hpp"

#include <algorithm>

namespace gtx::baking {

/* A few bytes change at half and at double. */
/* What moving a vertex along a plane costs, as a share of the squared distance: of two that
 * leave the surface alone, the shorter way makes better triangles. */
constexpr double SLIDE = 1e-5;

/* The link condition (Dey et al. 1999): the surface stays what it is, and nothing vanishes whole.
 * Where height fields meet it is no surface, and only the latter counts. */
bool Simplifier::State::keeps_topology(const Fan &fan, uint32_t from, uint32_t to) const
{
    if (start[to + 1] - start[to] > MAX_FAN)
        return false;
    const int at = index_of(fan.ring, fan.ring_count, to);
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

/* Whether a triangle stays where its patch can show it, and does not turn much, when one of its
 * vertices is at `place`. */
bool Simplifier::State::keeps_shape(uint32_t triangle, uint32_t vertex, const Vec3d &place,
                                    bool same_area) const
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
    return crossing || regions[patch[triangle]].keeps(before, after, same_area);
}

bool Simplifier::State::keeps_shapes(const Fan &fan, uint32_t from, uint32_t to) const
{
    bool one_patch = !fan.open && !fan.meeting;
    for (int i = 1; i < fan.count; ++i)
        one_patch = one_patch && patch[fan.triangle[i]] == patch[fan.triangle[0]];
    for (int i = 0; i < fan.count; ++i)
        if (corner_of(triangles[fan.triangle[i]], to) < 0 &&
            !keeps_shape(fan.triangle[i], from, positions[to], one_patch))
            return false;
    return true;
}

/* What merging a vertex into a neighbour costs. */
static Choice cost_between(const Quadric &quadric, const Vec3d &from, const Vec3d &place,
                           uint32_t to, double most)
{
    const Vec3d way = place - from;
    const double cost = quadric.at(place);
    return cost <= most ? Choice{float(cost + SLIDE * dot(way, way)), to} : Choice();
}

Choice Simplifier::State::cost_of(uint32_t vertex, uint32_t to, double most) const
{
    return cost_between(quadrics[vertex], positions[vertex], positions[to], to, most);
}

/* What merging a vertex into the cheapest of its neighbours costs, whether it may be or not. In a
 * closed fan each neighbour comes after the vertex once. */
Choice Simplifier::State::cheapest(uint32_t vertex, double most) const
{
    const Quadric quadric = quadrics[vertex];
    const Vec3d from = positions[vertex];
    Choice least;
    uint64_t after = 0, before = 0;
    for (uint32_t i = start[vertex]; i < start[vertex + 1]; ++i) {
        const Triangle &t = triangles[around[i]];
        const int k = corner_of(t, vertex), next = k == 2 ? 0 : k + 1;
        const uint32_t to = t[next];
        after += to;
        before += t[3 - k - next];
        least = std::min(least, cost_between(quadric, from, positions[to], to, most));
    }
    for (uint32_t i = start[vertex]; after != before && i < start[vertex + 1]; ++i) {
        const Triangle &t = triangles[around[i]];
        const uint32_t to = t[(corner_of(t, vertex) + 2) % 3];
        least = std::min(least, cost_of(vertex, to, most));
    }
    return least;
}

/* The cheapest neighbour that the vertex may be merged into, or a cheaper one that is touched;
 * NO_VERTEX when there is none. Mostly it is the cheapest of all. */
Choice Simplifier::State::choose(uint32_t vertex, const Fan &fan, double most) const
{
    auto suits = [&](const Choice &c) {
        return touched[c.to] ||
               (keeps_topology(fan, vertex, c.to) && keeps_shapes(fan, vertex, c.to));
    };
    const Choice &least = choices[vertex];
    if (suits(least))
        return least;
    Choice options[2 * MAX_FAN];
    int count = 0;
    for (int i = 0; i < fan.ring_count; i += fan.open ? fan.ring_count - 1 : 1) {
        const Choice option = cost_of(vertex, fan.ring[i], most);
        if (option.to != NO_VERTEX && option.to != least.to)
            options[count++] = option;
    }
    std::sort(options, options + count);
    for (int i = 0; i < count; ++i)
        if (suits(options[i]))
            return options[i];
    return {};
}

void Simplifier::State::find_costs(double most)
{
    const size_t count = positions.size();
    task.parallel((count + BLOCK - 1) / BLOCK, [&](size_t block) {
        const size_t end = std::min(count, (block + 1) * BLOCK);
        for (size_t v = block * BLOCK; v < end; ++v)
            if (std::isnan(choices[v].cost))
                choices[v] = cheapest(uint32_t(v), most);
    }, done(), done());
}

/* What is cheaper goes this round: a share of the vertices, and all that cost nothing. */
float Simplifier::State::find_limit(double free) const
{
    Vector<float> costs;
    costs.reserve(choices.size());
    for (const Choice &c : choices)
        if (std::isfinite(c.cost))
            costs.push_back(c.cost);
    const size_t count = size_t(double(costs.size()) * share);
    if (count >= costs.size())
        return INFINITY;
    std::nth_element(costs.begin(), costs.begin() + ptrdiff_t(count), costs.end());
    return std::max(costs[count], float(free));
}

/* Those of a block, the cheapest first; among those that cost nothing neighbours go one after
 * another: so more of them find room. */
Vector<Candidate> Simplifier::State::find_candidates(size_t block, double free,
                                                     float limit) const
{
    Vector<Candidate> out;
    const size_t end = std::min(positions.size(), (block + 1) * BLOCK);
    for (size_t v = block * BLOCK; v < end; ++v)
        if (choices[v].cost <= limit && std::isfinite(choices[v].cost))
            out.push_back({choices[v].cost, uint32_t(v)});
    const auto paid = std::stable_partition(out.begin(), out.end(), [&](const Candidate &c) {
        return c.cost <= free;
    });
    std::sort(paid, out.end(), is_cheaper);
    return out;
}

} // namespace gtx::baking
