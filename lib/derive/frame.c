/* Grid space and object space of a patch, and inverses of affine maps. */
#include "derive/frame.h"

void gtx_invert_affine(double (*map)[4], double (*out)[4])
{
    double cofactor[3][3], det = 0;
    for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 3; ++k) {
            const int k1 = (k + 1) % 3, k2 = (k + 2) % 3, r1 = (r + 1) % 3, r2 = (r + 2) % 3;
            cofactor[r][k] = map[k1][r1] * map[k2][r2] - map[k2][r1] * map[k1][r2];
        }
    for (int k = 0; k < 3; ++k)
        det += map[k][0] * cofactor[0][k];
    for (int r = 0; r < 3; ++r) {
        out[r][3] = 0;
        for (int k = 0; k < 3; ++k) {
            out[r][k] = cofactor[r][k] / det;
            out[r][3] -= out[r][k] * map[k][3];
        }
    }
}

gtx_patch_frame gtx_patch_frame_of(const gtx_patch *patch, uint32_t height_bits)
{
    const float *unit[3] = {patch->axis_x, patch->axis_y, patch->axis_z};
    const double step[3] = {(double)patch->extent_x / patch->rect[2],
                            (double)patch->extent_y / patch->rect[3],
                            patch->extent_z / (height_bits == 8 ? 254.0 : 65534.0)};
    gtx_patch_frame f;
    double to_object[3][4];
    for (int k = 0; k < 3; ++k) {
        for (int a = 0; a < 3; ++a)
            to_object[k][a] = f.axis[a][k] = step[a] * unit[a][k];
        /* Texel 0 lies half a texel inside the rectangle, and height 0 has code 1. */
        f.origin[k] = patch->origin[k] + 0.5 * f.axis[0][k] + 0.5 * f.axis[1][k] - f.axis[2][k];
        to_object[k][3] = f.origin[k];
    }
    gtx_invert_affine(to_object, f.to_grid);
    return f;
}
