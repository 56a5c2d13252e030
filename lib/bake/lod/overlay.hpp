/* Two surfaces laid over each other: how far each is at most from the other, piece by piece. */
#pragma once

#include "bake/lod/far_search.hpp"

namespace gtx::baking {

/* How far triangles are at most, infinite where it is not sure. */
struct Overlay {
    Vector<float> of_fine;       /* each fine triangle from the coarse surface */
    Reached of_coarse;           /* each coarse triangle from what the fine surface stands for */
    Reached to_coarse;           /* of what that is, each coarse triangle from its share */

    explicit Overlay(size_t fine, size_t coarse)
        : of_fine(fine, INFINITY), of_coarse(coarse), to_coarse(coarse)
    {
    }
};

/* Of a surface and one with fewer triangles. What the fine one stands for, if anything, is at most
 * `before` farther than a triangle of it, and that is at most `beyond` farther than from what it
 * stands for. Deterministic for any thread count. */
Overlay lay_over(const SortedSurface &fine, const SortedSurface &coarse, const Reached *before,
                 const Reached *beyond, Task &task);

} // namespace gtx::baking
