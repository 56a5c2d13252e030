/* A grid of cells, each with the small charts near it. */
#include "chart/near_grid.hpp"

#include <iterator>

namespace gtx {

template <class T> static void sort_unique(Vector<T> &values)
{
    size_t compared = 0; /* eight comparisons take as long as a step */
    std::sort(values.begin(), values.end(), [&](const T &a, const T &b) {
        return (++compared % 8 ? void() : cancel_point()), a < b;
    });
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

/* Both of two ascending lists, each once. */
template <class T> static Vector<T> join(const Vector<T> &a, const Vector<T> &b)
{
    cancel_point(a.size() + b.size());
    Vector<T> out;
    out.reserve(a.size() + b.size());
    std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(out));
    return out;
}

/* One cell farther along an axis; ascending still, unless bits are cut. */
Vector<NearGrid::Entry> NearGrid::moved(int axis, uint64_t by) const
{
    Vector<Entry> out = entries_;
    for (auto &[cell, candidate] : out)
        cell = pack(coordinate(cell, 0) + (axis == 0 ? by : 0),
                    coordinate(cell, 1) + (axis == 1 ? by : 0),
                    coordinate(cell, 2) + (axis == 2 ? by : 0));
    if (!std::is_sorted(out.begin(), out.end()))
        sort_unique(out);
    return out;
}

void NearGrid::dilate()
{
    sort_unique(entries_);
    for (int axis = 0; axis < 3; ++axis)
        entries_ = join(join(moved(axis, UINT64_MAX), entries_), moved(axis, 1));
    for (const auto &[cell, candidate] : entries_)
        filter_[hash(cell)] = true;
}

} // namespace gtx
