/* Small vectors and column-major 4x4 matrices in float, for the C rooms. */
#ifndef GTX_BASE_VEC_H
#define GTX_BASE_VEC_H

#include <math.h>

typedef struct gtx_vec3 {
    float x, y, z;
} gtx_vec3;

static inline gtx_vec3 gtx_v3(float x, float y, float z)
{
    gtx_vec3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}

static inline gtx_vec3 gtx_v3_load(const float *p)
{
    return gtx_v3(p[0], p[1], p[2]);
}

static inline void gtx_v3_store(float *p, gtx_vec3 v)
{
    p[0] = v.x;
    p[1] = v.y;
    p[2] = v.z;
}

static inline gtx_vec3 gtx_v3_add(gtx_vec3 a, gtx_vec3 b)
{
    return gtx_v3(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline gtx_vec3 gtx_v3_sub(gtx_vec3 a, gtx_vec3 b)
{
    return gtx_v3(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline gtx_vec3 gtx_v3_scale(gtx_vec3 a, float s)
{
    return gtx_v3(a.x * s, a.y * s, a.z * s);
}

/* a + b * s */
static inline gtx_vec3 gtx_v3_mad(gtx_vec3 a, gtx_vec3 b, float s)
{
    return gtx_v3(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}

static inline float gtx_v3_dot(gtx_vec3 a, gtx_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline gtx_vec3 gtx_v3_cross(gtx_vec3 a, gtx_vec3 b)
{
    return gtx_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline float gtx_v3_length(gtx_vec3 a)
{
    return sqrtf(gtx_v3_dot(a, a));
}

/* The zero vector stays zero. */
static inline gtx_vec3 gtx_v3_normalize(gtx_vec3 a)
{
    float length = gtx_v3_length(a);
    return length > 0 ? gtx_v3_scale(a, 1 / length) : a;
}

#endif
