/* The maps of patches on the pages of one asset. */
#pragma once

#include "bake/field/patch.hpp"

namespace gtx::baking {

/* The centre of a bounding box, to a multiple of the largest power of two that is not above its
 * diagonal: a model near the origin keeps its coordinates. Throws Error: INPUT, which calls it
 * `what`. */
Vec3d find_anchor(const Vec3d &low, const Vec3d &high, const char *what);

/* Places rectangles whose sides are multiples of `grain` on pages of one size, as full as it
 * can. */
struct Packing {
    struct Place {
        uint32_t page, x, y;
    };
    Vector<Place> places;
    uint32_t page_count = 0, width = 0, height = 0;
};
Packing pack(const Vector<std::array<uint32_t, 2>> &sizes, uint32_t grain);

/* Puts patches on the pages of one asset; those of an asset have the same kinds of maps. Emission
 * scale is left to the caller. Throws Error: LIMIT. */
Maps place_on_pages(Vector<PatchMaps> &patches, const Vec3d &anchor,
                    const BakeOptions &options, const Limits &limits);

} // namespace gtx::baking
