/* Charts on the grids of their frames, and pruning their trees of cuts to a number of leaves. */
#include "chart/cuts/tree.hpp"
#include "base/exact.h"

#include "chart/raster.hpp"

namespace gtx {

namespace {

/* Texels of a chart when it is turned, in those it has: a limit on memory, for slivers. Half: bytes
 * -1 % (truck); double: the same. */
constexpr double MAX_TURNED = 4;

/* The trees of some charts as they are pruned at one price after the other: little of each node. */
class Pruning {
public:
    explicit Pruning(const Vector<CutTree> &trees, size_t turns) : turns_(turns)
    {
        for (const CutTree &tree : trees) {
            first_.push_back(nodes_.size());
            for (const CutNode &node : tree.nodes)
                nodes_.push_back({node.cost, 0, {node.child[0], node.child[1]}, 1, false});
        }
        first_.push_back(nodes_.size());
    }
    /* Of each run of `turns` trees the one that costs least at a price; how many leaves they
     * have. */
    size_t prune_all(double price, Vector<size_t> &best)
    {
        constexpr size_t NODE_TURNS = 4; /* of a short loop, that take as long as a node */
        size_t leaves = 0;
        best.clear();
        for (size_t run = 0; run + 1 < first_.size(); run += turns_) {
            size_t least = run;
            for (size_t t = run; t < run + turns_; ++t) {
                cancel_point(NODE_TURNS * (first_[t + 1] - first_[t]));
                if (first_[t] == first_[t + 1])
                    continue;
                prune(t, price);
                if (nodes_[first_[t]].least < nodes_[first_[least]].least)
                    least = t;
            }
            leaves += nodes_[first_[least]].leaves;
            best.push_back(least - run);
        }
        return leaves;
    }
    /* Divides the trees as they were pruned last. */
    void divide(Vector<CutTree> &trees) const
    {
        const Node *from = nodes_.data();
        for (CutTree &tree : trees)
            for (CutNode &node : tree.nodes)
                node.divided = from++->divided;
    }

private:
    struct Node {
        double cost, least;      /* as one patch; with its descendants, at the price of patches */
        int child[2];
        uint32_t leaves;
        bool divided;
    };
    /* Divides the nodes for which that pays when each patch costs `price` texels on top. */
    void prune(size_t tree, double price)
    {
        Node *const nodes = &nodes_[first_[tree]];
        for (size_t n = first_[tree + 1] - first_[tree]; n-- > 0;) {
            Node &node = nodes[n];
            node.leaves = 1;
            node.least = node.cost + price;
            node.divided = false;
            if (node.child[0] < 0)
                continue;
            const Node &a = nodes[node.child[0]], &b = nodes[node.child[1]];
            if (a.least + b.least < node.least) {
                node.least = a.least + b.least;
                node.leaves = a.leaves + b.leaves;
                node.divided = true;
            }
        }
    }

