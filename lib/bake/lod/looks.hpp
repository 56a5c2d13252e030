/* Searches for what is far, from many triangles at once. */
#pragma once

#include "bake/lod/far_search.hpp"
#include "bake/lod/spots.hpp"

#include <algorithm>
#include <optional>

namespace gtx::baking {

/* Triangles to look at, ascending; none: all. */
using Few = std::optional<Vector<uint32_t>>;

/* Triangles that are looked at one after another. */
constexpr size_t CHUNK = 512;

inline gtx::Box box_around(const Corners &corners, double beyond)
{
    gtx::Box box;
    for (const Vec3d &p : corners) {
        box.add(p + Vec3d(beyond, beyond, beyond));
        box.add(p - Vec3d(beyond, beyond, beyond));
    }
    return box;
}

/* Lists that were made in parts, one after the other. */
template <class Item> Vector<Item> joined(const Vector<Vector<Item>> &parts)
{
    Vector<Item> all;
    for (const Vector<Item> &part : parts)
        all.insert(all.end(), part.begin(), part.end());
    return all;
}

/* Which triangles touch one of the boxes, ascending. */
inline Vector<uint32_t> touching(const SortedSurface &surface, const Vector<gtx::Box> &boxes,
                                 Task &task)
{
    Vector<Vector<uint32_t>> found(surface.tree().parts());
    task.parallel(found.size(), [&](size_t part) {
        Vector<gtx::Box> near;
        for (const gtx::Box &box : boxes)
            if (box.touches(surface.tree().box(part)))
                near.push_back(box);
        const auto touches = [&](const gtx::Box &box) {
            return std::any_of(near.begin(), near.end(),
                               [&](const gtx::Box &b) { return b.touches(box); });
        };
        surface.tree().visit(part, [&](const gtx::Box &box) { return !touches(box); },
                             [&](uint32_t t) {
            gtx::Box box;
            for (const Vec3d &p : surface.corners(t))
                box.add(p);
            if (touches(box))
                found[part].push_back(t);
        });
    }, 1, 1);
    return joined(found);
}

/* In how many parts triangles are looked at, whatever the number of threads. */
inline size_t parts_of(const SortedSurface &from, const Few &few)
{
    return few ? (few->size() + CHUNK - 1) / CHUNK : from.tree().parts();
}

/* `look(part, search, t)` for each triangle of few, or of all that are not in a box that is near
 * enough. */
template <class Look>
void look_at(const SortedSurface &from, const Few &few, const FarSearch &start, const Look &look,
             Task &task)
{
    task.parallel(parts_of(from, few), [&](size_t part) {
        FarSearch search = start;
        if (few)
            for (size_t i = part * CHUNK; i < std::min(few->size(), (part + 1) * CHUNK); ++i)
                look(part, search, (*few)[i]);
        else
            from.tree().visit(part, [&](const gtx::Box &box) { return search.is_covered(box); },
                              [&](uint32_t t) { look(part, search, t); });
    }, 1, 1);
}

/* `counts(t)`: whether triangle t of `from` is to be near. `reached`, or null, is told of those. */
template <class Counts>
double greatest(const SortedSurface &from, const Few &few, const Counts &counts,
                const FarSearch &start, Reached *reached, Task &task)
{
    Vector<double> found(parts_of(from, few), start.found);
    look_at(from, few, start, [&](size_t part, FarSearch &search, uint32_t t) {
        if (!counts(t))
            return;
        search.reach = 0;
        search.look(from.corners(t));
        found[part] = search.found;
        if (reached)
            reached->set(t, search.reach);
    }, task);
    return found.empty() ? start.found : *std::max_element(found.begin(), found.end());
}

/* `add(t, place)` for each triangle that is somewhere farther than start.free. */
template <class Counts, class Add>
Vector<FarPoint> all_far(const SortedSurface &from, const Few &few, const Counts &counts,
                         const FarSearch &start, Reached *reached, const Add &add, Task &task)
{
    Vector<Vector<FarPoint>> found(parts_of(from, few));
    look_at(from, few, start, [&](size_t part, FarSearch &search, uint32_t t) {
        if (!counts(t))
            return;
        search.reach = 0;
        const FarPlace place = search.find_far(from.corners(t));
        if (reached)
            reached->set(t, search.reach);
        if (place.away > 0)
            found[part].push_back(add(t, place));
    }, task);
    return joined(found);
}

} // namespace gtx::baking
