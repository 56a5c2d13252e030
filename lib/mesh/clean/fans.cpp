/* Cleaning, vertex by vertex: one fan of triangles each. */
#include "mesh/clean/clean.hpp"

namespace gtx {

void fan_of(const Vector<uint32_t> &twin, uint32_t c, Vector<uint32_t> &fan)
{
    uint32_t first = c;
    for (uint32_t o; (o = twin[first]) != NO_EDGE;) { /* back to the border, or once around */
        first = next_edge(o);
        if (first == c)
            break;
    }
    fan.clear();
    uint32_t corner = first;
    do {
        fan.push_back(corner);
        corner = twin[previous_edge(corner)];
    } while (corner != NO_EDGE && corner != first);
}

/* The lowest corners of the fans around vertices that a fan of lower corners has, in rising order.
 * All corners of a fan have one vertex, and so one part. */
static Vector<uint32_t> further_fans(const Draft &surface, Task &task)
{
    const Mesh &mesh = surface.mesh;
    Vector<uint8_t> seen(surface.twin.size(), false), taken(mesh.positions.size(), false);
    Vector<Vector<uint32_t>> found(vertex_parts(mesh, task));
    task.in_parts(taken.size(), found.size(), [&](size_t part, size_t from, size_t to) {
        Vector<uint32_t> fan;
        for (uint32_t c = 0; c < surface.twin.size(); ++c) {
            const uint32_t v = start_of(mesh, c);
            if (v < from || v >= to || seen[c])
                continue;
            fan_of(surface.twin, c, fan);
            for (uint32_t corner : fan)
                seen[corner] = true;
            if (taken[v])
                found[part].push_back(c);
            taken[v] = true;
        }
    });
    Vector<uint32_t> all;
    for (const Vector<uint32_t> &own : found)
        all.insert(all.end(), own.begin(), own.end());
    std::sort(all.begin(), all.end());
    return all;
}

static void one_vertex_a_fan(Draft &surface, Task &task)
{
    Mesh &mesh = surface.mesh;
    Vector<uint32_t> fan;
    for (uint32_t c : further_fans(surface, task)) {
        fan_of(surface.twin, c, fan);
        const auto own = uint32_t(mesh.positions.size());
        mesh.positions.push_back(Vec3d(mesh.positions[start_of(mesh, c)]));
        for (uint32_t corner : fan)
            mesh.triangles[corner / 3][corner % 3] = own;
    }
}

/* Calls visit(half_edges) for each group of suspect half-edges with the same two vertices. */
template <class Visit> static void for_each_suspect_edge(const Draft &surface, Visit visit)
{
    struct Entry {
        uint32_t low, high, half_edge;
    };
    Vector<Entry> entries;
    for (uint32_t h : surface.suspect) {
        uint32_t a = start_of(surface.mesh, h), b = start_of(surface.mesh, next_edge(h));
        entries.push_back({std::min(a, b), std::max(a, b), h});
    }
    std::sort(entries.begin(), entries.end(), [](const Entry &a, const Entry &b) {
        return a.low != b.low     ? a.low < b.low
               : a.high != b.high ? a.high < b.high
                                  : a.half_edge < b.half_edge;
    });
    Vector<uint32_t> group;
    for (size_t i = 0; i < entries.size(); ++i) {
        const Entry &e = entries[i];
        if (i > 0 && (e.low != entries[i - 1].low || e.high != entries[i - 1].high)) {
            visit(group);
            group.clear();
        }
        if (group.empty() || group.back() != e.half_edge)
            group.push_back(e.half_edge);
    }
    if (!group.empty())
        visit(group);
}

/* Two sheets may pass the same edge and still be one fan at both its ends, so that no vertex
 * tells them apart. All sides of such an edge are parted. Each fan around an end of it then has the
 * edge at its two ends only; where these are still the same edge they close the fan, and as a fan
 * winds one way they fit. */
void split_fans(Draft &surface, Task &task)
{
    Vector<uint32_t> &twin = surface.twin;
    one_vertex_a_fan(surface, task);
    bool parted = false;
    for_each_suspect_edge(surface, [&](const Vector<uint32_t> &edge) {
        bool clear = edge.size() == 1 || (edge.size() == 2 && twin[edge[0]] == edge[1]);
        if (clear)
            return;
        for (uint32_t h : edge)
            twin[h] = NO_EDGE;
        parted = true;
    });
    if (!parted)
        return;
    one_vertex_a_fan(surface, task);
    for_each_suspect_edge(surface, [&](const Vector<uint32_t> &edge) {
        if (edge.size() == 2) {
            twin[edge[0]] = edge[1];
            twin[edge[1]] = edge[0];
        }
    });
}

} // namespace gtx
