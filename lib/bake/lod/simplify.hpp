/* The inside of simplifying: a surface while its vertices are merged. */
#pragma once

#include "bake/lod/fan.hpp"
#include "bake/lod/parts.hpp"
#include "bake/lod/quadric.hpp"

namespace gtx::baking {

/* Share of the vertices that a round looks at, the cheapest: more once few of them may go.
 * Spot's control mesh: error +13 % at half, +2 % at double. */
constexpr double ROUND_SHARE = 0.4;

/* Of a triangle. */
using Corners = std::array<Vec3d, 3>;

struct Candidate {
    float cost;                  /* of the cheapest neighbour, whether it may be or not, at first */
    uint32_t from, to;
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
    const Vector<Vec3d> points;      /* vertices at the start */
    Vector<uint32_t> point;          /* of each vertex, the one that it was */
    Vector<uint32_t> merged;         /* of each point, what it went into; itself: it is left */
    Vector<uint32_t> start, around;      /* triangles of each vertex */
    Vector<uint8_t> touched;
    /* What each vertex costs at least, as far as is known: NAN where it has to be found out,
     * infinite where it must stay unless something changes around it. */
    Vector<float> costs;
    Vector<Candidate> candidates;
    size_t first_count;          /* triangles at the start */
    double share = ROUND_SHARE;  /* of the candidates that a round takes */
    bool crossing = false;       /* triangles may leave their patches */
    double error = 0;            /* squared */

    State(const LodSource &source, const Vector<PatchRegion> &regions, Task &task);
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
    void find_members(Vector<uint32_t> &first, Vector<Vec3d> &members);
};

} // namespace gtx::baking
