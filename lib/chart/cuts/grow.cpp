/* Grows k-d trees over charts, trading texels against relief.
 *
 * A node's cut is the one whose two sides would take the fewest texels, after the best next cut of
 * each: what counts is how the sides will fill their rectangles. */
#include "chart/cuts/slices.hpp"

namespace gtx {

namespace {

/* Least length of a side that was cut, of a square patch's side. Half: a few bytes; double: texels
 * -4 % (Spot), RMS -4 % (Duck). */
constexpr double MIN_SIDE = 0.1;
/* What height steps cost beside texels, both squared, and the standard deviations within which
 * heights lie. Half: RMS +6 %, +13 % (Duck); double: bytes +2 %, +4 % (bunny). */
constexpr double RELIEF_COST = 20, RANGE = 4;
/* Of the texels of a wanted patch: what is smaller is cut no further. A limit on time: half and
 * double move RMS by 1 % (Duck). */
constexpr double SMALLEST_SHARE = 1.0 / 4;
/* Likewise, what one more patch has to save. Half: texels +1 % (truck); double: RMS +4 % (Duck). */
constexpr double PATCH_PRICE = 0.1;
/* Likewise, nodes up to this look a cut ahead, at so many cuts: larger ones are far from their
 * leaves yet. Half: RMS +1, +3 % (Spot); double: RMS +1 %, bytes +1 % (truck). */
constexpr double AHEAD_SHARE = 16;
constexpr size_t CANDIDATES = 6;
/* Texels: a tie-break, of cuts that are worth the same the middle one. */
constexpr double BALANCE = 1e-6;

struct Cut {
    double value = INFINITY; /* texels, the price of patches included */
    int axis = -1, at = 0;

    bool operator<(const Cut &o) const
    {
        return value != o.value ? value < o.value : axis != o.axis ? axis < o.axis : at < o.at;
    }
};

struct Half {
    Rect region;
    Cuts cuts;
};

Half half_of(const Rect &region, const Cuts &cuts, int axis, int at, int side)
{
    Half half = {region, cuts};
    (side ? half.region.low : half.region.high)[axis] = at;
    half.cuts[size_t(2 * axis + !side)] = true;
    return half;
}

class Grower {
public:
    Grower(const Relief &relief, const CutPlan &plan, double share)
        : relief_(relief), plan_(plan),
          overlap_{int(plan.overlap[1]), int(plan.overlap[0])}, smallest_(SMALLEST_SHARE * share),
          price_(PATCH_PRICE * share), ahead_(relief.coarse > 1 ? 0 : AHEAD_SHARE * share),
          least_(std::max(MIN_CELLS, int(MIN_SIDE * std::sqrt(share))) / relief.coarse)
    {
        const double steps = RANGE / plan.steps * relief.coarse;
        relief_cost_ = RELIEF_COST * steps * steps;
    }

    Vector<CutNode> grow(Task &task);

private:
    /* The columns and the rows of a node where its parent has summed them up, or none. */
    using LinesOf = std::array<Lines, 2>;
    struct Grown {
        CutNode node, child[2];
        LinesOf lines[2];        /* of the children */
        bool has_children = false;
    };
    Grown grow_node(CutNode node, LinesOf lines);
    template <class Visit>
    void sweep(const Lines &lines, int axis, const Rect &region, const Cuts &cuts, Visit visit);
    double best_half(const Lines &along, const Lines &across, int axis, const Half &half);
    Cut look_ahead(const CutNode &node, const Rect &box, const LinesOf &lines,
                   Vector<Cut> cuts, LinesOf of_child[2]);
    double area(const Slice &s, const Rect &region, const Cuts &cuts, double &patches) const;
    double relief(const Slice &s) const;
    double value(const Slice &s, const Rect &region, const Cuts &cuts) const
    {
        double patches, texels = area(s, region, cuts, patches);
        return texels * relief(s) + patches * price_;
    }

