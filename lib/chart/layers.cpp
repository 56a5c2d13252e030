/* Rasterises a chart along its axis and looks for texel centres with two layers. */
#include "chart/layers.hpp"

#include "chart/raster.hpp"

namespace gtx {

namespace {

using Sample = LayerGrid::Sample;

/* Groups of doubled samples so small and so shallow are a scan's noise. Half: RMS +6 % (Duck),
 * texels +1 % (truck); double: texels +10 and +3 % (truck). */
constexpr size_t JUNK_SAMPLES = 2;
constexpr double JUNK_PITCHES = 1.5;
/* Layers closer than this share of the diagonal are one. Half: the same but for a few bytes;
 * double: RMS +6 % (Duck). */
constexpr double LAYER_DISTANCE = 1e-4;
/* A step between neighbouring texels this large is a depth discontinuity, unless surface within the
 * reach leads from one to the other. Half: RMS +8 %, double: +1 % (truck); the reach changes
 * nothing at half or double. The bake is stricter, 4 texels within 1.5 (bake/field/
 * chart_field.hpp): it cuts away the one cell that bridges the step, where splitting a chart costs
 * another patch. */
constexpr double DISCONTINUITY_PITCHES = 6, DISCONTINUITY_REACH = 2.5;

/* Triangles that lead from one sample to another: a limit on time. An engine of 82
 * nodes takes up to 168, others 100. */
constexpr size_t MAX_SEARCHED = 512;

/* Triangles whose corners are computed once: memory against time. */
constexpr size_t MAX_KEPT = 1 << 16;

void join(Sample &s, const Sample &other)
{
    if (other.low < s.low) {
        s.low = other.low;
        s.back = other.back;
    }
    if (other.high > s.high) {
        s.high = other.high;
        s.front = other.front;
    }
}

/* A grid without samples around texels low to high - 1. */
LayerGrid blank_grid(const int low[2], const int high[2])
{
    LayerGrid grid;
    for (int k = 0; k < 2; ++k) {
        grid.first[k] = low[k];
        grid.size[k] = std::max(0, high[k] - low[k]);
    }
    grid.samples.resize(size_t(grid.size[0]) * size_t(grid.size[1]));
    return grid;
}

/* Empties `samples` of the 8-connected group that holds the one at `start`; returns the group. */
Vector<DoubleSample> take_group(LayerGrid &grid, size_t start, float apart)
{
    Vector<DoubleSample> group;
    Vector<size_t> stack;
    const int width = grid.size[0], height = grid.size[1];
    auto take = [&](size_t at) {
        Sample &s = grid.samples[at];
        if (!(s.high - s.low > apart))
            return;
        group.push_back({s.front, s.back, s.high - s.low});
        s = {};
        stack.push_back(at);
    };
    take(start);
    while (!stack.empty()) {
        int i = int(stack.back() % size_t(width)), j = int(stack.back() / size_t(width));
        stack.pop_back();
        for (int y = std::max(0, j - 1); y <= std::min(height - 1, j + 1); ++y)
            for (int x = std::max(0, i - 1); x <= std::min(width - 1, i + 1); ++x)
                take(size_t(y) * size_t(width) + size_t(x));
    }
    return group;
}

bool is_fold(const Vector<DoubleSample> &group, const LayerRule &rule)
{
    return group.size() > JUNK_SAMPLES ||
           std::any_of(group.begin(), group.end(),
                       [&](const DoubleSample &d) { return d.depth > rule.shallow; });
}

/* Corners of a region's triangles: x and y in texels from a fixed point, depth in object units. */
class FlatRegion {
public:
    FlatRegion(const Surface &surface, const Region &region, const Frame &frame, double pitch)
        : surface_(surface), region_(region), inverse_(frame),
          fixed_(inverse_(surface.mesh.positions[0])), pitch_(pitch)
    {
    }
    Vec3d in_frame(uint32_t local, int k) const
    {
        return inverse_(surface_.mesh.position(region_.triangles[local], k));
    }
    /* Of a point in the frame's coordinates, one of them: never falls where that rises. */
    double in_texels(const Vec3d &p, int axis) const { return (p[axis] - fixed_[axis]) / pitch_; }
    Vec3d in_texels(const Vec3d &p) const { return {in_texels(p, 0), in_texels(p, 1), p.z}; }
    Vec3d corner(uint32_t local, int k) const { return in_texels(in_frame(local, k)); }
    /* Whether surface within `reach` texels of (u, v) leads from one triangle to another. */
    bool joined(uint32_t from, uint32_t to, double u, double v, double reach) const
    {
        Vector<uint32_t> queue(1, from);
        for (size_t next = 0; next < queue.size() && queue.size() < MAX_SEARCHED; ++next) {
            if (queue[next] == to)
                return true;
            for (uint32_t n : region_.neighbours[queue[next]])
                if (n != NO_TRIANGLE && std::find(queue.begin(), queue.end(), n) == queue.end() &&
                    near(n, u, v, reach))
                    queue.push_back(n);
        }
        return false;
    }

private:
    bool near(uint32_t local, double u, double v, double reach) const
    {
        Vec3d a = corner(local, 0), b = corner(local, 1), c = corner(local, 2);
        return std::min({a.x, b.x, c.x}) <= u + reach && std::max({a.x, b.x, c.x}) >= u - reach &&
               std::min({a.y, b.y, c.y}) <= v + reach && std::max({a.y, b.y, c.y}) >= v - reach;
    }
    const Surface &surface_;
    const Region &region_;
    FrameInverse inverse_;
    Vec3d fixed_;
    double pitch_;
};

/* Neighbouring samples with no surface between them: the cell that bridges them shows neither
 * side. */
void find_discontinuities(const FlatRegion &flat, const LayerGrid &grid, float max_step,
                          Vector<DoubleSample> &out)
{
    const int width = grid.size[0], height = grid.size[1];
    const Sample *here = grid.samples.data();
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i, ++here) {
            if (!(here->high >= here->low))
                continue;
            for (int axis = 0; axis < 2; ++axis) {
                int x = i + 1 - axis, y = j + axis;
                if (x >= width || y >= height)
                    continue;
                const Sample &a = *here, &b = here[axis ? width : 1];
                float step = std::fabs(a.high - b.high);
                if (!(step > max_step) || !(b.high >= b.low) ||
                    flat.joined(a.front, b.front, grid.first[0] + (i + x) / 2. + 0.5,
                                grid.first[1] + (j + y) / 2. + 0.5, DISCONTINUITY_REACH))
                    continue;
                out.push_back(a.high > b.high ? DoubleSample{a.front, b.front, step}
                                              : DoubleSample{b.front, a.front, step});
            }
        }
}

} // namespace

