/* Which patches of an instance are drawn as displaced grids and which are cast: how many pixels and
 * blocks each has in view, and what of that the planner's grids hold so far. */
#ifndef GTX_FRAME_MIX_H
#define GTX_FRAME_MIX_H

#include "frame/occlusion.h"
#include "frame/planner.h"

/* What a patch takes in the picture. */
typedef struct gtx_cover {
    double pixels;            /* of its blocks that are drawn */
    uint32_t blocks;
    bool grid;                /* it is drawn by a grid, or not at all */
} gtx_cover;

/* blocks.c: lists the blocks of a patch's level that are in view and may face the eye; all where
 * there are two. Returns how many. */
uint32_t gtx_blocks_seen(const gtx_frustum *f, const gtx_model *model, uint32_t patch,
                         uint32_t level, uint32_t *shown);
/* blocks.c: looks for the blocks of a patch that are in view, may face the eye and, where
 * `occlusion` is given, are not hidden. `shown` has room for all; none covers more than `most`. */
gtx_cover gtx_cover_of(const gtx_frustum *f, const gtx_model *model, uint32_t patch, double most,
                       const gtx_occlusion *occlusion, uint32_t *shown);
/* Adds the blocks that it found to the planner's grids, as long as that takes less than `most`
 * triangles. False if it gave up, or without memory. */
bool gtx_blocks_add(gtx_planner *planner, const gtx_frustum *f, const gtx_model *model,
                    uint32_t patch, const uint32_t *shown, uint32_t count, uint32_t most);

/* How much the grids hold; to go back there; and triangles since then. */
gtx_grids_state gtx_grids_state_of(const gtx_grids *grids);
uint32_t gtx_triangles_since(const gtx_grids *grids, const gtx_grids_state *fill);

#endif
