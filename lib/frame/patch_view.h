/* Set-up of casting by tiles: a camera's view of a model's patches, in the coordinates of their
 * grids, and the records that geotex_tiles.glsl reads. */
#ifndef GTX_FRAME_PATCH_VIEW_H
#define GTX_FRAME_PATCH_VIEW_H

#include "frame/plan.h"

#include <string.h>

/* Records of a patch and of a slab in the stream, as geotex_records.glsl lays them out. */
typedef uint32_t gtx_tile_patch[GTX_TILE_PATCH_TEXELS][4];
typedef uint32_t gtx_tile_slab[GTX_TILE_SLAB_TEXELS][4];

/* The ray through a point (x, y) of the viewport, in pixels: X and Y turn a perspective camera's
 * direction and move an orthographic one's origin. */
enum { RAY_ORIGIN, RAY_DIRECTION, RAY_X, RAY_Y, RAY_PARTS };

/* The camera over an instance's object space. */
typedef struct gtx_camera_rows {
    double row[3][4];         /* object space -> x, y and t, x and y times t when perspective */
    double near[4];           /* positive behind the near plane */
    double rays[RAY_PARTS][3];
    bool perspective;
    uint32_t width, height;
} gtx_camera_rows;

/* The same over a patch's grid space. */
typedef struct gtx_patch_view {
    double rays[RAY_PARTS][3];
    float row[3][4], near[4];
    const gtx_slab *slabs;
    uint32_t count, patch, level;
    bool two_sided, perspective;
} gtx_patch_view;

/* Fills `place` but for where the heads are. */
gtx_camera_rows gtx_camera_rows_of(const gtx_draw_call *draw, const gtx_instance_data *placed,
                                   float place[GTX_PLACE_ROWS][4]);
/* Takes rows and near plane to a patch's grid space. */
void gtx_camera_over_patch(const gtx_camera_rows *c, const float (*record)[4], gtx_patch_view *v);
/* Sets a patch up at a level, and writes its record. */
gtx_patch_view gtx_patch_view_of(const gtx_camera_rows *c, const gtx_model *model,
                                 const gtx_instance_data *placed, const gtx_plan_entry *entry,
                                 gtx_tile_patch out);
/* Writes the record of a slab whose patch's is at texel `patch_at` of the stream. */
void gtx_patch_view_put_slab(const gtx_patch_view *view, const gtx_slab *slab, uint32_t patch_at,
                             gtx_tile_slab out);
/* Whether no ray crosses the slab's height field from above. */
bool gtx_patch_view_faces_away(const gtx_patch_view *view, const gtx_slab *slab);

static inline uint32_t gtx_bits_of(double value)
{
    const float f = (float)value;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits;
}

#endif