LayerRule layer_rule(const Surface &surface, double pitch)
{
    return {float(LAYER_DISTANCE * surface.diagonal), float(JUNK_PITCHES * pitch),
            float(DISCONTINUITY_PITCHES * pitch)};
}

const Sample *LayerGrid::at(int i, int j) const
{
    int x = i - first[0], y = j - first[1];
    bool inside = x >= 0 && y >= 0 && x < size[0] && y < size[1];
    return inside ? &samples[size_t(y) * size_t(size[0]) + size_t(x)] : nullptr;
}

bool LayerGrid::grows_by(const LayerGrid &other) const
{
    bool grows = false;
    for (int k = 0; k < 2; ++k)
        grows = grows || other.first[k] < first[k] ||
                other.first[k] + other.size[k] > first[k] + size[k];
    return grows;
}

void LayerGrid::add(const LayerGrid &other)
{
    if (grows_by(other)) {
        int low[2], high[2];
        for (int k = 0; k < 2; ++k) {
            low[k] = std::min(first[k], other.first[k]);
            high[k] = std::max(first[k] + size[k], other.first[k] + other.size[k]);
        }
        LayerGrid larger = blank_grid(low, high);
        larger.add(*this);
        *this = std::move(larger);
    }
    for (int j = 0; j < other.size[1]; ++j)
        for (int i = 0; i < other.size[0]; ++i) {
            int x = other.first[0] + i - first[0], y = other.first[1] + j - first[1];
            join(samples[size_t(y) * size_t(size[0]) + size_t(x)],
                 other.samples[size_t(j) * size_t(other.size[0]) + size_t(i)]);
        }
}

