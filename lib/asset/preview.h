/* An asset of patches and LOD meshes without heights, as the beginning of a file gives it. */
#ifndef GTX_ASSET_PREVIEW_H
#define GTX_ASSET_PREVIEW_H

#include "asset/section.h"

/* The mip levels by which a preview's maps are smaller than the asset's: it has at most so many
 * texels where rectangles stay valid then. */
uint32_t gtx_preview_shift(const gtx_info *info, uint64_t texels);

/* The preview's gtx_info, without its colours and the sizes of its LOD meshes. With `mips` it has
 * the asset's mip levels from the shift on. */
gtx_info gtx_preview_info(const gtx_info *info, uint32_t shift, bool mips);

/* Normals of a mesh's vertices, three numbers each, of any length, which are 0: their own, or those
 * of the triangles, each as much as its area. */
void gtx_mesh_normals(const gtx_lod_mesh *mesh, float *normals);

/* Bytes that gtx_preview_new allocates besides the preview. */
uint64_t gtx_preview_scratch(const gtx_info *preview, uint32_t vertices);

/* Makes a preview of an asset that has patches, LOD meshes and level levels[kind] of some maps, -1
 * for those that it lacks. If normals are among these, the source has heights and all coarser
 * levels too, and only the marks of the heights are kept. NULL when memory is out. */
gtx_asset *gtx_preview_new(const gtx_asset *source, const gtx_info *preview, uint32_t shift,
                           const int levels[GTX_SECTION_META + 1]);

/* sketch.c: what becomes of the info where no patches are there yet: a page that has room for small
 * rectangles. */
gtx_info gtx_sketch_info(const gtx_info *info);

/* Gives an asset of such an info, which has none, patches that LOD mesh 0 lies on. False when
 * memory is out. */
bool gtx_sketch_patches(gtx_asset *asset);

#endif
