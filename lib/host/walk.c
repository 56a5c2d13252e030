/* Walking and flying, as changes of an orbit camera whose distance is 0. */
#include "host/walk.h"

#include "base/vec.h"

static gtx_vec3 axis_of(const gtx_camera *camera, int which)
{
    float axis[3][3];
    gtx_camera_axes(camera, axis[0], axis[1], axis[2]);
    return gtx_v3_load(axis[which]);
}

static void retreat(gtx_camera *camera, float length)
{
    const gtx_vec3 pan = gtx_v3_load(camera->pan);
    gtx_v3_store(camera->pan, gtx_v3_mad(pan, axis_of(camera, 2), length));
}

void gtx_walk_begin(gtx_camera *camera)
{
    retreat(camera, camera->distance * camera->radius);
    camera->distance = 0;
}

void gtx_walk_end(gtx_camera *camera, float distance)
{
    retreat(camera, -distance * camera->radius);
    camera->distance = distance;
}

void gtx_walk_eye(const gtx_camera *camera, float eye[3])
{
    const gtx_vec3 target = gtx_v3_load(camera->target), pan = gtx_v3_load(camera->pan);
    gtx_v3_store(eye, gtx_v3_mad(gtx_v3_add(target, pan), axis_of(camera, 2),
                                 camera->distance * camera->radius));
}

void gtx_walk_move(gtx_camera *camera, const float steps[3], int level)
{
    const gtx_vec3 right = axis_of(camera, 0), up = gtx_v3(0, 1, 0);
    const gtx_vec3 ahead = level ? gtx_v3_cross(up, right)
                                 : gtx_v3_scale(axis_of(camera, 2), -1);
    gtx_vec3 pan = gtx_v3_mad(gtx_v3_load(camera->pan), right, steps[0]);
    pan = gtx_v3_mad(gtx_v3_mad(pan, up, steps[1]), ahead, steps[2]);
    gtx_v3_store(camera->pan, pan);
}

void gtx_walk_stand(gtx_camera *camera, float ground, float height, float seconds)
{
    const float pace = 20;    /* a second: of what is left */
    float eye[3];
    gtx_walk_eye(camera, eye);
    const float wanted = ground + height, least = ground + height / 4;
    const float next = wanted + (eye[1] - wanted) * expf(-pace * seconds);
    camera->pan[1] += fmaxf(next, least) - eye[1];
}
