/* A camera's view of a model's patches, in the coordinates of their grids. */
#ifndef GTX_RENDER_SIGHT_H
#define GTX_RENDER_SIGHT_H

#include "render/renderer.h"

#include <string.h>

/* Texels of a patch's record and of a slab's: see geotex_tiles.glsl. */
enum { GTX_TILE_RECORD_TEXELS = 8, GTX_TILE_SLAB_TEXELS = 4 };

/* The camera: rows of object space -> x, y and t, x and y times t when it is perspective; and what
 * geotex_tiles.glsl says of rays, in double. */
typedef struct gtx_camera_rows {
    double row[3][4], origin[3], column[3][3]; /* column: what a pixel in x, in y, and t add */
    bool perspective;
    uint32_t width, height;
} gtx_camera_rows;

/* A patch in the camera's sight. */
typedef struct gtx_sight {
    double rays[4][3];        /* origin, direction, x, y: the camera's columns in grid space */
    float row[3][4];          /* grid space -> x, y, t */
    const gtx_slab *slabs;
    uint32_t count, patch, level;
    bool two_sided, perspective;
} gtx_sight;

/* Fills `place` but for w of the first four rows, which tell where the heads are. */
gtx_camera_rows gtx_sight_camera_of(const gtx_view *view, const gtx_frame *frame,
                                    const gtx_instance_data *placed, float place[PLACE_ROWS][4]);
/* Looks at a patch at a level, and writes its record. */
gtx_sight gtx_sight_of(const gtx_camera_rows *c, const gtx_model *model,
                       const gtx_instance_data *placed, const gtx_plan_entry *entry,
                       uint32_t out[GTX_TILE_RECORD_TEXELS][4]);
/* Writes the record of a slab whose patch's is at `record_at` in the stream. */
void gtx_sight_put_slab(const gtx_sight *s, const gtx_slab *slab, uint32_t record_at,
                        uint32_t out[GTX_TILE_SLAB_TEXELS][4]);
/* Whether no ray crosses the slab's height field from above. */
bool gtx_sight_faces_away(const gtx_sight *s, const gtx_slab *slab);

static inline uint32_t gtx_bits_of(double value)
{
    const float f = (float)value;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits;
}

#endif
