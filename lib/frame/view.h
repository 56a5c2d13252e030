/* Matrices and vectors that shaders are given for a view and for each instance, computed in double
 * precision. */
#ifndef GTX_FRAME_VIEW_H
#define GTX_FRAME_VIEW_H

#include <geotex/frame.h>
#include <stdbool.h>

/* Of a view, the same for all instances. */
typedef struct gtx_sight {
    float clip_from_world[16];
    double eye[4];            /* world; the ray through a point p has the direction p * w - xyz */
    float depth[4], light[4], detail[4], search[4]; /* as geotex_view.glsl has them */
    bool reversed, mirrored;  /* mirrored: the view turns clockwise into counter-clockwise */
    bool two;                 /* there is another eye: its clip space, and where it is from this */
    float other_clip[16], other_eye[4];
} gtx_sight;

/* One frame, for the steps of its plan. */
typedef struct gtx_draw_call {
    gtx_planner *planner;
    const gtx_view *view;
    gtx_sight sight;
    const gtx_instance *instances;
    uint32_t count;
    gtx_submit *submit;
    void *user;
} gtx_draw_call;

/* Errors: ARGUMENT (a matrix without an inverse, or not finite). */
gtx_result gtx_sight_of_view(const gtx_view *view, gtx_sight *out, gtx_error *error);

/* Fills the instance's data; *mirrored says that its transform turns the winding. Errors:
 * ARGUMENT (not affine, no inverse, not finite). */
gtx_result gtx_place_instance(const gtx_sight *sight, const gtx_instance *instance,
                              gtx_instance_data *out, bool *mirrored, gtx_error *error);

/* An upper bound of how much an instance's transform stretches, exact for a uniform scale. */
double gtx_stretch_of(const gtx_instance_data *placed);
/* Whether it keeps angles: it turns, mirrors, moves and scales uniformly, to about a thousandth. */
bool gtx_keeps_angles(const gtx_instance_data *placed);

#endif
