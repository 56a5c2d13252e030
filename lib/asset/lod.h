/* LOD mesh sections: the layout of their bytes, and their coding (format/gtx.md, sections 1.2 and
 * 6). */
#ifndef GTX_ASSET_LOD_H
#define GTX_ASSET_LOD_H

#include "asset/asset.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GTX_LOD_HEADER 32u
#define GTX_MAX_LOD_VERTICES ((1u << 24) - 1) /* words of the filter have 3 bytes */

/* Bytes of a level without normals. */
static inline uint64_t gtx_lod_size(uint64_t patches, uint64_t vertices, uint64_t triangles)
{
    return GTX_LOD_HEADER + 4 * (patches + 1) + 12 * triangles + 6 * vertices;
}

/* And of its normals. */
static inline uint64_t gtx_lod_normals_size(uint32_t flags, uint64_t vertices)
{
    return flags & GTX_LOD_NORMALS ? 2 * vertices + 4 : 0;
}

/* Normals are no more than what coding them has room for. */
static inline bool gtx_lod_may_have_normals(uint64_t vertices, uint64_t triangles)
{
    return vertices <= 2 * triangles;
}

/* Shows the bytes of a level. False when they are not as many as its counts say; only header and
 * size are looked at. */
bool gtx_lod_load(const uint8_t *bytes, uint64_t size, uint32_t patches, gtx_lod_mesh *out);

/* Writes a level as gtx_lod_size and gtx_lod_normals_size bytes. */
void gtx_lod_store(const gtx_lod_mesh *lod, uint32_t patches, uint8_t *out);

/* The filter of LOD mesh sections; `in` and `out` are distinct and have `size` bytes, as have
 * `links`, for its own use. Undoing is false when the counts do not fit the size; whatever else the
 * bytes are, it stays within them. It overwrites what it has read. */
void gtx_lod_filter_apply(const uint8_t *in, size_t size, uint8_t *out, uint8_t *links);
bool gtx_lod_filter_undo(uint8_t *in, size_t size, uint8_t *out);

/* lod_normals.c: the normals that a level's triangles tell, 2 bytes a vertex, as the filter expects
 * them. Indices are 4 bytes each, positions 2; `sums` has room for 12 bytes a vertex, and may be
 * where `out` is. Triangles with indices beyond the vertices count for nothing. */
void gtx_lod_expect_normals(const uint8_t *indices, size_t triangles, const uint8_t *positions,
                            size_t vertices, uint8_t *sums, uint8_t *out);

#ifdef __cplusplus
}
#endif
#endif
