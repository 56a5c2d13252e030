/* Replaces the maps of one patch of a model, and what follows from them. */
#ifndef GTX_FRAME_UPDATE_H
#define GTX_FRAME_UPDATE_H

#include "frame/model.h"

/* Bytes that the blocks of a level of a patch's maps take at most; 0 where none has blocks. */
size_t gtx_update_scratch(const gtx_model *model, const gtx_patch *patch);
/* All maps but heights; `scratch` has the bytes said above. */
void gtx_update_maps(gtx_model *model, const gtx_asset *asset, const gtx_patch *patch,
                     uint8_t *scratch, const gtx_sink *sink);

#endif
