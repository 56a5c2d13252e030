/* Fewer triangles: vertices are merged into a neighbour, cheapest first (Garland and Heckbert
 * 1997), in rounds of many at once that do not touch each other. Borders between patches cost
 * nothing and need no care: both sides share their vertices, and a triangle may reach as far as
 * the maps of its patch do. */
#include "bake/lod/simplify.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace gtx::baking {

/* So few of the vertices that are left are not worth a round of their own. Spot's control mesh:
 * error +5 % at double. */
constexpr double FEW = 0.02;

Simplifier::State::State(const LodSource &source, const Vector<PatchRegion> &regions,
                         Task &task)
    : regions(regions), task(task), positions(source.positions), triangles(source.triangles),
      patch(source.patch), points(positions), point(positions.size()),
      first_count(triangles.size())
{
    std::iota(point.begin(), point.end(), 0u);
    merged = point;
}

void Simplifier::State::find_around()
{
    start.assign(positions.size() + 1, 0);
    for (const Triangle &t : triangles)
        for (uint32_t v : t)
            ++start[v + 1];
    for (size_t v = 0; v < positions.size(); ++v)
        start[v + 1] += start[v];
    around.resize(3 * triangles.size());
    Vector<uint32_t> next(start.begin(), start.end() - 1);
    for (size_t t = 0; t < triangles.size(); ++t) {
        cancel_point();
        for (uint32_t v : triangles[t])
            around[next[v]++] = uint32_t(t);
    }
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
    Vector<uint32_t> renamed(positions.size(), NO_VERTEX);
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
        cancel_point();
        find_fan(c.from, fan);
        left -= collapse(fan, c.from, c.to);
        ++taken;
    }
    compact();
    return taken;
}

Simplifier::Simplifier(const LodSource &source, const Vector<PatchRegion> &regions,
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

void Simplifier::drop(const Vector<uint8_t> &dropped)
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

const Vector<Vec3d> &Simplifier::positions() const
{
    return state_->positions;
}

const Vector<Triangle> &Simplifier::triangles() const
{
    return state_->triangles;
}

const Vector<uint32_t> &Simplifier::patch() const
{
    return state_->patch;
}

double Simplifier::error() const
{
    return std::sqrt(state_->error);
}

} // namespace gtx::baking
