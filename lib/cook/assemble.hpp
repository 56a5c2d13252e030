/* Maps and LOD meshes -> an asset. */
#pragma once

#include "bake/lod/lod.hpp"

#include <memory>
#include <string>

namespace gtx {

using Asset = std::unique_ptr<gtx_asset, decltype(&gtx_close)>;

/* What an asset says of itself besides its maps. */
struct AssetFacts {
    std::string meta;            /* JSON, may be empty */
    float unit = 1;              /* metres */
    uint64_t source_triangles = 0;
    gtx_allocator allocator = {};
};

/* Throws Error: what gtx_create reports. */
Asset assemble(const Maps &maps, const Vector<LodLevel> &lod, const AssetFacts &facts);

} // namespace gtx
