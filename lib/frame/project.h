/* Where slabs are in the picture, in tiles. */
#ifndef GTX_FRAME_PROJECT_H
#define GTX_FRAME_PROJECT_H

#include "frame/patch_view.h"

enum { GTX_TILE = 4 };        /* pixels along a tile */

/* A slab in view, and the tiles that it may cover: x0 to x1, y0 to y1, and between two diagonals
 * each way. */
typedef struct gtx_visible_slab {
    float near;               /* the least t of its points */
    uint16_t x0, x1, y0, y1;
    int32_t sum[2], difference[2]; /* of x and y */
} gtx_visible_slab;

/* False when the slab is out of view. */
bool gtx_project_slab(const gtx_camera_rows *c, const gtx_patch_view *v, const gtx_slab *slab,
                      gtx_visible_slab *out);

#endif
