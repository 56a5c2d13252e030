/* Normals of the vertices of LOD meshes: as near to the normal maps as a level can be. */
#pragma once

#include "mesh/task.hpp"

#include <geotex/geotex.h>

namespace gtx {

/* What normals are taken from: a page after the other, as an asset has them. */
struct NormalMaps {
    const gtx_patch *patches;
    uint32_t patch_count, page_width, page_height, height_bits;
    const uint8_t *height, *normal; /* level 0 */
};

struct LodNormals {
    Vector<uint8_t> codes; /* 2 a vertex, or none: they would stray too far from the maps */
    float error = 0;       /* as gtx_lod_mesh has it */
};

/* Of a level: least squares over the texels that its triangles show, in few bytes once coded.
 * Deterministic. */
LodNormals lod_normals(const gtx_lod_mesh &level, const NormalMaps &maps);

/* Puts them into the level, which is used with them; false where there are none. */
bool put_lod_normals(const LodNormals &normals, gtx_lod_mesh &level);

/* Makes and puts them into levels, the finest first, up to the first that has none; `out` holds
 * them. */
void add_lod_normals(Vector<gtx_lod_mesh> &levels, const NormalMaps &maps, Vector<LodNormals> &out,
                     Task &task);

} // namespace gtx
