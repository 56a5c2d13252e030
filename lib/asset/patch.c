/* The frame of a patch, and the fields of its record that follow from its height codes. */
#include "asset/patch.h"

#include "base/bytes.h"

/* Whose points are computed together; a whole patch's may not fit. */
enum { COLUMNS = 64 };

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
    const double extent[3] = {patch->extent_x, patch->extent_y, patch->extent_z};
    const double steps[3] = {patch->rect[2], patch->rect[3], gtx_height_steps(height_bits)};
    gtx_patch_frame f;
    double to_object[3][4];
    for (int k = 0; k < 3; ++k) {
        for (int a = 0; a < 3; ++a)
            to_object[k][a] = f.axis[a][k] = unit[a][k] * extent[a] / steps[a];
        /* Texel 0 lies half a texel inside the rectangle, and height 0 has code 1. */
        f.origin[k] = patch->origin[k] + (f.axis[0][k] + f.axis[1][k]) / 2 - f.axis[2][k];
        to_object[k][3] = f.origin[k];
    }
    gtx_invert_affine(to_object, f.to_grid);
    return f;
}

static uint32_t code_at(const gtx_code_map *codes, uint32_t x, uint32_t y)
{
    const uint8_t *at = (const uint8_t *)codes->first + (y * codes->width + x) * codes->bytes;
    return codes->bytes == 1 ? at[0] : gtx_load_own_u16(at);
}

static void include_point(gtx_patch_span *span, const double point[3])
{
    for (int k = 0; k < 3; ++k) {
        span->low[k] = point[k] < span->low[k] ? point[k] : span->low[k];
        span->high[k] = point[k] > span->high[k] ? point[k] : span->high[k];
    }
    ++span->coded;
}

static double square_to(const double point[3], const float centre[3])
{
    double square = 0;
    for (int k = 0; k < 3; ++k)
        square += (point[k] - centre[k]) * (point[k] - centre[k]);
    return square;
}

/* Points of columns x to x + count - 1: their bounds, or the largest square of a distance to the
 * sphere's centre. Rounds as gtx_texel_point does. */
static void measure_columns(const gtx_patch *patch, const gtx_code_map *codes, uint32_t x,
                            uint32_t count, gtx_patch_span *span, double *square)
{
    double along[COLUMNS][3];
    for (uint32_t i = 0; i < count; ++i) {
        const double a = (x + i + 0.5) / patch->rect[2] * patch->extent_x;
        for (int k = 0; k < 3; ++k)
            along[i][k] = patch->origin[k] + a * patch->axis_x[k];
    }
    for (uint32_t y = 0; y < patch->rect[3]; ++y) {
        const double b = (y + 0.5) / patch->rect[3] * patch->extent_y;
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t code = code_at(codes, x + i, y);
            if (!code)
                continue;
            const double c = gtx_code_height(code, codes->height_bits) * patch->extent_z;
            double point[3];
            for (int k = 0; k < 3; ++k)
                point[k] = along[i][k] + b * patch->axis_y[k] + c * patch->axis_z[k];
            if (span) {
                include_point(span, point);
            } else {
                const double of_point = square_to(point, patch->sphere);
                *square = of_point > *square ? of_point : *square;
            }
        }
    }
}

gtx_patch_span gtx_measure_patch(gtx_patch *patch, const gtx_code_map *codes)
{
    const uint32_t w = patch->rect[2], h = patch->rect[3];
    gtx_patch_span span = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0};
    double square = 0;
    for (int pass = 0; pass < 2; ++pass) {
        for (uint32_t x = 0; x < w; x += COLUMNS)
            measure_columns(patch, codes, x, w - x < COLUMNS ? w - x : COLUMNS,
                            pass ? NULL : &span, &square);
        for (int k = 0; k < 3 && span.coded; ++k)
            patch->sphere[k] = (float)((span.low[k] + span.high[k]) / 2);
    }
    patch->coverage = (float)((double)span.coded / ((double)w * h));
    if (span.coded)
        patch->sphere[3] = fmaxf((float)(sqrt(square) * (1 + 1e-6)), 1e-30f);
    return span;
}
