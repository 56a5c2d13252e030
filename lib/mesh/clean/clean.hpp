/* The steps of clean_mesh, in the order they run. */
#pragma once

#include "mesh/edges.hpp"

namespace gtx {

/* Triangles that name no vertex, lie nowhere or have no area: "index", "non-finite",
 * "degenerate". */
void drop_invalid(Mesh &mesh, Task &task, CleanReport &report);

/* Merges vertices at equal positions, numbers them in the order of first use and drops the
 * others; on the task's threads where it has one. */
void weld(Mesh &mesh, Task *task = nullptr);

/* Of triangles on the same three vertices one stays: "duplicate". It winds as most do. Returns for
 * each triangle kept whether as many of its copies wound one way as the other: they were the two
 * sides of a sheet without thickness. */
Vector<uint8_t> drop_duplicates(Mesh &mesh, Task &task, CleanReport &report);

/* Calls use(vector) for each attribute of corners; those that a mesh lacks are empty. */
template <class Use> void for_each_corner_attribute(Mesh &mesh, Use use)
{
    use(mesh.normals);
    use(mesh.colors);
    use(mesh.appearance.uv[0]);
    use(mesh.appearance.uv[1]);
    use(mesh.appearance.tangents);
}

/* A mesh being cleaned: what the later steps know of it. */
struct Draft {
    Mesh &mesh;
    Vector<uint8_t> thin;          /* per triangle, from drop_duplicates */
    Vector<uint32_t> twin;         /* per half-edge: the other side of the edge, or NO_EDGE */
    Vector<uint32_t> suspect;      /* half-edges whose two ends may be shared by another edge */
    Vector<uint8_t> turned;        /* per triangle: its winding differs from the source's */
    bool reversed = false;         /* some twins run the same way: wound against each other */
    uint64_t cut_edges = 0;        /* opened because the surface has one side only */
    uint64_t inside_out = 0;       /* closed components that were turned */
    uint64_t open_components = 0;
    uint64_t new_normals = 0;      /* source normals that were unusable */
};

/* Finds twins. Edges with more than two triangles are split. */
void pair_edges(Draft &surface, Task &task, CleanReport &report);

/* Gives all triangles of a component the winding that most of them have. */
void orient(Draft &surface);

/* Gives every fan of triangles a vertex of its own. */
void split_fans(Draft &surface, Task &task);

/* Turns closed components that are inside out, flags open ones as two-sided, counts both. One with
 * gaps of at most 1 % of its area counts as closed. Where all is `cut` out of a closed surface open
 * ones have no inside that shows: they are neither flagged nor counted. */
void choose_sides(Draft &surface, bool cut, Task &task, CleanReport &report);

/* Keeps the source's usable corner normals and derives the others. */
void make_normals(Draft &surface, Task &task);

/* Triangles grouped by component: those of component c are order[first[c]] to
 * order[first[c + 1] - 1], in breadth-first order from the lowest; its half-edges without a twin
 * likewise, in the order of their triangles. */
struct Components {
    Vector<uint32_t> order, first, borders, first_border;
    size_t count() const { return first.size() - 1; }
};

/* Floods over twins; meet(h, o, fresh) is called for each half-edge h of a reached triangle whose
 * twin is o, with whether o's triangle is reached by this. It may remove twins. */
template <class Meet> Components flood(const Vector<uint32_t> &twin, Meet meet)
{
    size_t triangles = twin.size() / 3;
    Components result;
    result.order.reserve(triangles);
    Vector<bool> reached(triangles, false);
    for (size_t seed = 0; seed < triangles; ++seed) {
        if (reached[seed])
            continue;
        size_t head = result.order.size();
        result.first.push_back(uint32_t(head));
        result.first_border.push_back(uint32_t(result.borders.size()));
        reached[seed] = true;
        result.order.push_back(uint32_t(seed));
        for (; head < result.order.size(); ++head)
            for (uint32_t h = 3 * result.order[head], end = h + 3; h < end; ++h) {
                uint32_t o = twin[h];
                if (o == NO_EDGE) {
                    result.borders.push_back(h);
                    continue;
                }
                bool fresh = !reached[o / 3];
                if (fresh) {
                    reached[o / 3] = true;
                    result.order.push_back(o / 3);
                }
                meet(h, o, fresh);
            }
    }
    result.first.push_back(uint32_t(result.order.size()));
    result.first_border.push_back(uint32_t(result.borders.size()));
    return result;
}

/* Turns the winding of the triangles with turn[t] != 0, their attributes and twins with them. */
void turn_triangles(Draft &surface, const Vector<uint8_t> &turn);

/* The corners around the vertex of corner c that are reached over twins, in winding order. */
void fan_of(const Vector<uint32_t> &twin, uint32_t c, Vector<uint32_t> &fan);

} // namespace gtx
