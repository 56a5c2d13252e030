/* Fewer triangles: vertices are merged into a neighbour, cheapest first (Garland and Heckbert
 * 1997), in rounds of many at once that do not touch each other. Borders between patches cost
 * nothing and need no care: both sides share their vertices, and a triangle may reach as far as
 * the maps of its patch do. */
#include "bake/lod/fan.hpp"
#include "bake/lod/outlier.hpp"
#include "bake/lod/parts.hpp"
#include "bake/lod/quadric.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

namespace gtx::baking {

/* Share of the vertices that a round looks at, the cheapest: more once few of them may go. */
constexpr double ROUND_SHARE = 0.4, FEW = 0.02;
/* A triangle may turn by as much as has this cosine. */
constexpr double MIN_TURN_COSINE = 0.25;
/* What moving a vertex along a plane costs, as a share of the squared distance: of two that
 * leave the surface alone, the shorter way makes better triangles. */
constexpr double SLIDE = 1e-5;
/* What settling costs for the squared distance, as a share of what leaving the surface does. */
constexpr double STAY = 0.003;
/* How often half the way is tried. */
constexpr int MOVE_STEPS = 3;
/* What a level may leave outside, as a share of its error. At 0 outlines only grow, and are half as
 * good; at 1 sight passes between parts of a model that nearly touch. */
constexpr double MAX_OUTSIDE = 0.5;

/* Of a triangle. */
using Corners = std::array<Vec3d, 3>;

struct Candidate {
    float cost;                  /* of the cheapest neighbour, whether it may be or not, at first */
    uint32_t from, to;
};

static bool is_cheaper(const Candidate &a, const Candidate &b)
{
    return a.cost != b.cost ? a.cost < b.cost : a.from < b.from;
}

struct Simplifier::State {
    const std::vector<PatchRegion> &regions;
    Task &task;
    std::vector<Vec3d> positions;
    std::vector<Triangle> triangles;
    std::vector<uint32_t> patch;
    std::vector<Quadric> quadrics;
    std::vector<Vec3d> settled;  /* where the vertices go on from for the next level */
    const std::vector<Vec3d> points; /* vertices at the start */
    std::vector<uint32_t> point;     /* of each vertex, the one that it was */
    std::vector<uint32_t> merged;    /* of each point, what it went into; itself: it is left */
    std::vector<uint32_t> start, around; /* triangles of each vertex */
    std::vector<uint8_t> touched;
    /* What each vertex costs at least, as far as is known: NAN where it has to be found out,
     * infinite where it must stay unless something changes around it. */
    std::vector<float> costs;
    std::vector<Candidate> candidates;
    size_t first_count;          /* triangles at the start */
    double share = ROUND_SHARE;  /* of the candidates that a round takes */
    bool crossing = false;       /* triangles may leave their patches */
    double error = 0;            /* squared */

