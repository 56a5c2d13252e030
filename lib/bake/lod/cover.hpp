/* Whether a surface lies all over a triangle, and how far above and below. */
#pragma once

#include "bake/lod/far_search.hpp"

namespace gtx::baking {

/* A triangle of a surface over the middle of another, if what of the surface faces its side and is
 * within `most` of its plane covers all of it: none of its points is then farther than `most` from
 * the surface. NO_PATCH where that is not sure. `near` is one close by, or none. */
uint32_t covering(const Corners &triangle, const SortedSurface &surface, double most,
                  uint32_t near);

} // namespace gtx::baking
