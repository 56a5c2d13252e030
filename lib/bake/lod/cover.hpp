/* Whether a surface lies all over a triangle, and how far above and below. */
#pragma once

#include "bake/lod/far_search.hpp"

namespace gtx::baking {

/* The triangles of a surface that lie over another, and how far each is at most from what it lies
 * over. */
struct CoverParts {
    static constexpr size_t MAX = 64; /* at half the dragon's cook takes 3 % more instructions, at
                                         double 0.7 % fewer */
    size_t count = 0;
    uint32_t triangle[MAX];
    double away[MAX];
};

/* A triangle of a surface over the middle of another, if what of the surface faces its side and is
 * within `most` of its plane covers all of it: none of its points is then farther than `most` from
 * the surface. NO_PATCH where that is not sure. `near` is one close by, or none. Each
 * triangle of the surface is farther by what `beyonds` says, if there is any. */
uint32_t covering(const Corners &triangle, const SortedSurface &surface, double most,
                  uint32_t near, const Reached *beyonds = nullptr, CoverParts *parts = nullptr);

} // namespace gtx::baking
