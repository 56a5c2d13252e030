/* An orbit camera: view and projection matrices for every clip convention. */
#include "host/camera.h"

#include "base/vec.h"

#include <string.h>

#define RADIANS(degrees) ((degrees) * 3.14159265358979f / 180.0f)

void gtx_matrix_multiply(const float a[16], const float b[16], float out[16])
{
    float r[16];
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) {
            float sum = 0;
            for (int k = 0; k < 4; ++k)
                sum += a[4 * k + row] * b[4 * column + k];
            r[4 * column + row] = sum;
        }
    memcpy(out, r, sizeof r);
}

void gtx_matrix_place(float x, float y, float z, float degrees, float scale, float out[16])
{
    const float c = scale * cosf(RADIANS(degrees)), s = scale * sinf(RADIANS(degrees));
    const float m[16] = {c, 0, -s, 0, 0, scale, 0, 0, s, 0, c, 0, x, y, z, 1};
    memcpy(out, m, sizeof m);
}

void gtx_camera_frame(gtx_camera *camera, const float low[3], const float high[3])
{
    const gtx_vec3 half = gtx_v3_scale(gtx_v3_sub(gtx_v3_load(high), gtx_v3_load(low)), 0.5f);
    gtx_v3_store(camera->target, gtx_v3_add(gtx_v3_load(low), half));
    camera->radius = gtx_v3_length(half);
}

void gtx_camera_axes(const gtx_camera *camera, float right[3], float up[3], float back[3])
{
    const float az = RADIANS(camera->azimuth), el = RADIANS(camera->elevation);
    const gtx_vec3 z = gtx_v3(sinf(az) * cosf(el), sinf(el), cosf(az) * cosf(el));
    /* Taken from the angles, not from a cross product: defined at the poles too. */
    const gtx_vec3 x = gtx_v3(cosf(az), 0, -sinf(az));
    gtx_v3_store(right, x);
    gtx_v3_store(up, gtx_v3_cross(z, x));
    gtx_v3_store(back, z);
}

/* Returns how far in front of the eye the centre of the sphere is. */
static float look(const gtx_camera *camera, float view[16])
{
    float axis[3][3];
    gtx_camera_axes(camera, axis[0], axis[1], axis[2]);
    const gtx_vec3 target = gtx_v3_load(camera->target), pan = gtx_v3_load(camera->pan);
    const gtx_vec3 back = gtx_v3_load(axis[2]);
    const float along = camera->distance * camera->radius;
    const gtx_vec3 eye = gtx_v3_mad(gtx_v3_add(target, pan), back, along);
    memset(view, 0, 16 * sizeof *view);
    for (int row = 0; row < 3; ++row) {
        for (int k = 0; k < 3; ++k)
            view[4 * k + row] = axis[row][k];
        view[12 + row] = -gtx_v3_dot(gtx_v3_load(axis[row]), eye);
    }
    view[15] = 1;
    return along + gtx_v3_dot(pan, back);
}

void gtx_camera_matrices(const gtx_camera *camera, float aspect, float view[16],
                         float projection[16])
{
    const float along = look(camera, view), reach = 1.01f * camera->radius;
    const float least = 0.002f * camera->radius; /* of a near plane that rays meet in the eye */
    const float near = camera->orthographic ? along - reach : fmaxf(along - reach, least);
    const float far = camera->orthographic ? along + reach : fmaxf(along + reach, 2 * least);
    /* Depth d at the near plane and at the far plane, in clip units. */
    const float low = camera->zero_to_one ? 0.0f : -1.0f;
    const float dn = camera->reversed_z ? 1.0f : low, df = camera->reversed_z ? low : 1.0f;
    memset(projection, 0, 16 * sizeof *projection);
    if (camera->orthographic) {
        const float scale = 0.96f / camera->radius;
        projection[0] = aspect < 1 ? scale : scale / aspect;
        projection[5] = aspect < 1 ? scale * aspect : scale;
        projection[10] = (dn - df) / (far - near);
        projection[14] = (dn * far - df * near) / (far - near);
        projection[15] = 1;
    } else {
        const float scale = 1 / tanf(RADIANS(camera->field > 0 ? camera->field : 45.0f) / 2);
        projection[0] = scale / aspect;
        projection[5] = scale;
        projection[10] = (dn * near - df * far) / (far - near);
        projection[14] = (dn - df) * near * far / (far - near);
        projection[11] = -1;
    }
}

float gtx_camera_distance(const float projection[16], int zero_to_one, float depth)
{
    const float z = zero_to_one ? depth : 2 * depth - 1;
    /* z = (p10 e + p14) / (p11 e + p15) with e the eye's z, solved for -e. */
    return (projection[14] - z * projection[15]) / (projection[10] - z * projection[11]);
}

void gtx_matrix_stand(const float low[3], const float high[3], const float foot[3], float degrees,
                      float height, float out[16])
{
    float center[16], there[16];
    gtx_matrix_place(-(low[0] + high[0]) / 2, -low[1], -(low[2] + high[2]) / 2, 0, 1, center);
    gtx_matrix_place(foot[0], foot[1], foot[2], degrees, height / (high[1] - low[1]), there);
    gtx_matrix_multiply(there, center, out);
}
