/* Depth cliffs: two sheets side by side in the map, which no cell may bridge. */
#include "bake/patch_maps.hpp"

#include <algorithm>
#include <tuple>

namespace gtx::baking {

bool Paths::joined(uint32_t from, uint32_t to, double u, double v, double reach)
{
    auto inside = [&](uint32_t t) {
        Vec3d p[3];
        for (int k = 0; k < 3; ++k)
            p[k] = chart_.grid.texel(mesh_.position(t, k));
        return std::min({p[0].x, p[1].x, p[2].x}) <= u + reach &&
               std::max({p[0].x, p[1].x, p[2].x}) >= u - reach &&
               std::min({p[0].y, p[1].y, p[2].y}) <= v + reach &&
               std::max({p[0].y, p[1].y, p[2].y}) >= v - reach;
    };
    uint32_t goal = chart_.triangles[to].source;
    queue_.assign(1, chart_.triangles[from].source);
    seen_.clear();
    seen_.insert(queue_[0]);
    for (size_t next = 0; next < queue_.size(); ++next) {
        if (queue_[next] == goal)
            return true;
        for (uint32_t n : neighbours_[queue_[next]])
            if (n != NO_TRIANGLE && !seen_.count(n) && inside(n)) {
                seen_.insert(n);
                queue_.push_back(n);
            }
    }
    return false;
}

namespace {

/* Cells that bridge, and how many of them each texel is a corner of. */
class Bridges {
public:
    Bridges(const FlatChart &chart, const Outline &outline, const std::vector<float> &trim,
            const Cover &cover, Paths &paths)
        : chart_(chart), outline_(outline), trim_(trim), cover_(cover), paths_(paths)
    {
    }

    void cut(std::vector<uint8_t> &support);

private:
    std::array<size_t, 4> corners(size_t cell) const
    {
        size_t w = size_t(chart_.grid.w);
        return {cell, cell + 1, cell + w, cell + w + 1};
    }
    bool bridges(size_t cell);
    /* Texels with the least rank go first: those that nothing covers, then those of the overlap;
     * those that end more bridges at once; the lower ones. */
    auto rank(size_t texel) const
    {
        uint32_t t = cover_.triangle[texel];
        int worth = t == NO_TRIANGLE ? 0 : t >= chart_.core ? 1 : 2;
        return std::make_tuple(worth, -count_[texel], cover_.height[texel]);
    }

    const FlatChart &chart_;
    const Outline &outline_;
    const std::vector<float> &trim_;
    const Cover &cover_;
    Paths &paths_;
    std::vector<int> count_;
};

/* Whether a step between corners of a cell is more than a slope, with no surface along it. */
bool Bridges::bridges(size_t cell)
{
    constexpr double REACH = 1.5; /* from the middle of the cell */
    std::array<size_t, 4> corner = corners(cell);
    auto triangle = [&](size_t texel) {
        uint32_t t = cover_.triangle[texel];
        return t != NO_TRIANGLE ? t : outline_.edges[outline_.nearest[texel]].triangle;
    };
    double u = double(cell % chart_.grid.w) + 0.5, v = double(cell / chart_.grid.w) + 0.5;
    for (int a = 0; a < 4; ++a) {
        for (int b = a + 1; b < 4; ++b) {
            double step = std::fabs(cover_.height[corner[a]] - cover_.height[corner[b]]);
            if (step > CLIFF * chart_.grid.coarse_pitch() &&
                !paths_.joined(triangle(corner[a]), triangle(corner[b]), u, v, REACH))
                return true;
        }
    }
    return false;
}

void Bridges::cut(std::vector<uint8_t> &support)
{
    const Grid &grid = chart_.grid;
    std::vector<size_t> cells;
    count_.assign(grid.texels(), 0);
    for (int j = 0; j + 1 < grid.h; ++j) {
        for (int i = 0; i + 1 < grid.w; ++i) {
            size_t cell = size_t(j) * size_t(grid.w) + size_t(i);
            std::array<size_t, 4> c = corners(cell);
            bool shows = std::any_of(c.begin(), c.end(), [&](size_t t) { return shown(trim_[t]); });
            bool exists = std::all_of(c.begin(), c.end(), [&](size_t t) { return support[t]; });
            if (!shows || !exists || !bridges(cell))
                continue;
            cells.push_back(cell);
            for (size_t texel : c)
                ++count_[texel];
        }
    }
    for (size_t cell : cells) {
        std::array<size_t, 4> c = corners(cell);
        if (std::all_of(c.begin(), c.end(), [&](size_t t) { return support[t]; }))
            support[*std::min_element(c.begin(), c.end(), [this](size_t a, size_t b) {
                return rank(a) < rank(b);
            })] = 0;
    }
}

} // namespace

void cut_cliffs(const FlatChart &chart, const Outline &outline, const std::vector<float> &trim,
                const Cover &cover, Paths &paths, std::vector<uint8_t> &support)
{
    Bridges(chart, outline, trim, cover, paths).cut(support);
}

} // namespace gtx::baking
