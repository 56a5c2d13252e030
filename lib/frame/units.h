/* Texture units; a model has one texture a unit. Samplers of the shaders carry the same numbers. */
#ifndef GTX_FRAME_UNITS_H
#define GTX_FRAME_UNITS_H

enum {
    UNIT_CELLS, UNIT_TRIM, UNIT_NORMALS, UNIT_COLORS, UNIT_PATCHES, UNIT_MATERIALS, UNIT_EMISSIONS,
    UNIT_COUNT,
    UNIT_CLEARED = 8, /* units that render.h promises to leave empty */
    UNIT_STREAM = 8,  /* a buffer's, which leaves the other textures of the unit alone */
    UNIT_RAYS = 13    /* the first of three, which gtx_rays_bind binds */
};

#endif
