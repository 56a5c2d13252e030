/* Moves the vertices that are left to where they show best what they stand for. */
#include "bake/lod/outlier.hpp"
#include "bake/lod/simplify.hpp"

#include <algorithm>
#include <utility>

namespace gtx::baking {

/* A few bytes change at half and at double of all three. */
/* What settling costs for the squared distance, as a share of what leaving the surface does. */
constexpr double STAY = 0.003;
/* How often half the way is tried. */
constexpr int MOVE_STEPS = 3;
/* What a level may leave outside, as a share of its error. At 0 outlines only grow, and are half as
 * good; at 1 sight passes between parts of a model that nearly touch. */
constexpr double MAX_OUTSIDE = 0.5;
/* Points of the surface that a vertex of the first level draws out to, of those that it stands
 * for. */
constexpr uint32_t MAX_POINTS = 6;
/* Of the points between a level's vertices one of so many tells the next too. */
constexpr uint32_t LATER_POINTS = 4;

/* Moves a vertex, less far where its triangles need it. */
bool Simplifier::State::move(uint32_t vertex, Vec3d way)
{
    if (stays(vertex))
        return false;
    for (int n = 0; n < MOVE_STEPS; ++n, way = way * 0.5) {
        const Vec3d place = positions[vertex] + way;
        bool keeps = true;
        for (uint32_t i = start[vertex]; keeps && i < start[vertex + 1]; ++i)
            keeps = keeps_shape(around[i], vertex, place, false);
        if (keeps) {
            positions[vertex] = place;
            return true;
        }
    }
    return false;
}

/* Sorts the points by the vertex that stands for them: `first` of each, and the end. */
void Simplifier::State::find_members(Vector<uint32_t> &first, Vector<Vec3d> &members)
{
    Vector<uint32_t> vertex(points.size(), NO_VERTEX);
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
        if (vertex[p] != NO_VERTEX && first_points && first[vertex[p] + 1] == MAX_POINTS)
            vertex[p] = NO_VERTEX;
        if (vertex[p] != NO_VERTEX)
            ++first[vertex[p] + 1];
    }
    for (size_t v = 0; v < positions.size(); ++v)
        first[v + 1] += first[v];
    members.resize(first.back());
    Vector<uint32_t> next(first.begin(), first.end() - 1);
    for (uint32_t p = 0; p < points.size(); ++p)
        if (vertex[p] != NO_VERTEX)
            members[next[vertex[p]]++] = points[p];
}

/* The next level is told of the surface by the vertices of this one and by some of the points
 * between: they are many more than its own still. find_members() has made merged[] one step. */
void Simplifier::State::keep_points()
{
    first_points = false;
    Vector<uint8_t> is_vertex(points.size(), 0);
    for (uint32_t p : point)
        is_vertex[p] = 1;
    Vector<uint32_t> name(points.size(), NO_VERTEX), still;
    for (uint32_t p = 0; p < points.size(); ++p) {
        if (!is_vertex[p] && (p % LATER_POINTS || !is_vertex[merged[p]]))
            continue;
        name[p] = uint32_t(still.size());
        points[still.size()] = points[p];
        still.push_back(merged[p]);
    }
    points.resize(still.size());
    for (uint32_t &p : still)
        p = name[p];
    for (uint32_t &p : point)
        p = name[p];
    merged.swap(still);
}

/* First to where the planes are nearest, from where the next level goes on; then, for this level
 * alone, outwards again where something stands out: there an outline would be seen to shrink, and
 * sight would pass where it must not. */
void Simplifier::State::settle()
{
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
             [&](uint32_t vertex, const Vec3d &way) { return move(vertex, way); }, task, done());
    keep_points();
}

} // namespace gtx::baking
