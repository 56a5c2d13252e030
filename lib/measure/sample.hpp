/* Deterministic points spread evenly over shapes. */
#pragma once

#include "mesh/task.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace gtx {

/* Knuth's MMIX generator, upper bits. */
class Random {
public:
    explicit Random(uint32_t seed = 0) : state_(1 + seed * 0x9e3779b97f4a7c15u) {}
    double next() /* in [0, 1) */
    {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return double(state_ >> 11) / 9007199254740992.0;
    }

private:
    uint64_t state_;
};

/* Calls place(shape) for `count` points that are stratified over the sizes of shapes. */
template <class Place>
void stratify(const Vector<double> &size, size_t count, Random &random, Place place)
{
    double total = 0, before = 0;
    for (double s : size)
        total += s;
    if (!(total > 0))
        return;
    size_t shape = 0, last = size.size() - 1;
    while (size[last] <= 0)
        --last;
    for (size_t i = 0; i < count; ++i) {
        double at = (double(i) + random.next()) / double(count) * total;
        while (shape < last && (size[shape] <= 0 || before + size[shape] <= at))
            before += size[shape++];
        cancel_point();
        place(shape);
    }
}

/* The value that 99 % of the values are not above; orders them. */
inline double percentile_99(Vector<float> &values)
{
    if (values.empty())
        return 0;
    size_t rank = (values.size() * 99 + 99) / 100 - 1;
    std::nth_element(values.begin(), values.begin() + ptrdiff_t(rank), values.end());
    return values[rank];
}

} // namespace gtx
