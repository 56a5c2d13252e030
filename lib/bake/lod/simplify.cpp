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
    : regions(regions), task(task), first_count(source.triangles.size())
{
    sort_by_patch(source);
    points = positions;
    point.resize(positions.size());
    std::iota(point.begin(), point.end(), 0u);
    merged = point;
}

/* What lies in a patch becomes neighbours in memory, and most of it a block's own. */
void Simplifier::State::sort_by_patch(const LodSource &source)
{
    Vector<uint32_t> next(regions.size() + 1, 0), order(source.triangles.size());
    for (uint32_t p : source.patch)
        ++next[p + 1];
    for (size_t p = 0; p < regions.size(); ++p)
        next[p + 1] += next[p];
    for (size_t t = 0; t < source.triangles.size(); ++t)
        order[next[source.patch[t]]++] = uint32_t(t);
    Vector<uint32_t> name(source.positions.size(), NO_VERTEX);
    positions.reserve(source.positions.size());
    triangles.reserve(order.size());
    patch.reserve(order.size());
    for (uint32_t t : order) {
        triangles.push_back(source.triangles[t]);
        patch.push_back(source.patch[t]);
        for (uint32_t &v : triangles.back()) {
            if (name[v] == NO_VERTEX) {
                name[v] = uint32_t(positions.size());
                positions.push_back(source.positions[v]);
                if (!source.kept.empty())
                    kept.push_back(source.kept[v]);
            }
            v = name[v];
        }
    }
}

void Simplifier::State::find_around(size_t vertices)
{
    start.assign(vertices + 1, 0);
    for (const Triangle &t : triangles)
        for (uint32_t v : t)
            ++start[v + 1];
    for (size_t v = 0; v < vertices; ++v)
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
size_t Simplifier::State::collapse(const Fan &fan, uint32_t from, uint32_t to, double most)
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
    const bool edges_stay = !fan.open && !fan.meeting && fan.count > 2;
    for (int i = 0; i < fan.ring_count; ++i) {
        const uint32_t v = fan.ring[i];
        touched[v] = 1;
        Choice &choice = choices[v];
        if (!edges_stay || v == to || choice.to == from || choice.to == NO_VERTEX)
            choice = {NAN, NO_VERTEX};
        else
            choice = std::min(choice, cost_of(v, to, most));
    }
    return count;
}

/* Takes out what is gone: triangles, and the vertices that none has. The largest jobs are first. */
void Simplifier::State::compact()
{
    Vector<uint32_t> renamed(positions.size(), NO_VERTEX);
    for (const Triangle &t : triangles)
        for (size_t k = 0; k < 3 && t[0] != NO_VERTEX; ++k)
            renamed[t[k]] = 0;
    uint32_t vertices = 0;
    for (uint32_t &name : renamed)
        name = name == NO_VERTEX ? NO_VERTEX : vertices++;
    const auto keep = [&](auto &items) {
        for (size_t v = 0; v < items.size(); ++v)
            if (renamed[v] != NO_VERTEX)
                items[renamed[v]] = items[v];
        items.resize(items.empty() ? 0 : vertices);
    };
    const std::function<void()> jobs[] = {
        [&] {
            size_t count = 0;
            for (size_t t = 0; t < triangles.size(); ++t) {
                if (triangles[t][0] == NO_VERTEX)
                    continue;
                for (size_t k = 0; k < 3; ++k)
                    triangles[count][k] = renamed[triangles[t][k]];
                patch[count++] = patch[t];
            }
            triangles.resize(count);
            patch.resize(count);
            find_around(vertices);
        },
        [&] { keep(quadrics); },
        [&] {
            keep(positions);
            keep(kept);
            keep(point);
            keep(choices);
            for (Choice &c : choices)
                c.to = c.to == NO_VERTEX ? NO_VERTEX : renamed[c.to];
        }};
    const bool few = renamed.size() < BLOCK; /* threads take longer to start */
    task.in_parts(std::size(jobs), few ? 1 : std::size(jobs), [&](size_t, size_t from, size_t to) {
        for (size_t n = from; n < to; ++n)
            jobs[n]();
    });
}

