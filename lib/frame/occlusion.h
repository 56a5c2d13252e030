/* What displaced grids hide: which tiles of the picture they fill, and how far they reach there. */
#ifndef GTX_FRAME_OCCLUSION_H
#define GTX_FRAME_OCCLUSION_H

#include "frame/grid.h"
#include "frame/project.h"

/* Masked depth (Hasselgren, Andersson, Akenine-Moller, Masked Software Occlusion Culling, HPG
 * 2016), of one instance at a time, in the rectangle that its bounds cover. */
typedef struct gtx_occlusion {
    gtx_scratch tiles, points;
    gtx_camera_rows camera;   /* over dots */
    int32_t x, y;             /* of its first dot: occlusion.c says how large they are */
    int32_t columns, rows;    /* tiles; none: nothing is hidden */
} gtx_occlusion;

/* Begins with nothing hidden, and stays so where that cannot be told: without the viewport's size,
 * with mains that may discard, or without memory. */
void gtx_occlusion_begin(gtx_occlusion *o, const gtx_draw_call *draw, const gtx_model *model,
                         const gtx_instance_data *placed);
/* Nothing is hidden any more. */
void gtx_occlusion_end(gtx_occlusion *o);
/* Adds what a patch has in the grids since `before`: triangles that show whole, and small ones at
 * outlines, beside which its neighbours go on. */
void gtx_occlusion_add(gtx_occlusion *o, const gtx_model *model, uint32_t patch,
                       const gtx_grids *grids, const gtx_grids_state *before,
                       const gtx_allocator *hooks);
/* The camera over a patch's grid space, for gtx_project_slab. */
gtx_patch_view gtx_occlusion_view(const gtx_occlusion *o, gtx_record record);
/* Whether all of a slab, or of a sphere in object space, lies behind what was added, or out of
 * view. Some pixels around it count, too: nothing shows at outlines that should not. */
bool gtx_is_slab_hidden(const gtx_occlusion *o, const gtx_patch_view *view, const gtx_slab *slab);
bool gtx_is_sphere_hidden(const gtx_occlusion *o, const float sphere[3], double radius);

void gtx_occlusion_free(gtx_occlusion *o, const gtx_allocator *allocator);

#endif
