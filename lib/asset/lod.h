/* LOD mesh sections: the layout of their bytes, and their coding (format/gtx.md, sections 1.2 and
 * 6). */
#ifndef GTX_ASSET_LOD_H
#define GTX_ASSET_LOD_H

#include "asset/asset.h"

#include <stdbool.h>

#define GTX_LOD_HEADER 32u
#define GTX_MAX_LOD_VERTICES (1u << 28)

/* Bytes of a level. */
static inline uint64_t gtx_lod_size(uint64_t patches, uint64_t vertices, uint64_t triangles)
{
    return GTX_LOD_HEADER + 4 * (patches + 1) + 12 * triangles + 6 * vertices;
}

/* Shows the bytes of a level. False when they are not as many as its counts say; only header and
 * size are looked at. */
bool gtx_lod_load(const uint8_t *bytes, uint64_t size, uint32_t patches, gtx_lod_mesh *out);

/* Writes a level as gtx_lod_size bytes. */
void gtx_lod_store(const gtx_lod_mesh *lod, uint32_t patches, uint8_t *out);

/* The filter of LOD mesh sections; `in` and `out` are distinct and have `size` bytes. Undoing is
 * false when the counts do not fit the size; whatever else the bytes are, it stays within them. */
void gtx_lod_filter_apply(const uint8_t *in, size_t size, uint8_t *out);
bool gtx_lod_filter_undo(const uint8_t *in, size_t size, uint8_t *out);

#endif