    const size_t turns_;
    Vector<size_t> first_;       /* of each tree, and the end */
    Vector<Node> nodes_;
};

} // namespace

/* Adds a triangle with corners in texels. */
static void add_triangle(const Vec3d corner[3], Relief &out)
{
    raster_centres(corner, out.size[0], out.size[1], [&](int i, int j, double depth) {
        float &height = out.height[out.at(i, j)];
        if (!(depth <= double(height)))
            height = float(depth);
        out.touched[out.at(i, j)] = 1;
    });
    auto touch = [&out](const Vec3d &p) {
        int i = std::clamp(int(p.x), 0, out.size[0] - 1);
        int j = std::clamp(int(p.y), 0, out.size[1] - 1);
        out.touched[out.at(i, j)] = 1;
    };
    for (int k = 0; k < 3; ++k) { /* a sliver passes between centres */
        Vec3d from = corner[k], along = corner[(k + 1) % 3] - from;
        int steps = 1 + whole_length(2, along.x, along.y);
        touch(from);
        for (int s = 1; s < steps; ++s)
            touch(from + along * (double(s) / steps));
    }
}

static Relief blank_relief(const Frame &frame, double pitch)
{
    Relief out;
    for (int k = 0; k < 2; ++k) {
        out.size[k] = std::max(1, int(std::ceil(frame.extent[k] / pitch)));
        out.corner[k] = (frame.extent[k] - out.size[k] * pitch) / 2;
    }
    out.height.assign(size_t(out.size[0]) * size_t(out.size[1]), NAN);
    out.touched.assign(out.height.size(), 0);
    return out;
}

Relief make_relief(const Surface &surface, const Region &region, const Frame &frame, double pitch,
                   Task &task)
{
    constexpr size_t TURNS = 64; /* of a short loop, that take as long as a triangle */
    constexpr size_t LARGE = 1 << 14; /* changes no byte */
    Vector<Relief> parts(task.parts(region.size(), LARGE));
    const FrameInverse inverse(frame);
    task.in_parts(region.size(), parts.size(), [&](size_t part, size_t from, size_t to) {
        Relief out = blank_relief(frame, pitch);
        for (size_t n = from; n < to; ++n) {
            cancel_point(TURNS);
            Vec3d corner[3];
            for (int k = 0; k < 3; ++k) {
                Vec3d p = inverse(surface.mesh.position(region.triangles[n], k));
                corner[k] = {(p.x - out.corner[0]) / pitch, (p.y - out.corner[1]) / pitch,
                             p.z / pitch};
            }
            add_triangle(corner, out);
        }
        parts[part] = std::move(out);
    });
    Relief out = std::move(parts[0]);
    for (size_t part = 1; part < parts.size(); ++part)
        for (size_t i = 0; i < out.height.size(); ++i) {
            const float height = parts[part].height[i];
            if (!(height <= out.height[i]) && !std::isnan(height))
                out.height[i] = height;
            out.touched[i] |= parts[part].touched[i];
        }
    return out;
}

Relief turn_relief(const Relief &relief, double turn, int coarse)
{
    const double c = gtx_cos(turn) / coarse, s = gtx_sin(turn) / coarse;
    const double w = relief.size[0], h = relief.size[1];
    Relief out;
    out.coarse = coarse;
    out.size[0] = 1 + int(std::fabs(c) * w + std::fabs(s) * h);
    out.size[1] = 1 + int(std::fabs(s) * w + std::fabs(c) * h);
    out.corner[0] = out.corner[1] = 0;
    const double texels = double(out.size[0]) * out.size[1];
    if (turn != 0 && texels > MAX_TURNED * (1 + w / coarse) * (1 + h / coarse)) {
        out.size[0] = out.size[1] = 0;
        return out;
    }
    out.height.assign(size_t(out.size[0]) * size_t(out.size[1]), NAN);
    out.touched.assign(out.height.size(), 0);
    struct Turned {
        double c, s;
    };
    Vector<Turned> columns(size_t(relief.size[0]));
    for (size_t i = 0; i < columns.size(); ++i) {
        const double x = double(i) + 0.5 - w / 2;
        columns[i] = {c * x, s * x};
    }
    const double middle[2] = {out.size[0] / 2., out.size[1] / 2.};
    const int last[2] = {out.size[0] - 1, out.size[1] - 1};
    for (int j = 0; j < relief.size[1]; ++j) {
        cancel_point();
        const double y = j + 0.5 - h / 2, cy = c * y, sy = s * y;
        const uint8_t *touched = &relief.touched[relief.at(0, j)];
        const float *heights = &relief.height[relief.at(0, j)];
        for (size_t i = 0; i < columns.size(); ++i) {
            if (!touched[i])
                continue;
            const int column = int(columns[i].c + sy + middle[0]);
            const int row = int(cy - columns[i].s + middle[1]);
            const size_t to = out.at(std::clamp(column, 0, last[0]), std::clamp(row, 0, last[1]));
            out.touched[to] = 1;
            if (!std::isnan(heights[i]))
                out.height[to] = heights[i] / float(coarse);
        }
    }
    return out;
}

void divide_trees(Vector<CutTree> &trees, size_t wanted)
{
    choose_turns(trees, 1, wanted);
}

Vector<size_t> choose_turns(Vector<CutTree> &trees, size_t turns, size_t wanted)
{
    constexpr double HIGHEST = 1e12; /* texels: with more charts than wanted no price is enough */
    constexpr int STEPS = 40;        /* of a bisection that ends early where it can */
    Vector<size_t> best;
    Pruning pruning(trees, turns);
    double low = 0, high = 1;
    size_t leaves = pruning.prune_all(low, best);
    if (leaves > wanted) {
        while (high < HIGHEST && pruning.prune_all(high, best) > wanted)
            high *= 2;
        for (int step = 0; step < STEPS && leaves != wanted; ++step) {
            const double middle = (low + high) / 2;
            leaves = pruning.prune_all(middle, best);
            (leaves > wanted ? low : high) = middle;
        }
        if (leaves != wanted)
            pruning.prune_all(high, best);
    }
    pruning.divide(trees);
    return best;
}

} // namespace gtx
