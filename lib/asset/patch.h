/* The meaning of a patch's codes and record (format/gtx.md, sections 3 and 4). */
#ifndef GTX_ASSET_PATCH_H
#define GTX_ASSET_PATCH_H

#include <geotex/geotex.h>

#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- heights: code 0 is empty, code c >= 1 is c - 1 steps high ---- */

/* Height steps in extent_z. */
static inline double gtx_height_steps(uint32_t height_bits)
{
    return height_bits == 8 ? 254 : 65534;
}

/* One step in object units. */
static inline double gtx_height_step(const gtx_patch *patch, uint32_t height_bits)
{
    return patch->extent_z / gtx_height_steps(height_bits);
}

/* The height of a code >= 1, or between codes, as a fraction of extent_z. */
static inline double gtx_code_height(double code, uint32_t height_bits)
{
    return (code - 1) / gtx_height_steps(height_bits);
}

/* The code nearest to so many steps. */
static inline uint32_t gtx_nearest_code(double steps, uint32_t height_bits)
{
    const double most = gtx_height_steps(height_bits), code = floor(steps + 0.5);
    return 1 + (uint32_t)(code > 0 ? code < most ? code : most : 0);
}

/* ---- trim: signed distances in texels from the outline, positive outside ---- */

/* As in shaders/geotex_records.glsl. */
#define GTX_TRIM_OUTLINE 128             /* the outline's code */
#define GTX_TRIM_TEXEL 16                /* codes per texel */
#define GTX_TRIM_SHOWN 0.3               /* a point belongs to the surface up to this distance */

static inline double gtx_trim_distance(double code)
{
    return (code - GTX_TRIM_OUTLINE) / GTX_TRIM_TEXEL;
}

static inline uint8_t gtx_nearest_trim(float distance)
{
    const float code = floorf(GTX_TRIM_OUTLINE + GTX_TRIM_TEXEL * distance + 0.5f);
    return (uint8_t)(code > 0 ? code < 255 ? code : 255 : 0);
}

/* The greatest code, or value between codes, that shows at a level of detail: its cells are 2^level
 * texels wide, and the limit grows with them (section 5). */
static inline double gtx_trim_limit(uint32_t level)
{
    return GTX_TRIM_OUTLINE + GTX_TRIM_TEXEL * GTX_TRIM_SHOWN * (1u << level);
}

/* ---- normals, in the patch's normal frame ---- */

/* Rows of the frame in object space: x', y', z'. */
void gtx_normal_frame(const gtx_patch *patch, float rows[3][3]);

/* Hemi-octahedral: n is a unit vector in that frame with n[2] >= 0. */
void gtx_encode_normal(const float n[3], uint8_t out[2]);
void gtx_decode_normal(const uint8_t in[2], float n[3]);

/* Octahedral, of any direction, as the vertices of LOD meshes have them: lod_normals.c. Of any
 * length, and back to a unit vector. */
void gtx_encode_octahedral(const float n[3], uint8_t out[2]);
void gtx_decode_octahedral(const uint8_t in[2], float n[3]);

/* ---- the record ---- */

/* The point of texel (x, y), or between texels, at a fraction of extent_z. */
static inline void gtx_texel_point(const gtx_patch *patch, double x, double y, double height,
                                   double out[3])
{
    const double a = (x + 0.5) / patch->rect[2] * patch->extent_x;
    const double b = (y + 0.5) / patch->rect[3] * patch->extent_y;
    const double c = height * patch->extent_z;
    for (int k = 0; k < 3; ++k)
        out[k] = patch->origin[k] + a * patch->axis_x[k] + b * patch->axis_y[k] +
                 c * patch->axis_z[k];
}

/* The patch's grid space: texels in x and y (texel i at x = i), height codes in z. */
typedef struct gtx_patch_frame {
    double axis[3][3], origin[3]; /* object = origin + x axis[0] + y axis[1] + z axis[2] */
    double to_grid[3][4];         /* rows of the inverse: linear part and translation */
} gtx_patch_frame;

/* Does not normalise the axes. */
gtx_patch_frame gtx_patch_frame_of(const gtx_patch *patch, uint32_t height_bits);

/* Inverts an affine map, given as three rows of linear part and translation. A singular one gives
 * numbers that are not finite. */
void gtx_invert_affine(double (*map)[4], double (*out)[4]);

/* The height codes of a patch in memory. */
typedef struct gtx_code_map {
    const void *first;            /* of texel (0, 0) */
    size_t width;                 /* texels from one row to the next */
    uint32_t bytes;               /* per code: 1, or 2 */
    uint32_t height_bits;
} gtx_code_map;

/* Bounds and number of the texels with a code. */
typedef struct gtx_patch_span {
    double low[3], high[3];       /* of their points; low is above high when there are none */
    uint64_t coded;
} gtx_patch_span;

/* Sets coverage and sphere; a patch without a code keeps its sphere. */
gtx_patch_span gtx_measure_patch(gtx_patch *patch, const gtx_code_map *codes);

#ifdef __cplusplus
}
#endif
#endif
