/* Packs rectangles into pages: skyline, bottom left, tallest first (survey: Jylanki 2010). */
#include "bake/pages.hpp"

#include <algorithm>
#include <numeric>

namespace gtx::baking {

/* Of a page, in texels: limits of the format. */
constexpr uint32_t MAX_SIDE = 4096, MIN_SIDE = 8;

/* The upper edge of what a page holds: segments from left to right. */
class Skyline {
public:
    Skyline(uint32_t width, uint32_t height) : width_(width), height_(height)
    {
        segments_.push_back({0, 0, width});
    }

    /* Finds the lowest place, of these the one that buries least, and takes it. */
    bool place(uint32_t w, uint32_t h, uint32_t &x, uint32_t &y)
    {
        size_t best = segments_.size();
        uint64_t best_buried = 0;
        uint32_t best_y = 0;
        for (size_t i = 0; i < segments_.size(); ++i) {
            if (segments_[i].x + w > width_)
                break;
            uint64_t buried;
            uint32_t at = rest(i, w, buried);
            if (at + h > height_)
                continue;
            if (best == segments_.size() || at < best_y ||
                (at == best_y && buried < best_buried)) {
                best = i;
                best_y = at;
                best_buried = buried;
            }
        }
        if (best == segments_.size())
            return false;
        x = segments_[best].x;
        y = best_y;
        cover(best, w, y + h);
        return true;
    }

    uint32_t used() const
    {
        uint32_t top = 0;
        for (const Segment &s : segments_)
            top = std::max(top, s.y);
        return top;
    }

private:
    struct Segment {
        uint32_t x, y, width;
    };

    /* The height at which a width rests from segment i on, and the area lost below it. */
    uint32_t rest(size_t i, uint32_t w, uint64_t &buried) const
    {
        uint32_t right = segments_[i].x + w, y = 0;
        size_t end = i;
        for (; end < segments_.size() && segments_[end].x < right; ++end)
            y = std::max(y, segments_[end].y);
        buried = 0;
        for (size_t k = i; k < end; ++k) {
            uint32_t x = segments_[k].x, covered = std::min(x + segments_[k].width, right) - x;
            buried += uint64_t(covered) * (y - segments_[k].y);
        }
        return y;
    }

    void cover(size_t i, uint32_t w, uint32_t top)
    {
        Segment added = {segments_[i].x, top, w};
        uint32_t right = added.x + w;
        size_t end = i;
        while (end < segments_.size() && segments_[end].x + segments_[end].width <= right)
            ++end;
        if (end < segments_.size() && segments_[end].x < right) {
            segments_[end].width -= right - segments_[end].x;
            segments_[end].x = right;
        }
        segments_.erase(segments_.begin() + ptrdiff_t(i), segments_.begin() + ptrdiff_t(end));
        segments_.insert(segments_.begin() + ptrdiff_t(i), added);
        if (i + 1 < segments_.size() && segments_[i + 1].y == top) {
            segments_[i].width += segments_[i + 1].width;
            segments_.erase(segments_.begin() + ptrdiff_t(i) + 1);
        }
        if (i > 0 && segments_[i - 1].y == top) {
            segments_[i - 1].width += segments_[i].width;
            segments_.erase(segments_.begin() + ptrdiff_t(i));
        }
    }

    uint32_t width_, height_;
    Vector<Segment> segments_;
};

using Sizes = Vector<std::array<uint32_t, 2>>;

/* Fills pages of a given size in the given order; sides are in grains. The height that comes back
 * is what was used of the page if there is but one. */
static Packing fill(const Sizes &sizes, const Vector<uint32_t> &order, uint32_t width,
                    uint32_t height)
{
    Packing packing;
    packing.places.resize(sizes.size());
    Vector<Skyline> pages;
    for (uint32_t i : order) {
        Packing::Place &place = packing.places[i];
        uint32_t w = sizes[i][0], h = sizes[i][1], page = 0;
        while (page < pages.size() && !pages[page].place(w, h, place.x, place.y))
            ++page;
        if (page == pages.size()) {
            pages.emplace_back(width, height);
            pages.back().place(w, h, place.x, place.y);
        }
        place.page = page;
    }
    packing.page_count = uint32_t(pages.size());
    packing.width = width;
    packing.height = pages.size() == 1 ? pages[0].used() : height;
    return packing;
}

/* One page: the width, among those near the square root of the area, that wastes least. */
static Packing pack_one(const Sizes &sizes, const Vector<uint32_t> &order, uint64_t area,
                        uint32_t widest, uint32_t least, uint32_t most)
{
    constexpr int TRIES = 24; /* widths; at double 0.3 % fewer bytes (truck) for twice the time */
    double side = std::sqrt(double(area));
    Packing best;
    uint64_t best_area = 0;
    int tries = sizes.size() > 20000 ? 2 : TRIES;
    for (int i = 0; i < tries; ++i) {
        uint32_t width = uint32_t(side * (0.9 + 0.35 * (i + 0.5) / tries)) + 1;
        width = std::min(std::max({width, widest, least}), most);
        Packing packing = fill(sizes, order, width, most);
        if (packing.page_count != 1)
            continue;
        packing.height = std::max(packing.height, least);
        uint64_t taken = uint64_t(width) * packing.height;
        if (!best.page_count || taken < best_area) {
            best = packing;
            best_area = taken;
        }
    }
    return best;
}

/* Several pages: as few as the largest size needs, then as low as they still hold everything. */
static Packing pack_many(const Sizes &sizes, const Vector<uint32_t> &order, uint64_t area,
                         uint32_t most)
{
    constexpr uint32_t STEPS = 32; /* heights between the least and the largest */
    Packing largest = fill(sizes, order, most, most);
    uint64_t least = area / (uint64_t(largest.page_count) * most) + 1;
    for (uint32_t i = 0; i < STEPS && least < most; ++i) {
        uint32_t height = uint32_t(least + (most - least) * i / STEPS);
        height = std::max(height, sizes[order[0]][1]);
        Packing packing = fill(sizes, order, most, height);
        if (packing.page_count <= largest.page_count)
            return packing;
    }
    return largest;
}

Packing pack(const Sizes &texels, uint32_t grain)
{
    Sizes sizes = texels;
    uint64_t area = 0;
    uint32_t widest = 0;
    for (auto &size : sizes) {
        size = {size[0] / grain, size[1] / grain};
        area += uint64_t(size[0]) * size[1];
        widest = std::max(widest, size[0]);
    }
    Vector<uint32_t> order(sizes.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        if (sizes[a][1] != sizes[b][1])
            return sizes[a][1] > sizes[b][1];
        if (sizes[a][0] != sizes[b][0])
            return sizes[a][0] > sizes[b][0];
        return a < b;
    });

    uint32_t most = MAX_SIDE / grain, least = std::max(1u, MIN_SIDE / grain);
    Packing packing;
    if (area <= uint64_t(most) * most)
        packing = pack_one(sizes, order, area, widest, least, most);
    if (!packing.page_count)
        packing = pack_many(sizes, order, area, most);
    packing.width *= grain;
    packing.height *= grain;
    for (Packing::Place &place : packing.places) {
        place.x *= grain;
        place.y *= grain;
    }
    return packing;
}

} // namespace gtx::baking
