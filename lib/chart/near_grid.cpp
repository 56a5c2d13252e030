/* Small charts and the cells of a grid that they are near. */
#include "chart/near_grid.hpp"

namespace gtx {

template <class T> static void sort_unique(Vector<T> &values)
{
    size_t compared = 0; /* eight comparisons take as long as a step */
    std::sort(values.begin(), values.end(), [&](const T &a, const T &b) {
        return (++compared % 8 ? void() : cancel_point()), a < b;
    });
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

void NearGrid::dilate()
{
    sort_unique(entries_);
    Vector<Entry> dilated;
    dilated.reserve(27 * entries_.size());
    for (const auto &[cell, candidate] : entries_) {
        cancel_point();
        constexpr uint64_t AROUND[3] = {UINT64_MAX, 0, 1}; /* one less, and so on: bits are cut */
        for (uint64_t x : AROUND)
            for (uint64_t y : AROUND)
                for (uint64_t z : AROUND)
                    dilated.push_back({pack(coordinate(cell, 0) + x, coordinate(cell, 1) + y,
                                            coordinate(cell, 2) + z),
                                       candidate});
    }
    sort_unique(dilated);
    entries_ = std::move(dilated);
    for (const auto &[cell, candidate] : entries_)
        filter_[hash(cell)] = true;
}

} // namespace gtx
