/* What of an instance is in view, as planes over its object space. */
#ifndef GTX_FRAME_FRUSTUM_H
#define GTX_FRAME_FRUSTUM_H

#include "frame/model.h"
#include "frame/view.h"

/* A plane or any other linear function over object space, and the length of its gradient. */
typedef struct gtx_plane {
    double row[4], slope;
} gtx_plane;

enum { GTX_FRUSTUM_SIDES = 6 };

/* What one eye sees. */
typedef struct gtx_sides {
    gtx_plane side[GTX_FRUSTUM_SIDES]; /* inside is above 0; near, far, and four beside */
    gtx_plane w;              /* of clip space */
} gtx_sides;

typedef struct gtx_frustum {
    gtx_plane side[GTX_FRUSTUM_SIDES], w; /* of the only or first eye */
    gtx_sides other;          /* of the other, ... */
    bool two;                 /* ... if there is one */
    double eye[4];            /* object space: rays through p have the direction p * eye[3] - xyz */
    double pixels;            /* an object unit at w = 1 */
    double scale;             /* the same over the allowed error */
    int32_t level;            /* of all patches; -1: by their errors */
} gtx_frustum;

gtx_frustum gtx_frustum_of(const gtx_draw_call *draw, const gtx_model *model,
                           const gtx_instance_data *placed);

/* Of spheres: x, y, z, radius. */
static inline double gtx_plane_at(const gtx_plane *p, const float sphere[4])
{
    return p->row[0] * sphere[0] + p->row[1] * sphere[1] + p->row[2] * sphere[2] + p->row[3];
}

bool gtx_is_before_near(const gtx_frustum *f, const float sphere[4]);
bool gtx_is_outside(const gtx_frustum *f, const float sphere[4]);
/* Whether a part of it may be beside what an eye sees. */
bool gtx_is_cut(const gtx_frustum *f, const float sphere[4]);
/* The allowed error in object units, at the sphere's nearest point. */
double gtx_allowed_error(const gtx_frustum *f, const float sphere[4]);

#endif
