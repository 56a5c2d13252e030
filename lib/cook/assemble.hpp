/* Maps and LOD mesh -> an asset, and an asset's maps back. */
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

/* The maps of an asset; its charts are its patches. */
Maps maps_of(const gtx_asset *asset);

} // namespace gtx
