/* Work that one part of a job may do, so that all parts together take no more than linear time. */
#pragma once

#include <cmath>

namespace gtx::baking {

/* The same on however many threads. */
class Budget {
public:
    explicit Budget(double work) : left_(work) {}

    bool spent() const { return left_ <= 0; }
    void spend(double work) { left_ -= work; }

private:
    double left_;
};

/* Looks at other height fields that each of `items` may cost in the mean, when `wanted` are all
 * that the model may ask for. An engine of 82 nodes asks for 160 million, and needs them; where so
 * many surfaces lie over each other that it is more, nobody can tell what belongs together. */
inline double looks_each(double items, double wanted)
{
    constexpr double ENOUGH = 1 << 28, MOST = 1 << 25, EACH = 64, LEAST = 16;
    return wanted <= ENOUGH + EACH * items ? INFINITY : LEAST + MOST / items;
}

} // namespace gtx::baking
