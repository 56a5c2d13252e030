/* An upper bound on the number of cells that a ray visits, from bundles of rays against the boxes
 * of the patches.
 *
 * Directions are split into bundles, the cells of a cube map. Along axis z, say, a ray is (x, y) =
 * p + z * (u, v), with u and v in an interval of the bundle. Rays that hit a box have their p,
 * where they pass the plane through the middle of the asset, in a rectangle that grows with the
 * distance of the box from the plane. These rectangles are added up in a raster over p, each with
 * the number of cells that a ray may visit in its box; the maximum over all rasters bounds every
 * ray. */
#include "derive/crowd.h"

#include <math.h>
#include <string.h>

/* Intervals of u and v per axis, and about the number of rectangles in all. More of them lower the
 * bound of ordinary assets by some tenths, and take longer. */
enum { MAX_SPLITS = 8, EFFORT = 1 << 19 };
enum { RASTER = 32 };

typedef struct bundle {
    int axis[3];              /* of u, of v, and along which rays go */
    double slope[2], spread;  /* middle of the intervals of u and v; half their width */
} bundle;

/* A parallelepiped: its centre, and half of each edge. */
typedef struct solid {
    double centre[3], edge[3][3];
} solid;

/* The rectangle in which rays of the bundle that hit the solid pass the plane at 0. */
static void rectangle_of(const bundle *b, const solid *s, double low[2], double high[2])
{
    const int z = b->axis[2];
    for (int k = 0; k < 2; ++k) {
        const int x = b->axis[k];
        const double middle = s->centre[x] - b->slope[k] * s->centre[z];
        double reach = b->spread * fabs(s->centre[z]);
        for (int e = 0; e < 3; ++e)
            reach += fabs(s->edge[e][x] - b->slope[k] * s->edge[e][z]) +
                     b->spread * fabs(s->edge[e][z]);
        low[k] = middle - reach;
        high[k] = middle + reach;
    }
}

/* The box that rays into a patch are clipped to: a few height codes taller than its frame. */
static solid solid_of(const gtx_patch *p, const double middle[3])
{
    static const double margin = 1.05;
    const float *axes[3] = {p->axis_x, p->axis_y, p->axis_z};
    const double half[3] = {p->extent_x / 2.0, p->extent_y / 2.0, p->extent_z / 2.0};
    solid s;
    for (int k = 0; k < 3; ++k) {
        s.centre[k] = p->origin[k] - middle[k];
        for (int e = 0; e < 3; ++e) {
            s.centre[k] += half[e] * axes[e][k];
            s.edge[e][k] = half[e] * axes[e][k] * (e == 2 ? margin : 1);
        }
    }
    return s;
}

static solid solid_of_bounds(const gtx_info *info, double middle[3])
{
    solid s = {{0}, {{0}}};
    for (int k = 0; k < 3; ++k) {
        middle[k] = ((double)info->bounds_min[k] + info->bounds_max[k]) / 2;
        s.edge[k][k] = ((double)info->bounds_max[k] - info->bounds_min[k]) / 2;
    }
    return s;
}

/* Rectangles and rays beyond the raster are clamped to its border. */
static int place_of(double at, double low, double high)
{
    const double place = high > low ? (at - low) / (high - low) * RASTER : 0;
    return place > 0 ? place < RASTER ? (int)place : RASTER - 1 : 0;
}

static double fullest(double sums[RASTER + 1][RASTER + 1])
{
    double most = 0;
    for (int y = 0; y < RASTER; ++y) {
        double row = 0;
        for (int x = 0; x < RASTER; ++x) {
            row += sums[y][x];
            sums[y][x] = row + (y ? sums[y - 1][x] : 0);
            most = fmax(most, sums[y][x]);
        }
    }
    return most;
}

/* The most cells that a ray of the bundle may visit. */
static double cells_along(const gtx_asset *asset, const bundle *b)
{
    double sums[RASTER + 1][RASTER + 1], middle[3], low[2], high[2];
    const solid bounds = solid_of_bounds(&asset->info, middle);
    rectangle_of(b, &bounds, low, high);
    memset(sums, 0, sizeof sums);
    for (uint32_t i = 0; i < asset->info.patch_count; ++i) {
        const gtx_patch *p = &asset->patches[i];
        const double cells = (double)p->rect[2] + p->rect[3];
        const solid s = solid_of(p, middle);
        double first[2], last[2];
        int from[2], end[2];
        rectangle_of(b, &s, first, last);
        for (int k = 0; k < 2; ++k) {
            from[k] = place_of(first[k], low[k], high[k]);
            end[k] = place_of(last[k], low[k], high[k]) + 1;
        }
        sums[from[1]][from[0]] += cells; /* differences, which fullest() integrates */
        sums[from[1]][end[0]] -= cells;
        sums[end[1]][from[0]] -= cells;
        sums[end[1]][end[0]] += cells;
    }
    return fullest(sums);
}

uint64_t gtx_ray_cells(const gtx_asset *asset)
{
    int splits = MAX_SPLITS;
    double most = 0;
    if (!asset)
        return 0;
    while (splits > 1 && (uint64_t)asset->info.patch_count * splits * splits > EFFORT)
        splits /= 2;
    for (int i = 0; i < 3 * splits * splits; ++i) {
        const int axis = i % 3, u = i / 3 % splits, v = i / 3 / splits;
        const bundle b = {{(axis + 1) % 3, (axis + 2) % 3, axis},
                          {(2 * u + 1.0) / splits - 1, (2 * v + 1.0) / splits - 1}, 1.0 / splits};
        most = fmax(most, cells_along(asset, &b));
    }
    return (uint64_t)most;
}

gtx_result gtx_check_crowd(const gtx_asset *asset, const gtx_limits *limits, gtx_error *error)
{
    const uint64_t allowed = gtx_limit_of(limits, GTX_LIMITED_CELLS, 0);
    const uint64_t cells = allowed < UINT64_MAX ? gtx_ray_cells(asset) : 0;
    return cells > allowed ? gtx_fail_limit(error, GTX_LIMITED_CELLS, "a ray through the asset",
                                            cells, allowed)
                           : GTX_OK;
}

gtx_result gtx_check_derived(uint64_t texels, const gtx_limits *limits, const char *what,
                             uint64_t bytes, gtx_error *error)
{
    const uint64_t allowed = gtx_limit_of(limits, GTX_LIMITED_MEMORY, texels);
    return bytes > allowed ? gtx_fail_limit(error, GTX_LIMITED_MEMORY, what, bytes, allowed)
                           : GTX_OK;
}
