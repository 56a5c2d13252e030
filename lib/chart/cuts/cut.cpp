/* Cuts charts straight, along the lines of their own grids of texels.
 *
 * A chart that folds nowhere is one height map already, however large. Parts of it fill their tight
 * rectangles the better the smaller they are, and neighbours across a cut share the axis of
 * projection, along which their height fields are made to cross (bake/seam/close_cuts.cpp). */
#include "chart/cuts/tree.hpp"
#include "chart/frame.hpp"

namespace gtx {

namespace {

/* Texels beyond a patch from which its overlap may take. Half and double: a few bytes. */
constexpr float MARGIN = 4;
/* Texels from where the chart ends to a cut behind it, at least: room for the overlap there. Half
 * and double change nothing, none changes the dragon. */
constexpr double ROOM = 2;
/* Turns of a frame that are tried, and how many times as coarse the grid is for that: time against
 * empty texels. Half: patches +3 % (truck), bytes +1 % (Spot); double: RMS +1 % (Spot). */
constexpr size_t TURNS = 8;
constexpr int COARSE = 6;
/* Of a grain, what a side may lose to come to a multiple: its core's texels get longer. The bake
 * decides again from what it rendered, and gives up one texel more (bake/field/patch.cpp). */
constexpr double SHRINKABLE = 3. / 8;

/* Texels of a patch's core along an axis. */
unsigned cells_of(const CutNode &node, int axis)
{
    return unsigned(std::max(1., std::floor(node.tight.side(axis) * node.density[axis] + 0.5)));
}

/* A triangle of a chart as its patches see it, in texels. */
struct Piece {
    uint32_t triangle;
    float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, middle[2] = {0, 0};

    bool meets(const Rect &region) const
    {
        bool meets = true;
        for (int a = 0; a < 2; ++a)
            meets = meets && high[a] >= float(region.low[a]) - MARGIN &&
                    low[a] <= float(region.high[a]) + MARGIN;
        return meets;
    }
};

/* What of a chart meets one of its patches; some that does is another's own. */
struct Members {
    Vector<uint32_t> triangles;
    uint64_t own = 0;
};

class PatchBuilder {
public:
    PatchBuilder(const Surface &surface, const Frame &frame, const CutPlan &plan,
                 const CutTree &tree)
        : surface_(surface), frame_(frame), plan_(plan), pitch_(plan.pitch), tree_(tree),
          inverse_(frame), patch_of_(tree.nodes.size())
    {
        list_leaves(0);
    }

    Vector<Chart> build(const Region &region, Task &task);

private:
    void list_leaves(size_t node);
    Piece piece_of(uint32_t triangle) const;
    void descend(size_t node, const Piece &piece, Vector<Members> &patches) const;
    bool is_own(const CutNode &node, const Piece &piece) const;
    void lay_frame(const CutNode &node, Chart &chart) const;
    unsigned fitted_cells(const CutNode &node, int axis) const;
    void clip(const CutNode &node, Chart &chart) const;