LayerGrid make_layer_grid(const Surface &surface, const Region &region, const Frame &frame,
                          double pitch, Task &task)
{
    constexpr size_t LARGE = 1 << 14; /* changes no byte */
    const size_t parts = std::min<size_t>(task.threads(), task.parts(region.size(), LARGE));
    const FlatRegion flat(surface, region, frame, pitch);
    Vector<Vec3d> kept(3 * std::min(region.size(), MAX_KEPT));
    struct Box {
        Vec3d low = {INFINITY, INFINITY, 0}, high = -low;
    };
    Vector<Box> boxes(parts);
    task.in_parts(region.size(), parts, [&](size_t part, size_t from, size_t to) {
        Box box;
        for (size_t local = from; local < to; ++local)
            for (size_t k = 0; k < 3; ++k) {
                const Vec3d p = flat.in_frame(uint32_t(local), int(k));
                if (local < MAX_KEPT)
                    kept[3 * local + k] = p;
                for (int a = 0; a < 2; ++a) {
                    box.low[a] = std::min(box.low[a], p[a]);
                    box.high[a] = std::max(box.high[a], p[a]);
                }
            }
        boxes[part] = box;
    });
    int low[2], high[2];
    for (int a = 0; a < 2; ++a) {
        for (const Box &box : boxes) {
            boxes[0].low[a] = std::min(boxes[0].low[a], box.low[a]);
            boxes[0].high[a] = std::max(boxes[0].high[a], box.high[a]);
        }
        low[a] = int(std::floor(flat.in_texels(boxes[0].low, a)));
        high[a] = int(std::floor(flat.in_texels(boxes[0].high, a))) + 1;
    }
    Vector<LayerGrid> grids(parts);
    task.in_parts(region.size(), parts, [&](size_t part, size_t from, size_t to) {
        LayerGrid grid = blank_grid(low, high);
        constexpr size_t SAMPLE_TURNS = 8; /* of a short loop, that take as long as a sample */
        cancel_point(SAMPLE_TURNS * grid.samples.size());
        for (size_t local = from; local < to; ++local) {
            const auto triangle = uint32_t(local);
            Vec3d p[3];
            for (size_t k = 0; k < 3; ++k)
                p[k] = flat.in_texels(local < MAX_KEPT ? kept[3 * local + k]
                                                       : flat.in_frame(triangle, int(k))) -
                       Vec3d(low[0], low[1], 0);
            raster_centres(p, grid.size[0], grid.size[1], [&](int i, int j, double depth) {
                join(grid.samples[size_t(j) * size_t(grid.size[0]) + size_t(i)],
                     {float(depth), float(depth), triangle, triangle});
            });
        }
        grids[part] = std::move(grid);
    });
    for (size_t part = 1; part < parts; ++part)
        grids[0].add(grids[part]);
    return std::move(grids[0]);
}

Layers find_layers(const Surface &surface, const Region &region, const Frame &frame, double pitch,
                   Task &task, bool discontinuities)
{
    const LayerRule rule = layer_rule(surface, pitch);
    LayerGrid grid = make_layer_grid(surface, region, frame, pitch, task);
    Layers layers;
    for (const Sample &s : grid.samples)
        layers.samples += s.high >= s.low;
    if (discontinuities)
        find_discontinuities(FlatRegion(surface, region, frame, pitch), grid, rule.step,
                             layers.discontinuities);
    for (size_t at = 0; at < grid.samples.size(); ++at) {
        if (!(grid.samples[at].high - grid.samples[at].low > rule.apart))
            continue;
        Vector<DoubleSample> group = take_group(grid, at, rule.apart);
        layers.doubled += group.size();
        if (is_fold(group, rule))
            layers.folds.insert(layers.folds.end(), group.begin(), group.end());
    }
    return layers;
}

/* Whether a sample of one grid lies beside one of the other and far from it. */
static bool discontinuity_between(const LayerGrid &target, const LayerGrid &added, float max_step)
{
    constexpr int BESIDE[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    for (int j = added.first[1]; j < added.first[1] + added.size[1]; ++j)
        for (int i = added.first[0]; i < added.first[0] + added.size[0]; ++i) {
            const Sample &here = *added.at(i, j);
            for (auto [x, y] : BESIDE) {
                const Sample *there = target.at(i + x, j + y);
                if (there && here.high >= here.low && there->high >= there->low &&
                    std::fabs(here.high - there->high) > max_step)
                    return true;
            }
        }
    return false;
}

bool fold_together(const LayerGrid &target, const LayerGrid &added, const LayerRule &rule,
                   size_t &doubled)
{
    doubled = 0;
    if (discontinuity_between(target, added, rule.step))
        return true;
    /* A group that reaches farther from what is added than this is too large anyway. */
    const int around = int(JUNK_SAMPLES) + 1;
    int low[2], high[2];
    for (int k = 0; k < 2; ++k) {
        low[k] = added.first[k] - around;
        high[k] = added.first[k] + added.size[k] + around;
    }
    LayerGrid both = blank_grid(low, high);
    for (int j = low[1]; j < high[1]; ++j)
        for (int i = low[0]; i < high[0]; ++i) {
            const size_t row = size_t(j - low[1]) * size_t(both.size[0]);
            Sample &s = both.samples[row + size_t(i - low[0])];
            const Sample *there = target.at(i, j), *here = added.at(i, j);
            if (there)
                s = *there;
            bool was = s.high - s.low > rule.apart;
            if (here)
                join(s, *here);
            doubled += !was && s.high - s.low > rule.apart;
        }
    for (size_t at = 0; at < both.samples.size(); ++at) {
        Vector<DoubleSample> group = take_group(both, at, rule.apart);
        if (!group.empty() && is_fold(group, rule))
            return true;
    }
    return false;
}

} // namespace gtx
