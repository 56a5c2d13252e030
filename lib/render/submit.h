/* Carries out the draws of a planned frame in OpenGL. */
#ifndef GTX_RENDER_SUBMIT_H
#define GTX_RENDER_SUBMIT_H

#include "frame/model.h"
#include "render/renderer.h"

/* One gtx_draw, and what is set so far. */
typedef struct gtx_submission {
    gtx_renderer *renderer;
    const gtx_view *view;
    const gtx_model *model;     /* whose textures are bound */
    const gtx_program *program; /* in use, ... */
    gtx_constants constants;    /* ... with these */
} gtx_submission;

/* Draws; the renderer's vertex array is bound, and the data of instances in its buffer. `user` is a
 * gtx_submission. */
void gtx_submit_draw(const gtx_frame_draw *draw, void *user);

#endif
