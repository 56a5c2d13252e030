/* Percentiles of values, in constant memory. */
#pragma once

#include "mesh/mesh.hpp"

#include <algorithm>
#include <cstring>

namespace gtx {

/* Counts of values >= 0 by the upper bits of their floats: the ten after the exponent's tell a
 * value to 1/1024 of it. Which thread adds what makes no difference. */
class Distribution {
public:
    void add(const Vector<float> &values)
    {
        if (counts_.empty())
            counts_.resize(size_t(1) << (31 - DROPPED));
        for (float value : values) {
            uint32_t bits;
            memcpy(&bits, &value, sizeof bits);
            ++counts_[(bits & 0x7fffffff) >> DROPPED];
            most_ = std::max(most_, value);
        }
        count_ += values.size();
    }
    uint64_t count() const { return count_; }
    double most() const { return double(most_); }
    /* What 99 % of the values are not above, to 1/1024 more; 0 of none. */
    double percentile_99() const
    {
        const uint64_t rank = (count_ * 99 + 99) / 100;
        uint64_t below = 0;
        for (uint32_t k = 0; k < counts_.size(); ++k) {
            below += counts_[k];
            if (!below || below < rank)
                continue;
            const uint32_t bits = (k << DROPPED) | ((1u << DROPPED) - 1);
            float value;
            memcpy(&value, &bits, sizeof value);
            return double(std::min(value, most_));
        }
        return 0;
    }

private:
    static constexpr unsigned DROPPED = 13;
    Vector<uint64_t> counts_;
    uint64_t count_ = 0;
    float most_ = 0;
};

} // namespace gtx