    const Surface &surface_;
    const Frame &frame_;
    const CutPlan &plan_;
    const double pitch_;
    const CutTree &tree_;
    const FrameInverse inverse_;
    Vector<uint32_t> patch_of_; /* of a node that is a leaf */
    Vector<size_t> leaves_;
};

void PatchBuilder::list_leaves(size_t node)
{
    if (!tree_.nodes[node].divided) {
        patch_of_[node] = uint32_t(leaves_.size());
        leaves_.push_back(node);
        return;
    }
    for (int child : tree_.nodes[node].child)
        list_leaves(size_t(child));
}

Piece PatchBuilder::piece_of(uint32_t triangle) const
{
    Piece piece = {triangle};
    for (int k = 0; k < 3; ++k) {
        Vec3d p = inverse_(surface_.mesh.position(triangle, k));
        for (int a = 0; a < 2; ++a) {
            float x = float((p[a] - tree_.relief.corner[a]) / pitch_);
            piece.low[a] = std::min(piece.low[a], x);
            piece.high[a] = std::max(piece.high[a], x);
            piece.middle[a] += x / 3;
        }
    }
    return piece;
}

void PatchBuilder::descend(size_t node, const Piece &piece, Vector<Members> &patches) const
{
    if (!tree_.nodes[node].divided) {
        Members &patch = patches[patch_of_[node]];
        patch.triangles.push_back(piece.triangle);
        patch.own += is_own(tree_.nodes[node], piece);
        return;
    }
    for (int child : tree_.nodes[node].child)
        if (piece.meets(tree_.nodes[size_t(child)].region))
            descend(size_t(child), piece, patches);
}

Vector<Chart> PatchBuilder::build(const Region &region, Task &task)
{
    constexpr size_t LARGE = 1 << 16; /* changes no byte */
    Vector<Vector<Members>> parts(task.parts(region.size(), LARGE));
    task.in_parts(region.size(), parts.size(), [&](size_t part, size_t from, size_t to) {
        Vector<Members> patches(leaves_.size());
        for (size_t i = from; i < to; ++i) {
            cancel_point();
            descend(0, piece_of(region.triangles[i]), patches);
        }
        parts[part] = std::move(patches);
    });
    Vector<Chart> charts(leaves_.size());
    auto make_patch = [&](size_t patch) {
        Chart &chart = charts[patch];
        for (Vector<Members> &part : parts) {
            const Members from = std::move(part[patch]);
            chart.triangles.insert(chart.triangles.end(), from.triangles.begin(),
                                   from.triangles.end());
            chart.source_triangles += from.own;
        }
        lay_frame(tree_.nodes[leaves_[patch]], chart);
        clip(tree_.nodes[leaves_[patch]], chart);
    };
    if (parts.size() > 1)
        task.parallel(charts.size(), make_patch);
    else
        for (size_t patch = 0; patch < charts.size(); ++patch)
            make_patch(patch);
    return charts;
}

/* Whether its centre lies in the node's region, clamped to the grid against rounding. */
bool PatchBuilder::is_own(const CutNode &node, const Piece &piece) const
{
    bool own = true;
    for (int a = 0; a < 2; ++a)
        own = own && (piece.middle[a] >= float(node.region.low[a]) || !node.region.low[a]) &&
              (piece.middle[a] < float(node.region.high[a]) ||
               node.region.high[a] == tree_.relief.size[a]);
    return own;
}

/* Cells of the core such that the patch's side is a multiple of the grain: a few less, or more,
 * which its texels stretch to fill. */
unsigned PatchBuilder::fitted_cells(const CutNode &node, int axis) const
{
    const size_t low = size_t(2 * axis);
    const bool ends[2] = {!node.cuts[low] || node.tight.low[axis] > node.region.low[axis],
                          !node.cuts[low + 1] || node.tight.high[axis] < node.region.high[axis]};
    const unsigned core = cells_of(node, axis);
    const unsigned side = core + plan_.overlap[ends[0]] + plan_.overlap[ends[1]];
    const unsigned over = side % plan_.grain;
    if (over < SHRINKABLE * plan_.grain && core > plan_.grain)
        return core - over;
    return core + std::min(core, (plan_.grain - over) % plan_.grain);
}

void PatchBuilder::lay_frame(const CutNode &node, Chart &chart) const
{
    const Relief &relief = tree_.relief;
    Vector<Vec3d> points;
    for (int j = node.tight.low[1]; j < node.tight.high[1]; ++j)
        for (int i = node.tight.low[0]; i < node.tight.high[0]; ++i) {
            double height = double(relief.height[relief.at(i, j)]);
            if (!std::isnan(height))
                points.push_back({relief.corner[0] + (i + 0.5) * pitch_,
                                  relief.corner[1] + (j + 0.5) * pitch_, height * pitch_});
        }
    double low[2], high[2];
    for (int a = 0; a < 2; ++a) {
        low[a] = relief.corner[a] + node.tight.low[a] * pitch_;
        high[a] = relief.corner[a] + node.tight.high[a] * pitch_;
        chart.cells[a] = fitted_cells(node, a);
    }
    chart.frame = part_of_frame(frame_, low, high, points);
}

void PatchBuilder::clip(const CutNode &node, Chart &chart) const
{
    for (int a = 0; a < 2; ++a) {
        const double cell = chart.frame.extent[a] / chart.cells[a];
        const double texel = chart.frame.extent[a] / node.tight.side(a); /* of the tree's grid */
        const int low = node.tight.low[a] - node.region.low[a];
        const int high = node.region.high[a] - node.tight.high[a];
        if (node.cuts[size_t(2 * a)])
            chart.clip_low[a] = low ? -std::max(low * texel, ROOM * cell) : 0;
        if (node.cuts[size_t(2 * a + 1)])
            chart.clip_high[a] =
                chart.frame.extent[a] + (high ? std::max(high * texel, ROOM * cell) : 0);
    }
}

/* Of a chart that stays whole. */
void set_cells(const CutNode &node, Chart &chart)
{
    if (std::min(node.tight.side(0), node.tight.side(1)) < MIN_CELLS)
        return;
    for (int axis = 0; axis < 2; ++axis)
        chart.cells[axis] = cells_of(node, axis);
}

/* Turns the frames of charts that will be cut so that their patches fill their rectangles best:
 * the least rectangle around a large chart says little about its parts. Coarse trees suffice to
 * tell. Returns the reliefs of all. */
Vector<Relief> turn_frames(const Surface &surface, const Vector<Region> &regions,
                           const CutPlan &plan, double share, Vector<Frame> &frames, Task &task)
{
    auto radians = [](size_t turn) { return M_PI / 2 * double(turn) / TURNS; };
    Vector<CutTree> trees(regions.size() * TURNS);
    Vector<Relief> reliefs(regions.size());
    for_each_region(regions, task, [&](size_t i) {
        reliefs[i] = make_relief(surface, regions[i], frames[i], plan.pitch, task);
    }, 0.2, 0.3);
    for_each_region(regions, task, [&](size_t n) {
        trees[n] = grow_cut_tree(turn_relief(reliefs[n / TURNS], radians(n % TURNS), COARSE),
                                 plan, share, task);
    }, 0.3, 0.4, TURNS);
    Vector<size_t> best = choose_turns(trees, TURNS, plan.patches);
    for_each_region(regions, task, [&](size_t i) {
        if (!trees[i * TURNS + best[i]].nodes[0].divided)
            return;
        frames[i] = turned_frame(surface.mesh, regions[i].triangles, frames[i], radians(best[i]));
        reliefs[i] = make_relief(surface, regions[i], frames[i], plan.pitch, task);
    });
    return reliefs;
}

} // namespace

Vector<Chart> cut_charts(const Surface &surface, Vector<Region> regions,
                         Vector<Frame> frames, const CutPlan &plan, Task &task)
{
    double share = surface.area / (plan.pitch * plan.pitch) / double(plan.patches);
    Vector<Relief> reliefs = turn_frames(surface, regions, plan, share, frames, task);
    Vector<CutTree> trees(regions.size());
    for_each_region(regions, task, [&](size_t i) {
        trees[i] = grow_cut_tree(std::move(reliefs[i]), plan, share, task);
        if (!plan.one_density)
            weigh_bends(trees[i]);
    }, 0.4, 0.8);
    divide_trees(trees, plan.patches);
    if (!plan.one_density)
        spread_texels(trees, plan);

    Vector<Vector<Chart>> cut(regions.size());
    for_each_region(regions, task, [&](size_t i) {
        if (trees[i].nodes[0].divided) {
            cut[i] = PatchBuilder(surface, frames[i], plan, trees[i]).build(regions[i], task);
        } else {
            cut[i].resize(1);
            cut[i][0].source_triangles = regions[i].size();
            cut[i][0].triangles = std::move(regions[i].triangles);
            cut[i][0].frame = frames[i];
            set_cells(trees[i].nodes[0], cut[i][0]);
        }
        trees[i] = {};
    }, 0.8, 1);
    Vector<Chart> out;
    for (Vector<Chart> &charts : cut)
        std::move(charts.begin(), charts.end(), std::back_inserter(out));
    task.parallel(out.size(), [&](size_t i) {
        std::sort(out[i].triangles.begin(), out[i].triangles.end());
    }, 1, 1);
    return out;
}

} // namespace gtx
