/* Gives each patch texels as its relief needs them.
 *
 * What cells leave of a surface grows with how much it bends within a texel, and with the size of
 * texels to some power. All patches together lose least, in the mean square, where each has its
 * share of texels by that: finer ones where the surface is rough, and along the axis in which it
 * bends more. */
#include "chart/cut_tree.hpp"

namespace gtx {

namespace {

/* Of the size of texels, in the error: 2 on a smooth surface, 1 at a crease. */
constexpr double POWER = 1.5;
/* Texels of a patch are as many times finer or coarser than the model's at most, and from that as
 * many times shorter along one axis and longer along the other. */
constexpr double RANGE = 1.5, STRETCH = 1.25;
/* Bends between neighbouring cells, in texels: of any surface, and what counts of one. */
constexpr double LEAST_BEND = 0.03, MOST_BEND = 0.5;

/* A leaf, and the mean square of how much its relief bends along each axis, seen along the
 * normal. */
struct Leaf {
    CutNode *node;
    double bend2[2];
};

Leaf measure_leaf(const Relief &relief, CutNode &node)
{
    constexpr double LEAST = LEAST_BEND * LEAST_BEND, MOST = MOST_BEND * MOST_BEND;
    double sum[2] = {0, 0};
    size_t count[2] = {0, 0};
    const int stride[2] = {1, relief.size[0]};
    for (int j = node.tight.low[1]; j < node.tight.high[1]; ++j)
        for (int i = node.tight.low[0]; i < node.tight.high[0]; ++i) {
            const float *at = &relief.height[relief.at(i, j)];
            double bend[2], slope2 = 0;
            for (int axis = 0; axis < 2; ++axis) {
                const int along = axis ? j : i;
                const bool inside = along > 0 && along + 1 < relief.size[axis];
                const double before = inside ? double(at[-stride[axis]]) : NAN;
                const double after = inside ? double(at[stride[axis]]) : NAN;
                bend[axis] = before + after - 2 * double(*at);
                if (!std::isnan(bend[axis]))
                    slope2 += (after - before) * (after - before) / 4;
            }
            for (int axis = 0; axis < 2; ++axis)
                if (!std::isnan(bend[axis])) {
                    sum[axis] += std::min(bend[axis] * bend[axis], MOST) / std::sqrt(1 + slope2);
                    ++count[axis];
                }
        }
    Leaf leaf = {&node, {LEAST, LEAST}};
    for (int axis = 0; axis < 2; ++axis)
        if (count[axis])
            leaf.bend2[axis] += sum[axis] / double(count[axis]);
    return leaf;
}

/* Texels of a leaf's rectangle, at most `longest` on a side, when the model's are `fine`; sets its
 * density. */
double set_density(const Leaf &leaf, double fine, double longest)
{
    const auto [x, y] = leaf.bend2;
    const double both = std::clamp(fine * std::pow(x * y, 0.25 / (POWER + 1)), 1 / RANGE, RANGE);
    const double stretch = std::clamp(std::pow(x / y, 0.25 / POWER), 1 / STRETCH, STRETCH);
    double texels = 1;
    for (int axis = 0; axis < 2; ++axis) {
        const double side = leaf.node->tight.side(axis);
        double &density = leaf.node->density[axis];
        density = std::min(axis ? both / stretch : both * stretch, longest / side);
        texels *= side * density;
    }
    return texels;
}

} // namespace

void spread_texels(std::vector<CutTree> &trees, const CutPlan &plan)
{
    constexpr double FINEST = 1e6;
    constexpr int STEPS = 60;
    const double longest = plan.side - 2 * plan.overlap[1];
    std::vector<Leaf> leaves;
    double texels = 0;
    for (CutTree &tree : trees) {
        std::vector<size_t> open(1, 0);
        for (size_t next = 0; next < open.size(); ++next) {
            CutNode &node = tree.nodes[open[next]];
            if (node.divided) {
                open.insert(open.end(), {size_t(node.child[0]), size_t(node.child[1])});
                continue;
            }
            leaves.push_back(measure_leaf(tree.relief, node));
            texels += double(node.tight.side(0)) * node.tight.side(1);
        }
    }
    double low = 1 / FINEST, high = FINEST;
    for (int step = 0; step < STEPS; ++step) {
        const double middle = std::sqrt(low * high);
        double sum = 0;
        for (const Leaf &leaf : leaves)
            sum += set_density(leaf, middle, longest);
        (sum > texels ? high : low) = middle;
    }
}

} // namespace gtx
