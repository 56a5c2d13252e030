/* Where a chart is best cut: a k-d tree over its texels. */
#pragma once

#include "chart/cuts/cut.hpp"

namespace gtx {

/* Least texels along a side that is cut, or whose cells are counted here: slivers get theirs where
 * they are baked. Half: RMS +2 %; double: texels -3 %, patches +4 % (Spot). */
constexpr int MIN_CELLS = 4;

/* A chart on the grid of its frame, heights in texels. */
struct Relief {
    double corner[2];                 /* of texel (0, 0), in the frame's coordinates */
    int coarse = 1;                   /* its texels are as many of the model's on a side */
    int size[2];
    Vector<float> height;             /* at centres; NAN where none is */
    Vector<uint8_t> touched;          /* by any triangle */

    size_t at(int i, int j) const { return size_t(j) * size_t(size[0]) + size_t(i); }
};

Relief make_relief(const Surface &surface, const Region &region, const Frame &frame, double pitch,
                   Task &task);

/* The same turned about z by `turn` radians, `coarse` times as coarse: what a chart would look
 * like in a turned frame, roughly. Without texels where it would take far more of them: a sliver
 * chart. */
Relief turn_relief(const Relief &relief, double turn, int coarse);

/* Texels low to high - 1 along each axis. */
struct Rect {
    int low[2], high[2];

    int side(int axis) const { return high[axis] - low[axis]; }
    bool empty() const { return low[0] >= high[0]; }
};

/* The sides of a rectangle that are cuts: low, high of the first axis, then of the second. */
using Cuts = std::array<bool, 4>;

/* How much the relief of some texels bends between neighbours, seen along the normal. */
struct Bends {
    double square[2] = {0, 0};        /* sums of squares along each axis, texels */
    double count[2] = {0, 0};         /* texels with neighbours along it */
    double filled = 0;                /* texels with heights */

    void add(const Bends &other);
    double mean_square(int axis) const;
};

/* A rectangle of the grid and what of the chart lies there. */
struct CutNode {
    Rect region, tight;
    Cuts cuts = {};
    double cost = 0;                  /* texels as one patch; infinite where it is too long */
    Bends bends;
    int child[2] = {-1, -1};
    bool divided = false;             /* it is cut into its children */
    double density[2] = {1, 1};       /* texels of its patch, along each axis, for one here */
};

struct CutTree {
    Relief relief;
    Vector<CutNode> nodes;            /* the root first, children after their parents */
};

/* Grows the tree of a chart down to where its patches would be far smaller than wanted; `share` is
 * how many texels of surface a wanted patch has. */
CutTree grow_cut_tree(Relief relief, const CutPlan &plan, double share, Task &task);

/* Measures the bends of all nodes, and weighs their costs by them: as texels will be spread. */
void weigh_bends(CutTree &tree);

/* Divides nodes so that all trees together have at most `wanted` leaves, if they can, and the
 * least cost. */
void divide_trees(Vector<CutTree> &trees, size_t wanted);

/* Sets the density of each leaf so that, with as many texels in all, patches miss their relief by
 * the least mean square. */
void spread_texels(Vector<CutTree> &trees, const CutPlan &plan);

/* Of each run of `turns` trees, which are of one chart, the index of the one that takes the fewest
 * texels when all charts together have at most `wanted` leaves. Of a run all but the first may have
 * no nodes. */
Vector<size_t> choose_turns(Vector<CutTree> &trees, size_t turns, size_t wanted);

} // namespace gtx
