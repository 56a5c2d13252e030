/* Edges of a triangle mesh: half-edge 3 * t + k runs from corner k of triangle t to the next. */
#pragma once

#include "mesh/mesh.hpp"

#include <algorithm>

namespace gtx {

constexpr uint32_t NO_EDGE = 0xffffffffu;

/* The half-edges after and before h in its triangle. */
inline uint32_t next_edge(uint32_t h)
{
    return h % 3 == 2 ? h - 2 : h + 1;
}

inline uint32_t previous_edge(uint32_t h)
{
    return h % 3 == 0 ? h + 2 : h - 1;
}

inline uint32_t start_of(const Mesh &mesh, uint32_t h)
{
    return mesh.triangles[h / 3][h % 3];
}

/* A half-edge in the list of those that share its lower vertex. */
struct EdgeEntry {
    uint32_t high, half_edge; /* the higher vertex */
    bool operator<(const EdgeEntry &o) const
    {
        return high != o.high ? high < o.high : half_edge < o.half_edge;
    }
};

/* In how many parts the vertices of a mesh are best done at once, where each part looks at all
 * triangles for its own: no more than there are threads. */
inline size_t vertex_parts(const Mesh &mesh, const Task &task)
{
    constexpr size_t LEAST = 1 << 12;
    return std::min<size_t>(task.threads(), task.parts(mesh.positions.size(), LEAST));
}

/* Calls visit(entries, count) once for every undirected edge whose lower vertex is in [begin,
 * after), by that vertex, its half-edges in rising order. A counting sort by the lower vertex
 * leaves lists of about three entries. */
template <class Visit>
void for_each_edge(const Vector<std::array<uint32_t, 3>> &triangles, size_t begin, size_t after,
                   Visit visit)
{
    Vector<uint32_t> end(after - begin + 1, 0);
    auto each_half_edge = [&](auto body) {
        for (size_t t = 0; t < triangles.size(); ++t)
            for (int k = 0; k < 3; ++k) {
                uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
                if (const size_t low = std::min(a, b) - begin; low < after - begin)
                    body(low, EdgeEntry{std::max(a, b), uint32_t(3 * t + k)});
            }
    };
    each_half_edge([&](size_t low, const EdgeEntry &) { ++end[low + 1]; });
    for (size_t v = 1; v < end.size(); ++v)
        end[v] += end[v - 1];
    Vector<EdgeEntry> entries(end.back());
    each_half_edge([&](size_t low, const EdgeEntry &entry) { entries[end[low]++] = entry; });

    EdgeEntry *from = entries.data();
    for (size_t v = 0; v < after - begin; ++v) {
        EdgeEntry *to = entries.data() + end[v];
        std::sort(from, to);
        while (from != to) {
            EdgeEntry *first = from;
            while (from != to && from->high == first->high)
                ++from;
            visit(static_cast<const EdgeEntry *>(first), size_t(from - first));
        }
    }
}

/* For every edge of the mesh. */
template <class Visit> void for_each_edge(const Mesh &mesh, Visit visit)
{
    for_each_edge(mesh.triangles, 0, mesh.positions.size(), visit);
}

} // namespace gtx
