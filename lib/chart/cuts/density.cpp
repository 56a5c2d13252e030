/* Gives each patch texels as its relief needs them, and weighs by that where cuts pay.
 *
 * What cells leave of a surface grows with how much it bends within a texel, and with the size of
 * texels to some power. All patches together lose least, in the mean square, where each has its
 * share of texels by that: finer ones where the surface is rough and fills the rectangle, and along
 * the axis in which it bends more. */
#include "chart/cuts/tree.hpp"
#include "base/exact.h"

namespace gtx {

namespace {

/* Of the size of texels, in the error: 2 on a smooth surface, 1 at a crease. Half: texels +5 %
 * (Spot); double: RMS +7 % (Duck). */
constexpr double POWER = 1.5;
/* Of the mean square of bends, then, in a density. */
constexpr double SHARE = 0.5 / (POWER + 1);
/* Of the filled share of a rectangle, beside bends: 1 were best for the error, but height fields
 * meet better where the texels of neighbours are more alike. Half: RMS +3 % (Duck); double: bytes
 * +2 % (truck). */
constexpr double FILLED = 0.7;
/* Texels of a patch are as many times finer or coarser than the model's at most, and from that as
 * many times shorter along one axis and longer along the other. Neither can be less than 1;
 * double: nothing, texels +3 % (Spot). */
constexpr double RANGE = 1.5, STRETCH = 1.25;
/* Bends between neighbouring cells, in texels: of any surface, and what counts of one. Half: texels
 * +2 %, RMS -5 % (Spot); double: RMS -6 % (truck), texels +3 % (Spot). */
constexpr double MIN_BEND = 0.03, MAX_BEND = 0.5;

Bends measure_bends(const Relief &relief, const Rect &box)
{
    constexpr double MAX_BEND2 = MAX_BEND * MAX_BEND;
    const int stride[2] = {1, relief.size[0]};
    Bends out;
    for (int j = box.low[1]; j < box.high[1]; ++j)
        for (int i = box.low[0]; i < box.high[0]; ++i) {
            const float *at = &relief.height[relief.at(i, j)];
            if (std::isnan(*at))
                continue;
            out.filled += 1;
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
                    out.square[axis] +=
                        std::min(bend[axis] * bend[axis], MAX_BEND2) / std::sqrt(1 + slope2);
                    out.count[axis] += 1;
                }
        }
    return out;
}

/* Mean square of bends, of both axes. */
double roughness(const Bends &bends)
{
    return std::sqrt(bends.mean_square(0) * bends.mean_square(1));
}

/* A leaf, and what its density goes by. */
struct Leaf {
    CutNode *node;
    double sides[2], share, stretch;

    explicit Leaf(CutNode &leaf)
        : node(&leaf), sides{double(leaf.tight.side(0)), double(leaf.tight.side(1))}
    {
        const double filled = std::max(1., leaf.bends.filled) / (sides[0] * sides[1]);
        const double ratio = leaf.bends.mean_square(0) / leaf.bends.mean_square(1);
        share = gtx_pow(roughness(leaf.bends) * gtx_pow(filled, FILLED), SHARE);
        stretch = std::clamp(gtx_pow(ratio, 0.25 / POWER), 1 / STRETCH, STRETCH);
    }
    /* Texels of its rectangle, at most `longest` on a side, when the model's are `fine`; sets its
     * density. */
    double set_density(double fine, double longest) const
    {
        const double both = std::clamp(fine * share, 1 / RANGE, RANGE);
        double texels = 1;
        for (int axis = 0; axis < 2; ++axis) {
            node->density[axis] =
                std::min(axis ? both / stretch : both * stretch, longest / sides[axis]);
            texels *= sides[axis] * node->density[axis];
        }
        return texels;
    }
};

} // namespace

void Bends::add(const Bends &other)
{
    for (int axis = 0; axis < 2; ++axis) {
        square[axis] += other.square[axis];
        count[axis] += other.count[axis];
    }
    filled += other.filled;
}

double Bends::mean_square(int axis) const
{
    return MIN_BEND * MIN_BEND + (count[axis] > 0 ? square[axis] / count[axis] : 0);
}

void weigh_bends(CutTree &tree)
{
    for (size_t n = tree.nodes.size(); n-- > 0;) {
        CutNode &node = tree.nodes[n];
        if (node.child[0] < 0)
            node.bends = measure_bends(tree.relief, node.tight);
        else
            for (int child : node.child)
                node.bends.add(tree.nodes[size_t(child)].bends);
        node.cost *= gtx_pow(roughness(node.bends), 2 * SHARE);
    }
}

void spread_texels(Vector<CutTree> &trees, const CutPlan &plan)
{
    constexpr double FINEST = 1e6; /* of a bisection that ends at a double's digits */
    constexpr int STEPS = 60;
    const double longest = plan.side - 2 * plan.overlap[1];
    Vector<Leaf> leaves;
    double texels = 0;
    for (CutTree &tree : trees) {
        Vector<size_t> open(1, 0);
        for (size_t next = 0; next < open.size(); ++next) {
            CutNode &node = tree.nodes[open[next]];
            if (node.divided) {
                open.insert(open.end(), {size_t(node.child[0]), size_t(node.child[1])});
                continue;
            }
            leaves.emplace_back(node);
            texels += leaves.back().sides[0] * leaves.back().sides[1];
        }
    }
    double low = 1 / FINEST, high = FINEST;
    for (int step = 0; step < STEPS; ++step) {
        const double middle = std::sqrt(low * high);
        double sum = 0;
        for (const Leaf &leaf : leaves) {
            cancel_point();
            sum += leaf.set_density(middle, longest);
        }
        (sum > texels ? high : low) = middle;
    }
}

} // namespace gtx
