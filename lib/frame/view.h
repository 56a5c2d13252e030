/* What a draw takes from a gtx_view and from each instance. */
#ifndef GTX_FRAME_VIEW_H
#define GTX_FRAME_VIEW_H

#include <geotex/render.h>
#include <stdbool.h>

/* What the proxy's vertex shader reads for each instance. */
typedef struct gtx_instance_data {
    float world[3][4];        /* rows of object -> world */
    float object[3][4];       /* rows of the inverse's linear part, and the eye in object space */
    float tint[4];
    uint32_t id;
} gtx_instance_data;

typedef struct gtx_frame {
    float clip_from_world[16];
    double eye[4];            /* world; the ray through a point p has the direction p * w - xyz */
    float depth[4], light[4], detail[4], search[4]; /* as geotex_view.glsl has them */
    bool reversed, mirrored;  /* mirrored: the view turns clockwise into counter-clockwise */
} gtx_frame;

/* One frame, for the steps of its plan. */
typedef struct gtx_draw_call {
    struct gtx_planner *planner;
    const gtx_view *view;
    gtx_frame frame;
} gtx_draw_call;

/* Errors: ARGUMENT (a matrix without an inverse, or not finite). */
gtx_result gtx_frame_from_view(const gtx_view *view, gtx_frame *out, gtx_error *error);

/* Fills the instance's data; *mirrored says that its transform turns the winding. Errors:
 * ARGUMENT (not affine, no inverse, not finite). */
gtx_result gtx_place_instance(const gtx_frame *frame, const gtx_instance *instance,
                              gtx_instance_data *out, bool *mirrored, gtx_error *error);

/* An upper bound of how much an instance's transform stretches, exact for a uniform scale. */
double gtx_stretch_of(const gtx_instance_data *placed);
/* Whether it keeps angles: it turns, mirrors, moves and scales uniformly, to about a thousandth. */
bool gtx_keeps_angles(const gtx_instance_data *placed);

#endif