/* Whether what merging it changes lies in the block. */
bool Simplifier::State::is_inside(uint32_t vertex, size_t block) const
{
    for (uint32_t i = start[vertex]; i < start[vertex + 1]; ++i)
        for (uint32_t v : triangles[around[i]])
            if (v / BLOCK != block)
                return false;
    return true;
}

/* Returns how many triangles are gone. */
size_t Simplifier::State::merge(uint32_t vertex, float limit, double most)
{
    Fan fan;
    Choice &choice = choices[vertex];
    if (touched[vertex] || touched[choice.to])
        return 0;
    const bool free = !stays(vertex) && find_fan(vertex, fan);
    const Choice found = free ? choose(vertex, fan, most) : Choice();
    if (found.to != NO_VERTEX && touched[found.to])
        return 0;
    choice = found;
    return found.cost <= limit && found.to != NO_VERTEX ? collapse(fan, vertex, found.to, most) : 0;
}

/* Merges vertices that do not touch each other, so that what was found out about each still holds:
 * those inside a block on a thread each, then those between blocks. Returns how many. */
size_t Simplifier::State::round(size_t wanted, double free, double most)
{
    find_costs(most);
    const float limit = find_limit(free);
    const size_t blocks = (positions.size() + BLOCK - 1) / BLOCK, before = positions.size();
    touched.assign(before, 0);
    Vector<Vector<Candidate>> outside(blocks);
    Vector<size_t> gone(blocks, 0);
    const double surplus = double(triangles.size()) - double(std::min(wanted, triangles.size()));
    const double share_of_block = surplus / double(before);
    task.parallel(blocks, [&](size_t block) {
        const size_t size = std::min(before, (block + 1) * BLOCK) - block * BLOCK;
        const size_t quota = size_t(share_of_block * double(size)) + 1;
        for (const Candidate &c : find_candidates(block, free, limit)) {
            if (!is_inside(c.from, block))
                outside[block].push_back(c);
            else if (gone[block] < quota || c.cost <= free)
                gone[block] += merge(c.from, limit, most);
        }
    }, done(), done());
    Vector<Candidate> rest;
    size_t left = triangles.size();
    for (size_t block = 0; block < blocks; ++block) {
        rest.insert(rest.end(), outside[block].begin(), outside[block].end());
        left -= gone[block];
    }
    const auto paid = std::stable_partition(rest.begin(), rest.end(), [&](const Candidate &c) {
        return c.cost <= free;
    });
    std::sort(paid, rest.end(), is_cheaper);
    for (const Candidate &c : rest) {
        if (left <= wanted && c.cost > free)
            break;
        cancel_point();
        left -= merge(c.from, limit, most);
    }
    compact();
    return before - positions.size();
}

Simplifier::Simplifier(const LodSource &source, const Vector<PatchRegion> &regions,
                       Task &task)
{
    state_ = std::make_unique<State>(source, regions, task);
    state_->find_around(state_->positions.size());
    state_->quadrics = vertex_quadrics(state_->positions, state_->triangles, state_->start,
                                       state_->around, task);
}

Simplifier::~Simplifier() = default;

void Simplifier::reduce(size_t wanted, double free, double most)
{
    if (!state_->settled.empty())
        state_->positions = std::exchange(state_->settled, {});
    state_->share = ROUND_SHARE;
    state_->choices.assign(state_->positions.size(), {NAN, NO_VERTEX});
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
    state_->find_around(state_->positions.size());
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

const Vector<uint8_t> &Simplifier::kept() const
{
    return state_->kept;
}

double Simplifier::error() const
{
    return std::sqrt(state_->error);
}

} // namespace gtx::baking
