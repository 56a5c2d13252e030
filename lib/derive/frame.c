/* Grid space and object space of a patch. */
#include "derive/frame.h"

/* Rows of the inverse of grid -> object. */
static void invert(gtx_patch_frame *f)
{
    double cross[3][3], det = 0;
    for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 3; ++k) {
            const double *a = f->axis[(r + 1) % 3], *b = f->axis[(r + 2) % 3];
            cross[r][k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        }
    for (int k = 0; k < 3; ++k)
        det += f->axis[0][k] * cross[0][k];
    for (int r = 0; r < 3; ++r) {
        f->to_grid[r][3] = 0;
        for (int k = 0; k < 3; ++k) {
            f->to_grid[r][k] = cross[r][k] / det;
            f->to_grid[r][3] -= f->to_grid[r][k] * f->origin[k];
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
    for (int k = 0; k < 3; ++k) {
        for (int a = 0; a < 3; ++a)
            f.axis[a][k] = step[a] * unit[a][k];
        /* Texel 0 lies half a texel inside the rectangle, and height 0 has code 1. */
        f.origin[k] = patch->origin[k] + 0.5 * f.axis[0][k] + 0.5 * f.axis[1][k] - f.axis[2][k];
    }
    invert(&f);
    return f;
}