    const Relief &relief_;
    const CutPlan &plan_;
    const int overlap_[2];     /* at a side that is no cut, and at one */
    double smallest_, price_, ahead_, relief_cost_;
    int least_;
    Vector<Slice> above_;      /* of the sweep at hand */
};

/* Texels of what lies in a region, in as many patches as the longest side allows. */
double Grower::area(const Slice &s, const Rect &region, const Cuts &cuts, double &patches) const
{
    patches = 0;
    if (s.box.empty())
        return 0;
    int sides[2];
    for (int axis = 0; axis < 2; ++axis) { /* where none is a cut the chart itself ends */
        const size_t low = size_t(2 * axis);
        sides[axis] = s.box.side(axis) * relief_.coarse +
                      overlap_[cuts[low] & (s.box.low[axis] == region.low[axis])] +
                      overlap_[cuts[low + 1] & (s.box.high[axis] == region.high[axis])];
    }
    patches = 1;
    for (int &side : sides)
        if (side > int(plan_.side)) {
            const int rest = int(2 * plan_.overlap[0]);
            const int parts = 1 + (side - 1) / (int(plan_.side) - rest);
            side += parts * rest;
            patches *= parts;
        }
    return double(sides[0]) * sides[1];
}

/* How much more a texel costs where heights resolve less than texels. */
double Grower::relief(const Slice &s) const
{
    return 1 + relief_cost_ * s.moments.residual();
}

/* Visits every cut between lines: where, and what lies below and above it. Nowhere else in the
 * region lies anything. */
template <class Visit>
void Grower::sweep(const Lines &lines, int axis, const Rect &region, const Cuts &cuts, Visit visit)
{
    const Vector<Slice> &slices = lines.slices;
    above_.resize(slices.size() + 1);
    above_.back() = {};
    for (size_t i = slices.size(); i-- > 0;)
        above_[i] = above_[i + 1].plus(slices[i]);
    const Rect &box = above_[0].box;
    Slice below;
    for (size_t i = 1; i < slices.size(); ++i) {
        below = below.plus(slices[i - 1]);
        const int at = lines.first + int(i);
        if (at < box.low[axis] + least_ || at > box.high[axis] - least_)
            continue;
        if (!(below.moments.n > 0 && above_[i].moments.n > 0))
            continue; /* what passes between all texel centres makes no patch of its own */
        visit(at, below, above_[i], half_of(region, cuts, axis, at, 0),
              half_of(region, cuts, axis, at, 1));
    }
}

/* What a half costs, whole or after its best cut: its lines along the axis of the cut that made it,
 * and across. */
double Grower::best_half(const Lines &along, const Lines &across, int axis, const Half &half)
{
    double least = INFINITY;
    for (int turn = 0; turn < 2; ++turn) {
        sweep(turn ? across : along, turn ? !axis : axis, half.region, half.cuts,
              [&](int, const Slice &below, const Slice &above, const Half &low, const Half &high) {
                  double patches[2];
                  double texels[2] = {area(below, low.region, low.cuts, patches[0]),
                                      area(above, high.region, high.cuts, patches[1])};
                  double price = (patches[0] + patches[1]) * price_;
                  if (texels[0] + texels[1] + price < least) /* before what relief adds */
                      least = std::min(least, texels[0] * relief(below) +
                                                  texels[1] * relief(above) + price);
              });
        if (!turn)
            least = std::min(least, value(above_[0], half.region, half.cuts));
    }
    return least;
}

/* The best of the first few cuts that are not beside each other, each with the best cut that may
 * follow on its two sides; and the lines of these across the cut. */
Cut Grower::look_ahead(const CutNode &node, const Rect &box, const LinesOf &lines,
                       Vector<Cut> cuts, LinesOf of_child[2])
{
    Vector<Cut> tried;
    while (tried.size() < CANDIDATES && !cuts.empty()) {
        const Cut next = *std::min_element(cuts.begin(), cuts.end());
        tried.push_back(next);
        cuts.erase(std::remove_if(cuts.begin(), cuts.end(), [&](const Cut &cut) {
            return cut.axis == next.axis && std::abs(cut.at - next.at) < std::max(1, least_ / 2);
        }), cuts.end());
    }
    Cut best;
    for (int axis = 0; axis < 2; ++axis) {
        Vector<int> across;
        for (const Cut &cut : tried)
            if (cut.axis == axis)
                across.push_back(cut.at);
        if (across.empty())
            continue;
        std::sort(across.begin(), across.end());
        across.push_back(box.high[axis]);
        Vector<Lines> low = line_parts(relief_, box, !axis, across), high = low;
        for (size_t part = 1; part < across.size(); ++part)
            for (size_t i = 0; i < low[part].slices.size(); ++i) {
                low[part].slices[i] = low[part].slices[i].plus(low[part - 1].slices[i]);
                size_t back = across.size() - 1 - part;
                high[back].slices[i] = high[back].slices[i].plus(high[back + 1].slices[i]);
            }
        const Lines &whole = lines[size_t(axis)];
        for (size_t part = 0; part + 1 < across.size(); ++part) {
            auto middle = whole.slices.begin() + (across[part] - whole.first);
            Lines along[2] = {{whole.first, {whole.slices.begin(), middle}},
                              {across[part], {middle, whole.slices.end()}}};
            double sum = 0;
            for (int side = 0; side < 2; ++side)
                sum += best_half(along[side], side ? high[part + 1] : low[part], axis,
                                 half_of(node.region, node.cuts, axis, across[part], side));
            Cut cut = {sum, axis, across[part]};
            if (cut < best) {
                best = cut;
                of_child[0] = of_child[1] = {};
                of_child[0][size_t(!axis)] = std::move(low[part]);
                of_child[1][size_t(!axis)] = std::move(high[part + 1]);
            }
        }
    }
    return best;
}

Grower::Grown Grower::grow_node(CutNode node, LinesOf lines)
{
    Grown out;
    Rect box;
    for (int k = 0; k < 2; ++k) {
        box.low[k] = std::max(node.region.low[k], node.tight.low[k]);
        box.high[k] = std::max(box.low[k], std::min(node.region.high[k], node.tight.high[k]));
    }
    add_lines(relief_, box, 1, lines[1]);
    Slice all;
    for (size_t i = lines[1].slices.size(); i-- > 0;)
        all = all.plus(lines[1].slices[i]);
    double count;
    node.tight = all.box;
    node.cost = area(all, node.region, node.cuts, count) * relief(all);
    out.node = node;
    const bool fits = count <= 1, looks = node.cost < ahead_;
    if (fits && node.cost < smallest_)
        return out;

    Vector<Cut> cuts;
    Cut best;
    add_lines(relief_, box, 0, lines[0]);
    for (int axis = 0; axis < 2; ++axis)
        sweep(lines[size_t(axis)], axis, node.region, node.cuts,
              [&](int at, const Slice &below, const Slice &above, const Half &low,
                  const Half &high) {
                  double patches[2];
                  const double texels[2] = {area(below, low.region, low.cuts, patches[0]),
                                            area(above, high.region, high.cuts, patches[1])};
                  const double price[2] = {patches[0] * price_, patches[1] * price_};
                  const double balance = BALANCE * std::fabs(all.box.low[axis] +
                                                             all.box.high[axis] - 2. * at);
                  if (!looks && texels[0] + price[0] + (texels[1] + price[1]) + balance >
                                    best.value) /* before what relief adds */
                      return;
                  const Cut cut = {texels[0] * relief(below) + price[0] +
                                       (texels[1] * relief(above) + price[1]) + balance,
                                   axis, at};
                  if (looks)
                      cuts.push_back(cut);
                  best = std::min(best, cut);
              });
    if (best.axis < 0)
        return out;
    if (looks)
        best = look_ahead(node, box, lines, std::move(cuts), out.lines);
    const Lines &along = lines[size_t(best.axis)];
    const auto middle = along.slices.begin() + (best.at - along.first);
    out.lines[0][size_t(best.axis)] = {along.first, {along.slices.begin(), middle}};
    out.lines[1][size_t(best.axis)] = {best.at, {middle, along.slices.end()}};
    for (int side = 0; side < 2; ++side) {
        Half half = half_of(node.region, node.cuts, best.axis, best.at, side);
        out.child[side].region = half.region;
        out.child[side].tight = node.tight;
        out.child[side].cuts = half.cuts;
    }
    out.has_children = true;
    if (!fits)
        out.node.cost = INFINITY;
    return out;
}

/* Level by level, the nodes of one at once where the relief is large. */
Vector<CutNode> Grower::grow(Task &task)
{
    const bool at_once = task.parts(relief_.height.size(), 1 << 14) > 1; /* changes no byte */
    CutNode root;
    root.region = root.tight = {{0, 0}, {relief_.size[0], relief_.size[1]}};
    Vector<CutNode> nodes = {root};
    Vector<LinesOf> lines(1), below; /* of the nodes of a level, and of their children */
    Vector<Grown> level;
    for (size_t first = 0; first < nodes.size(); first += level.size()) {
        level.resize(nodes.size() - first);
        if (at_once)
            task.parallel(level.size(), [&](size_t n) {
                level[n] = Grower(*this).grow_node(nodes[first + n], std::move(lines[n]));
            }, 0, 0);
        below.clear();
        for (size_t n = 0; n < level.size(); ++n) {
            if (!at_once)
                level[n] = grow_node(nodes[first + n], std::move(lines[n]));
            nodes[first + n] = level[n].node;
            for (int side = 0; side < 2 && level[n].has_children; ++side) {
                nodes[first + n].child[side] = int(nodes.size());
                nodes.push_back(level[n].child[side]);
                below.push_back(std::move(level[n].lines[side]));
            }
        }
        lines.swap(below);
    }
    return nodes;
}

} // namespace

CutTree grow_cut_tree(Relief relief, const CutPlan &plan, double share, Task &task)
{
    CutTree tree;
    tree.relief = std::move(relief);
    if (!tree.relief.touched.empty())
        tree.nodes = Grower(tree.relief, plan, share).grow(task);
    return tree;
}

} // namespace gtx
