/* Normals in two bytes: hemi-octahedral coordinates in a patch's own frame. */
#include "asset/patch.h"

#include "base/vec.h"

static uint8_t to_unorm(float v)
{
    float code = floorf(128.0f + 127.5f * v);
    return code > 255 ? 255 : code > 0 ? (uint8_t)code : 0; /* NaN ends at 0 */
}

/* The octahedron's upper half is a diamond; turned by 45 degrees it fills the square. */
void gtx_encode_normal(const float n[3], uint8_t out[2])
{
    float z = n[2] > 0 ? n[2] : 0;
    float sum = fabsf(n[0]) + fabsf(n[1]) + z;
    float x = sum > 0 ? n[0] / sum : 0;
    float y = sum > 0 ? n[1] / sum : 0;
    out[0] = to_unorm(x + y);
    out[1] = to_unorm(x - y);
}

void gtx_decode_normal(const uint8_t in[2], float n[3])
{
    float a = (float)in[0] / 127.5f - 1, b = (float)in[1] / 127.5f - 1;
    float x = (a + b) / 2, y = (a - b) / 2;
    gtx_v3_store(n, gtx_v3_normalize(gtx_v3(x, y, 1 - fabsf(x) - fabsf(y))));
}

void gtx_normal_frame(const gtx_patch *patch, float rows[3][3])
{
    gtx_vec3 z = gtx_v3_load(patch->axis_z), axis_x = gtx_v3_load(patch->axis_x);
    gtx_vec3 x = gtx_v3_normalize(gtx_v3_mad(axis_x, z, -gtx_v3_dot(axis_x, z)));
    gtx_v3_store(rows[0], x);
    gtx_v3_store(rows[1], gtx_v3_cross(z, x));
    gtx_v3_store(rows[2], z);
}
