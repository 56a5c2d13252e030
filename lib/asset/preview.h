/* An asset of LOD meshes alone, as the beginning of a file has it. */
#ifndef GTX_ASSET_PREVIEW_H
#define GTX_ASSET_PREVIEW_H

#include "asset/section.h"

/* Levels of mips by which a preview's maps are smaller than those of such an asset: about as many
 * texels as `triangles`, and rectangles that hold. */
uint32_t gtx_preview_shift(const gtx_info *info, uint64_t triangles);

/* What the preview is, but for its colours, and the sizes of its LOD meshes. With mip levels it has
 * those that the asset has beyond the shift. */
gtx_info gtx_preview_info(const gtx_info *info, uint32_t shift, bool mips);

/* Bytes that gtx_preview_new takes beside the preview. */
uint64_t gtx_preview_scratch(const gtx_info *preview, uint32_t vertices);

/* Makes one of an asset that has patches, LOD meshes and some level `k` of some images, as
 * levels[kind], -1 for those that it lacks; or, where normals are among them, heights that it
 * leaves, but for their marks, and all coarser levels. NULL when memory is out. */
gtx_asset *gtx_preview_new(const gtx_asset *source, const gtx_info *preview, uint32_t shift,
                           const int levels[GTX_SECTION_META + 1]);

#endif
