/* Edits of a patch's maps on the GPU. */
#ifndef GTX_RENDER_UPDATE_H
#define GTX_RENDER_UPDATE_H

#include "frame/model.h"
#include "render/gl.h"

/* Texels of a patch's rectangle at a level of detail, out of rows of `row_texels`. */
typedef struct gtx_update_rect {
    uint32_t unit, level;
    uint32_t mip, at[2];      /* where they go in the patch's page */
    const void *texels;
    uint32_t row_texels;
} gtx_update_rect;

void gtx_update_texels(const gtx_gl *gl, const gtx_model *model, const gtx_patch *patch,
                       const gtx_update_rect *rect);
/* Bytes that the blocks of a level of a patch's maps take at most; 0 where none has blocks. */
size_t gtx_update_scratch(const gtx_model *model, const gtx_patch *patch);
/* All maps but heights; `scratch` has the bytes said above. Leaves a row length. */
void gtx_update_maps(const gtx_gl *gl, gtx_model *model, const gtx_asset *asset,
                     const gtx_patch *patch, uint8_t *scratch);

#endif
