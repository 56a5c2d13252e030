/* Rays against an LOD mesh, for tiles whose heights are not resident. */
#pragma once

#include "mesh/memory.hpp"

#include <geotex/geotex.h>

namespace gtx {

class LodRays {
public:
    LodRays() = default;
    /* Of the finest one; the asset may go. Without any no ray meets it. */
    explicit LodRays(const gtx_asset *asset);

    /* How far a ray goes over the mesh moved to `place`, in lengths of its direction; infinite: it
     * meets nothing. Looks at every triangle: some ten thousand in a tenth of a millisecond. */
    float distance(const float origin[3], const float direction[3], const float place[3]) const;
    uint64_t bytes() const;

private:
    Vector<float> positions_;        /* 3 a vertex */
    Vector<uint32_t> corners_;       /* 3 a triangle */
};

} // namespace gtx
