/* Cleaning, edge by edge: at most two triangles each, and one winding for each component. */
#include "mesh/clean/clean.hpp"

namespace gtx {

static void join(Vector<uint32_t> &twin, uint32_t a, uint32_t b)
{
    twin[a] = b;
    twin[b] = a;
}

/* Two triangles that may continue each other over an edge of many. */
struct Candidate {
    bool mixed;
    double agreement;
    uint32_t a, b;
    bool operator<(const Candidate &o) const
    {
        return mixed != o.mixed           ? o.mixed
               : agreement != o.agreement ? agreement > o.agreement
               : a != o.a                 ? a < o.a
                                          : b < o.b;
    }
};

/* Greedy: of the triangles that run the edge in opposite directions, those two whose normals agree
 * best continue each other. A sheet without thickness adds nothing to a surface that it
 * touches, so it must not take a side from it. Of an edge with very many triangles no surface can
 * be told. */
static void pair_many(Draft &surface, const EdgeEntry *edge, size_t count)
{
    constexpr size_t most = 64;
    if (count > most)
        return;
    Vec3d normals[most];
    for (size_t i = 0; i < count; ++i)
        normals[i] = normalize(surface.mesh.area_vector(edge[i].half_edge / 3));
    Vector<Candidate> candidates;
    for (size_t i = 0; i < count; ++i)
        for (size_t j = i + 1; j < count; ++j) {
            uint32_t a = edge[i].half_edge, b = edge[j].half_edge;
            bool mixed = surface.thin[a / 3] != surface.thin[b / 3];
            if (start_of(surface.mesh, a) != start_of(surface.mesh, b))
                candidates.push_back({mixed, dot(normals[i], normals[j]), a, b});
        }
    std::sort(candidates.begin(), candidates.end());
    for (const Candidate &c : candidates)
        if (surface.twin[c.a] == NO_EDGE && surface.twin[c.b] == NO_EDGE)
            join(surface.twin, c.a, c.b);
}

void pair_edges(Draft &surface, Task &task, CleanReport &report)
{
    const Mesh &mesh = surface.mesh;
    surface.twin.assign(3 * mesh.triangles.size(), NO_EDGE);
    struct Found {
        Vector<uint32_t> suspect;
        uint64_t nonmanifold = 0;
        bool reversed = false;
    };
    Vector<Found> found(vertex_parts(mesh, task));
    task.in_parts(mesh.positions.size(), found.size(), [&](size_t part, size_t from, size_t to) {
        Found own;
        for_each_edge(mesh.triangles, from, to, [&](const EdgeEntry *edge, size_t count) {
            if (count == 2) {
                const uint32_t a = edge[0].half_edge, b = edge[1].half_edge;
                join(surface.twin, a, b);
                own.reversed = own.reversed || start_of(mesh, a) == start_of(mesh, b);
            }
            if (count <= 2)
                return;
            ++own.nonmanifold;
            pair_many(surface, edge, count);
            for (size_t i = 0; i < count; ++i)
                own.suspect.push_back(edge[i].half_edge);
        });
        found[part] = std::move(own);
    });
    for (const Found &own : found) {
        surface.suspect.insert(surface.suspect.end(), own.suspect.begin(), own.suspect.end());
        report.nonmanifold_edges += own.nonmanifold;
        surface.reversed = surface.reversed || own.reversed;
    }
}

void turn_triangles(Draft &surface, const Vector<uint8_t> &turn)
{
    Mesh &mesh = surface.mesh;
    /* Exchanging corners 1 and 2 reverses edge 1 and exchanges edges 0 and 2. */
    auto moved = [&](uint32_t h) { return turn[h / 3] ? h - h % 3 + (2 - h % 3) : h; };
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!turn[t])
            continue;
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
        for_each_corner_attribute(mesh, [&](auto &items) {
            if (!items.empty())
                std::swap(items[3 * t + 1], items[3 * t + 2]);
        });
        std::swap(surface.twin[3 * t], surface.twin[3 * t + 2]);
        surface.turned[t] ^= 1;
    }
    for (uint32_t &o : surface.twin)
        if (o != NO_EDGE)
            o = moved(o);
    for (uint32_t &h : surface.suspect)
        h = moved(h);
}

/* Around a one-sided surface the flood meets itself turned over: there it is cut. */
void orient(Draft &surface)
{
    if (!surface.reversed)
        return;
    const Mesh &mesh = surface.mesh;
    Vector<uint32_t> &twin = surface.twin;
    Vector<uint8_t> turn(mesh.triangles.size(), 0);
    bool any = false;
    Components components = flood(twin, [&](uint32_t h, uint32_t o, bool fresh) {
        uint8_t wanted = turn[h / 3] ^ uint8_t(start_of(mesh, h) == start_of(mesh, o));
        if (fresh) {
            turn[o / 3] = wanted;
            any = any || wanted;
        } else if (turn[o / 3] != wanted) {
            twin[h] = twin[o] = NO_EDGE;
            surface.suspect.insert(surface.suspect.end(), {h, o});
            ++surface.cut_edges;
        }
    });
    if (!any)
        return;
    for (size_t c = 0; c < components.count(); ++c) {
        size_t from = components.first[c], to = components.first[c + 1], turned = 0;
        for (size_t i = from; i < to; ++i)
            turned += turn[components.order[i]];
        for (size_t i = from; i < to && 2 * turned > to - from; ++i)
            turn[components.order[i]] ^= 1;
    }
    turn_triangles(surface, turn);
}

} // namespace gtx