    State(const LodSource &source, const std::vector<PatchRegion> &regions, Task &task)
        : regions(regions), task(task), positions(source.positions), triangles(source.triangles),
          patch(source.patch), points(positions), point(positions.size()),
          first_count(triangles.size())
    {
        std::iota(point.begin(), point.end(), 0u);
        merged = point;
    }
    void find_around();
    bool find_fan(uint32_t vertex, Fan &fan) const
    {
        return baking::find_fan(triangles, around.data() + start[vertex],
                                start[vertex + 1] - start[vertex], vertex, fan);
    }
    bool keeps_topology(const Fan &fan, uint32_t from, uint32_t to) const;
    bool keeps_place(uint32_t patch, const Corners &before, const Corners &after) const;
    bool keeps_shape(uint32_t triangle, uint32_t vertex, const Vec3d &place) const;
    bool keeps_shapes(const Fan &fan, uint32_t from, uint32_t to) const;
    Candidate find_candidate(uint32_t vertex, double most) const;
    float least_cost(uint32_t vertex, double most) const;
    void find_candidates(double free, double most);
    size_t collapse(const Fan &fan, uint32_t from, uint32_t to);
    void compact();
    size_t round(size_t wanted, double free, double most);
    void move(uint32_t vertex, Vec3d way);
    void settle();
    void find_members(std::vector<uint32_t> &first, std::vector<Vec3d> &members);
};

void Simplifier::State::find_around()
{
    start.assign(positions.size() + 1, 0);
    for (const Triangle &t : triangles)
        for (uint32_t v : t)
            ++start[v + 1];
    for (size_t v = 0; v < positions.size(); ++v)
        start[v + 1] += start[v];
    around.resize(3 * triangles.size());
    std::vector<uint32_t> next(start.begin(), start.end() - 1);
    for (size_t t = 0; t < triangles.size(); ++t)
        for (uint32_t v : triangles[t])
            around[next[v]++] = uint32_t(t);
}

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

/* Returns how many triangles are gone. */
size_t Simplifier::State::collapse(const Fan &fan, uint32_t from, uint32_t to)
{
    size_t count = 0;
    for (int i = 0; i < fan.count; ++i) {
        Triangle &t = triangles[fan.triangle[i]];
        const bool gone = corner_of(t, to) >= 0;
        t[corner_of(t, from)] = to;
        if (gone)
            t = {NO_VERTEX, NO_VERTEX, NO_VERTEX};
        count += gone;
    }
    quadrics[to].add(quadrics[from]);
    merged[point[from]] = point[to];
    touched[from] = 1;
    for (int i = 0; i < fan.ring_count; ++i)
        touched[fan.ring[i]] = 1;
    return count;
}

/* Takes out what is gone: triangles, and the vertices that none has. */
void Simplifier::State::compact()
{
    size_t count = 0;
    std::vector<uint32_t> renamed(positions.size(), NO_VERTEX);
    for (size_t t = 0; t < triangles.size(); ++t) {
        if (triangles[t][0] == NO_VERTEX)
            continue;
        triangles[count] = triangles[t];
        patch[count++] = patch[t];
        for (uint32_t v : triangles[t])
            renamed[v] = 0;
    }
    triangles.resize(count);
    patch.resize(count);
    uint32_t vertices = 0;
    for (size_t v = 0; v < positions.size(); ++v) {
        if (renamed[v] == NO_VERTEX)
            continue;
        positions[vertices] = positions[v];
        quadrics[vertices] = quadrics[v];
        point[vertices] = point[v];
        costs[vertices] = touched[v] ? NAN : costs[v];
        renamed[v] = vertices++;
    }
    positions.resize(vertices);
    quadrics.resize(vertices);
    point.resize(vertices);
    costs.resize(vertices);
    for (Triangle &t : triangles)
        for (uint32_t &v : t)
            v = renamed[v];
}

/* Merges vertices that do not touch each other, so that what was found out about each still holds.
 * Returns how many. */
size_t Simplifier::State::round(size_t wanted, double free, double most)
{
    find_around();
    find_candidates(free, most);
    size_t taken = 0;
    touched.assign(positions.size(), 0);
    size_t left = triangles.size();
    Fan fan;
    for (const Candidate &c : candidates) {
        if (left <= wanted && c.cost > free)
            break;
        if (touched[c.from] || touched[c.to])
            continue;
        find_fan(c.from, fan);
        left -= collapse(fan, c.from, c.to);
        ++taken;
    }
    compact();
    return taken;
}

/* Moves a vertex, less far where its triangles need it. */
void Simplifier::State::move(uint32_t vertex, Vec3d way)
{
    for (int n = 0; n < MOVE_STEPS; ++n, way = way * 0.5) {
        const Vec3d place = positions[vertex] + way;
        bool keeps = true;
        for (uint32_t i = start[vertex]; keeps && i < start[vertex + 1]; ++i)
            keeps = keeps_shape(around[i], vertex, place);
        if (keeps) {
            positions[vertex] = place;
            return;
        }
    }
}

/* Sorts the points by the vertex that stands for them: `first` of each, and the end. */
void Simplifier::State::find_members(std::vector<uint32_t> &first, std::vector<Vec3d> &members)
{
    std::vector<uint32_t> vertex(points.size(), NO_VERTEX);
    for (uint32_t v = 0; v < point.size(); ++v)
        vertex[point[v]] = v;
    first.assign(positions.size() + 1, 0);
    for (uint32_t p = 0; p < points.size(); ++p) {
        uint32_t last = p;
        while (merged[last] != last)
            last = merged[last];
        for (uint32_t q = p; q != last;)
            q = std::exchange(merged[q], last);
        vertex[p] = vertex[last];
        if (vertex[p] != NO_VERTEX)
            ++first[vertex[p] + 1];
    }
    for (size_t v = 0; v < positions.size(); ++v)
        first[v + 1] += first[v];
    members.resize(first.back());
    std::vector<uint32_t> next(first.begin(), first.end() - 1);
    for (uint32_t p = 0; p < points.size(); ++p)
        if (vertex[p] != NO_VERTEX)
            members[next[vertex[p]]++] = points[p];
}

/* First to where the planes are nearest, from where the next level goes on; then, for this level
 * alone, outwards again where something stands out: there an outline would be seen to shrink, and
 * sight would pass where it must not. */
void Simplifier::State::settle()
{
    find_around();
    for (uint32_t v = 0; v < positions.size(); ++v) {
        move(v, quadrics[v].way_down(positions[v], STAY));
        error = std::max(error, quadrics[v].at(positions[v]));
    }
    settled = positions;
    if (crossing) /* what is a handful of pixels would only look fatter */
        return;
    Simplified surface = {positions, triangles, start, around, {}, {}};
    find_members(surface.first, surface.points);
    draw_out(surface, MAX_OUTSIDE * std::sqrt(error),
             [&](uint32_t vertex, const Vec3d &way) { move(vertex, way); }, task,
             1 - 0.7 * double(triangles.size()) / double(first_count));
}

Simplifier::Simplifier(const LodSource &source, const std::vector<PatchRegion> &regions,
                       Task &task)
{
    state_ = std::make_unique<State>(source, regions, task);
    state_->find_around();
    state_->quadrics = vertex_quadrics(state_->positions, state_->triangles, state_->start,
                                       state_->around, task);
}

Simplifier::~Simplifier() = default;

void Simplifier::reduce(size_t wanted, double free, double most)
{
    if (!state_->settled.empty())
        state_->positions = std::exchange(state_->settled, {});
    state_->share = ROUND_SHARE;
    state_->costs.assign(state_->positions.size(), NAN);
    for (bool going = true; going;) {
        const size_t taken = state_->round(wanted, free * free, most * most);
        const size_t left = state_->triangles.size();
        const bool few = double(taken) < FEW * double(left);
        /* Past the wanted number a few that still cost nothing are not worth a round. */
        going = left > wanted ? taken > 0 || state_->share < 1 : free > 0 && !few;
        state_->share = few ? std::min(1.0, 2 * state_->share) : ROUND_SHARE;
    }
}

void Simplifier::cross_patches()
{
    state_->crossing = true;
}

void Simplifier::settle()
{
    state_->settle();
}

void Simplifier::drop(const std::vector<uint8_t> &dropped)
{
    size_t left = 0;
    for (size_t t = 0; t < dropped.size(); ++t) {
        if (dropped[t])
            continue;
        state_->triangles[left] = state_->triangles[t];
        state_->patch[left++] = state_->patch[t];
    }
    state_->triangles.resize(left);
    state_->patch.resize(left);
}

const std::vector<Vec3d> &Simplifier::positions() const
{
    return state_->positions;
}

const std::vector<Triangle> &Simplifier::triangles() const
{
    return state_->triangles;
}

const std::vector<uint32_t> &Simplifier::patch() const
{
    return state_->patch;
}

double Simplifier::error() const
{
    return std::sqrt(state_->error);
}

} // namespace gtx::baking
