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
    /* Spends it where that much is left, and all of it where not. */
    bool grants(double work)
    {
        const bool enough = work <= left_;
        left_ = enough ? left_ - work : 0;
        return enough;
    }

private:
    double left_;
};

/* Looks at other height fields that each of `items` may cost in the mean, when `wanted` are all
 * that the model asks for, of which `enough`, and `each` for every item, are granted: where so many
 * surfaces lie over each other that it is more, nobody can tell what belongs together. */
inline double looks_each(double items, double wanted, double enough, double each)
{
    constexpr double MAX_LOOKS = 1 << 23, MIN_LOOKS = 4;
    return wanted <= enough + each * items ? INFINITY : MIN_LOOKS + MAX_LOOKS / items;
}

} // namespace gtx::baking
