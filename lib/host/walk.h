/* An eye that walks or flies: moves the camera that otherwise orbits. */
#ifndef GTX_HOST_WALK_H
#define GTX_HOST_WALK_H

#include "host/camera.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The eye stays where it is, and from now on the angles turn the view about it: distance is 0. */
void gtx_walk_begin(gtx_camera *camera);

/* The camera orbits again: what is `distance` radii in front of the eye. */
void gtx_walk_end(gtx_camera *camera, float distance);

void gtx_walk_eye(const gtx_camera *camera, float eye[3]);

/* Moves the eye by lengths to the right, up (+Y) and forward: where it looks, or with `level`
 * nearest to that along the ground. */
void gtx_walk_move(gtx_camera *camera, const float steps[3], int level);

/* Brings the eye to `height` above the ground, which is at y = `ground`: most of the way within a
 * tenth of a second, but a quarter of the height at once. */
void gtx_walk_stand(gtx_camera *camera, float ground, float height, float seconds);

#ifdef __cplusplus
}
#endif
#endif
