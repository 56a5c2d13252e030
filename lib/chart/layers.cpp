/* Rasterises a chart along its axis and looks for texel centres with two layers. */
#include "chart/layers.hpp"

#include <algorithm>

namespace gtx {

namespace {

/* Groups of doubled samples so small and so shallow are a scan's noise. */
constexpr size_t JUNK_SAMPLES = 4;
constexpr double JUNK_PITCHES = 4;
/* Layers closer than this share of the diagonal are one. */
constexpr double LAYER_DISTANCE = 1e-4;

struct Sample {
    float low = INFINITY, high = -INFINITY;
    uint32_t back = 0, front = 0;
};

struct Grid {
    int width, height;
    std::vector<Sample> samples;
};

/* A triangle at the centres of the texels it covers, edges included. Corners are in texels. */
void rasterise(const Vec3d corner[3], uint32_t local, Grid &grid)
{
    const Vec3d &a = corner[0], &b = corner[1], &c = corner[2];
    double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area == 0)
        return;
    auto first = [](double x) { return int(std::max(0., std::ceil(x - 0.5))); };
    auto last = [](double x, int size) { return int(std::min(size - 1., std::floor(x - 0.5))); };
    int i0 = first(std::min({a.x, b.x, c.x})), i1 = last(std::max({a.x, b.x, c.x}), grid.width);
    int j0 = first(std::min({a.y, b.y, c.y})), j1 = last(std::max({a.y, b.y, c.y}), grid.height);
    for (int j = j0; j <= j1; ++j)
        for (int i = i0; i <= i1; ++i) {
            double x = i + 0.5, y = j + 0.5;
            double wb = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / area;
            double wc = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
            if (wb < 0 || wc < 0 || wb + wc > 1)
                continue;
            float depth = float(a.z + wb * (b.z - a.z) + wc * (c.z - a.z));
            Sample &s = grid.samples[size_t(j) * size_t(grid.width) + size_t(i)];
            if (depth < s.low) {
                s.low = depth;
                s.back = local;
            }
            if (depth > s.high) {
                s.high = depth;
                s.front = local;
            }
        }
}

Grid rasterise_region(const Surface &surface, const Region &region, const Frame &frame,
                      double pitch)
{
    Grid grid = {int(std::ceil(frame.extent[0] / pitch)) + 1,
                 int(std::ceil(frame.extent[1] / pitch)) + 1,
                 {}};
    grid.samples.resize(size_t(grid.width) * size_t(grid.height));
    FrameInverse inverse(frame);
    for (uint32_t local = 0; local < region.size(); ++local) {
        Vec3d corner[3];
        for (int k = 0; k < 3; ++k) {
            corner[k] = inverse(surface.mesh.position(region.triangles[local], k));
            corner[k].x /= pitch;
            corner[k].y /= pitch;
        }
        rasterise(corner, local, grid);
    }
    return grid;
}

/* Empties `samples` of the 8-connected group that holds the one at `start`; returns the group. */
std::vector<DoubleSample> take_group(Grid &grid, size_t start, float apart)
{
    std::vector<DoubleSample> group;
    std::vector<size_t> stack;
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
        int i = int(stack.back() % size_t(grid.width)), j = int(stack.back() / size_t(grid.width));
        stack.pop_back();
        for (int y = std::max(0, j - 1); y <= std::min(grid.height - 1, j + 1); ++y)
            for (int x = std::max(0, i - 1); x <= std::min(grid.width - 1, i + 1); ++x)
                take(size_t(y) * size_t(grid.width) + size_t(x));
    }
    return group;
}

} // namespace

Layers find_layers(const Surface &surface, const Region &region, const Frame &frame, double pitch)
{
    constexpr double STEPS = 254; /* of an 8-bit height */
    float apart = float(std::max(frame.extent[2] / STEPS, LAYER_DISTANCE * surface.diagonal));
    float shallow = float(JUNK_PITCHES * pitch);
    Grid grid = rasterise_region(surface, region, frame, pitch);
    Layers layers;
    for (const Sample &s : grid.samples)
        layers.samples += s.high >= s.low;
    for (size_t at = 0; at < grid.samples.size(); ++at) {
        std::vector<DoubleSample> group = take_group(grid, at, apart);
        layers.doubled += group.size();
        bool deep = std::any_of(group.begin(), group.end(),
                                [=](const DoubleSample &d) { return d.depth > shallow; });
        if (deep || group.size() > JUNK_SAMPLES)
            layers.folds.insert(layers.folds.end(), group.begin(), group.end());
    }
    return layers;
}

} // namespace gtx
