/* Texture units; a model has one texture a unit. Samplers of the shaders carry the same numbers. */
#ifndef GTX_FRAME_UNITS_H
#define GTX_FRAME_UNITS_H

#include <geotex/frame.h>

enum {
    UNIT_CELLS = GTX_SLOT_CELLS,
    UNIT_TRIM = GTX_SLOT_TRIM,
    UNIT_NORMALS = GTX_SLOT_NORMALS,
    UNIT_COLORS = GTX_SLOT_COLORS,
    UNIT_PATCHES = GTX_SLOT_PATCHES,
    UNIT_MATERIALS = GTX_SLOT_MATERIALS,
    UNIT_EMISSIONS = GTX_SLOT_EMISSIONS,
    UNIT_COUNT = GTX_SLOT_COUNT,
    UNIT_CLEARED = 8, /* units that render.h promises to leave empty */
    UNIT_RAYS = 13,   /* the first of three, which gtx_rays_bind binds */
    UNIT_STREAM = 16  /* a buffer's; an engine's own samplers have 8 to 12 */
};

#endif
