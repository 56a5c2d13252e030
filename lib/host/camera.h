/* An orbit camera around a bounding sphere, and the matrices it gives. */
#ifndef GTX_HOST_CAMERA_H
#define GTX_HOST_CAMERA_H

#ifdef __cplusplus
extern "C" {
#endif

/* Angles in degrees. Azimuth 0 and elevation 0 stand on +Z of the target and look at it, +Y up;
 * azimuth turns the camera towards +X, elevation raises it. `distance` counts in radii. */
typedef struct gtx_camera {
    float target[3], radius;
    float azimuth, elevation, distance;
    float field;              /* vertical; 0 = 45. Orthographic: the view is 2 radii / 0.96 high */
    int orthographic;
    int reversed_z;           /* near plane at 1, far plane at the other end */
    int zero_to_one;          /* clip z in 0..1 instead of -1..1 */
    float pan[3];             /* moves the eye and what it looks at, but not the sphere */
} gtx_camera;

/* Puts the sphere around the box low..high; leaves the angles and the distance. */
void gtx_camera_frame(gtx_camera *camera, const float low[3], const float high[3]);

/* Where the eye's x, y and z point to in the world. */
void gtx_camera_axes(const gtx_camera *camera, float right[3], float up[3], float back[3]);

/* Column-major. The near and far planes enclose the sphere as tightly as they may. `aspect` is
 * width over height. */
void gtx_camera_matrices(const gtx_camera *camera, float aspect, float view[16],
                         float projection[16]);

/* Distance along the view axis of a window depth that this projection wrote (depth range 0..1). */
float gtx_camera_distance(const float projection[16], int zero_to_one, float depth);

/* Column-major helpers for hosts: out = a * b; a transform from a position, degrees around +Y and
 * a uniform scale. */
void gtx_matrix_multiply(const float a[16], const float b[16], float out[16]);
void gtx_matrix_place(float x, float y, float z, float degrees, float scale, float out[16]);
/* Stands what fills the box low..high on `foot`, turned around +Y and scaled to a height. */
void gtx_matrix_stand(const float low[3], const float high[3], const float foot[3], float degrees,
                      float height, float out[16]);

#ifdef __cplusplus
}
#endif
#endif
