/* The inside of simplifying: a surface while its vertices are merged. */
#pragma once

#include "bake/lod/fan.hpp"
#include "bake/lod/parts.hpp"
#include "bake/lod/quadric.hpp"

namespace gtx::baking {

/* Share of the vertices that a round looks at, the cheapest: more once few of them may go.
 * Spot's control mesh: error +13 % at half, +2 % at double. */
constexpr double ROUND_SHARE = 0.4;

/* Vertices next to each other in memory, that one thread merges. */
constexpr size_t BLOCK = 1 << 14;

/* What a vertex is merged into, and what that costs. */
struct Choice {
    float cost = INFINITY;
    uint32_t to = NO_VERTEX;

    bool operator<(const Choice &o) const { return cost != o.cost ? cost < o.cost : to < o.to; }
};

struct Candidate {
    float cost;
    uint32_t from;
};

inline bool is_cheaper(const Candidate &a, const Candidate &b)
{
    return a.cost != b.cost ? a.cost < b.cost : a.from < b.from;
}

struct Simplifier::State {
    const Vector<PatchRegion> &regions;
    Task &task;
    Vector<Vec3d> positions;
    Vector<Triangle> triangles;
    Vector<uint32_t> patch;
    Vector<Quadric> quadrics;
    Vector<Vec3d> settled;       /* where the vertices go on from for the next level */
    Vector<Vec3d> points;        /* of the surface, that vertices stand for */
    Vector<uint32_t> point;          /* of each vertex, the one that it was */
    Vector<uint32_t> merged;         /* of each point, what it went into; itself: it is left */
    Vector<uint32_t> start, around;      /* triangles of each vertex, between two rounds */
    Vector<uint8_t> touched;
    /* Of each vertex the cheapest, as far as is known: NAN where it has to be found out, infinite
     * where it must stay unless something changes around it. */
    Vector<Choice> choices;
    size_t first_count;          /* triangles at the start */
    double share = ROUND_SHARE;  /* of the candidates that a round takes */
    bool first_points = true;    /* all vertices of the start are still points */
    bool crossing = false;       /* triangles may leave their patches */
    Vector<uint8_t> kept;        /* of the vertices, as in LodSource */
    double error = 0;            /* squared */

    State(const LodSource &source, const Vector<PatchRegion> &regions, Task &task);
    void sort_by_patch(const LodSource &source);
    void find_around(size_t vertices);
    bool find_fan(uint32_t vertex, Fan &fan) const
    {
        return baking::find_fan(triangles, around.data() + start[vertex],
                                start[vertex + 1] - start[vertex], vertex, fan);
    }
    bool keeps_topology(const Fan &fan, uint32_t from, uint32_t to) const;
    bool keeps_shape(uint32_t triangle, uint32_t vertex, const Vec3d &place,
                     bool same_area) const;
    bool keeps_shapes(const Fan &fan, uint32_t from, uint32_t to) const;
    Choice cost_of(uint32_t vertex, uint32_t to, double most) const;
    Choice cheapest(uint32_t vertex, double most) const;
    Choice choose(uint32_t vertex, const Fan &fan, double most) const;
    void find_costs(double most);
    float find_limit(double free) const;
    Vector<Candidate> find_candidates(size_t block, double free, float limit) const;
    size_t collapse(const Fan &fan, uint32_t from, uint32_t to, double most);
    bool is_inside(uint32_t vertex, size_t block) const;
    size_t merge(uint32_t vertex, float limit, double most);
    void compact();
    double done() const { return 1 - 0.7 * double(triangles.size()) / double(first_count); }
    size_t round(size_t wanted, double free, double most);
    bool stays(uint32_t vertex) const
    {
        return !kept.empty() && kept[vertex] && !crossing;
    }
    bool move(uint32_t vertex, Vec3d way);
    void settle();
    void keep_points();
    void find_members(Vector<uint32_t> &first, Vector<Vec3d> &members);
};

} // namespace gtx::baking
