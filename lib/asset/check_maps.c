/* Heights against patches: coverage, spheres, bounds, and that nothing lies outside rectangles. */
#include "asset/check.h"

#include "base/bytes.h"

#include <math.h>

#define COVERAGE_TOLERANCE 1e-4
#define SPHERE_TOLERANCE 1e-3
#define BOUNDS_TOLERANCE 1e-4

/* The box that points must lie in. */
typedef struct box {
    double low[3], high[3];
} box;

/* Without bounds that hold, which was told before, nothing is outside. */
static box grown_bounds(const gtx_info *info)
{
    double diagonal = 0;
    for (int i = 0; i < 3; ++i) {
        if (!isfinite(info->bounds_min[i]) || !isfinite(info->bounds_max[i]) ||
            info->bounds_max[i] < info->bounds_min[i])
            return (box){{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
        double side = (double)info->bounds_max[i] - info->bounds_min[i];
        diagonal += side * side;
    }
    double slack = BOUNDS_TOLERANCE * sqrt(diagonal);
    box out;
    for (int i = 0; i < 3; ++i) {
        out.low[i] = info->bounds_min[i] - slack;
        out.high[i] = info->bounds_max[i] + slack;
    }
    return out;
}

static void texel_point(const gtx_patch *patch, double u, double v, double h, double out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = patch->origin[i] + u * patch->extent_x * patch->axis_x[i] +
                 v * patch->extent_y * patch->axis_y[i] + h * patch->extent_z * patch->axis_z[i];
}

static bool in_sphere(const gtx_patch *patch, const double point[3])
{
    double square = 0;
    for (int i = 0; i < 3; ++i)
        square += (point[i] - patch->sphere[i]) * (point[i] - patch->sphere[i]);
    double radius = patch->sphere[3] * (1 + SPHERE_TOLERANCE);
    return square <= radius * radius;
}

static bool in_box(const box *bounds, const double point[3])
{
    for (int i = 0; i < 3; ++i)
        if (!(point[i] >= bounds->low[i] && point[i] <= bounds->high[i]))
            return false;
    return true;
}

/* What a walk over the texels of a patch finds. */
typedef struct patch_finding {
    uint64_t coded;
    bool outside_sphere, outside_bounds;
    double sphere_point[3], bounds_point[3];
} patch_finding;

static inline uint64_t count_codes(const uint8_t *row, uint32_t bytes, uint32_t width)
{
    enum { MAX_COUNT = UINT8_MAX };    /* that bytes can count, for vectors of them */
    uint64_t coded = 0;
    for (uint32_t x = 0; x < width;) {
        const uint32_t end = width - x > MAX_COUNT ? x + MAX_COUNT : width;
        uint8_t count = 0;
        for (; x < end; ++x)
            count = (uint8_t)(count + ((bytes == 1 ? row[x] : row[2 * x] | row[2 * x + 1]) != 0));
        coded += count;
    }
    return coded;
}

/* What points are checked against. */
typedef struct limits {
    const gtx_patch *patch;
    const box *bounds;
    double levels;                /* of heights above the lowest */
    /* For a first look, in floats: the box and the square of the radius, somewhat less than they
     * are, around the sphere's centre; what a texel and a code add to a point. */
    bool quick;
    float low[3], high[3], square, along_x[3], along_z[3];
} limits;

/* Floats tell for points that are as far away as the limits, and not much further. */
static limits limits_of(const gtx_patch *patch, const box *bounds, double levels)
{
    limits in = {.patch = patch, .bounds = bounds, .levels = levels};
    const double size[3] = {patch->extent_x, patch->extent_y, patch->extent_z};
    double reach = 0, diagonal = 0, radius = patch->sphere[3] * (1 + SPHERE_TOLERANCE / 2);
    for (int i = 0; i < 3; ++i) {
        const double slack = 0.25 * BOUNDS_TOLERANCE * (bounds->high[i] - bounds->low[i]);
        in.low[i] = (float)(bounds->low[i] + slack - patch->sphere[i]);
        in.high[i] = (float)(bounds->high[i] - slack - patch->sphere[i]);
        in.along_x[i] = (float)(patch->extent_x * patch->axis_x[i] / patch->rect[2]);
        in.along_z[i] = (float)(patch->extent_z * patch->axis_z[i] / levels);
        reach += size[i] + fabs((double)patch->origin[i] - patch->sphere[i]);
        diagonal += bounds->high[i] - bounds->low[i];
    }
    in.square = (float)(radius * radius);
    in.quick = isfinite(in.square) && reach < 16 * radius && reach < 16 * diagonal;
    return in;
}

/* Whether no point of a row of texels is near a limit, or beyond. */
static inline bool is_clear(const limits *limit, const uint8_t *row, uint32_t bytes, uint32_t y)
{
    const limits in = *limit;
    const gtx_patch *p = in.patch;
    double first[3];
    float from[3];
    texel_point(p, 0.5 / p->rect[2], (y + 0.5) / p->rect[3], -1 / in.levels, first);
    for (int i = 0; i < 3; ++i)
        from[i] = (float)(first[i] - p->sphere[i]);
    int beyond = 0;
    for (int32_t x = 0; x < p->rect[2]; ++x) {
        const int32_t code = bytes == 1       ? row[x]
                             : GTX_BIG_ENDIAN ? row[2 * x] << 8 | row[2 * x + 1]
                                              : row[2 * x] | row[2 * x + 1] << 8;
        const float u = (float)x, h = (float)code;
        const float a = from[0] + u * in.along_x[0] + h * in.along_z[0];
        const float b = from[1] + u * in.along_x[1] + h * in.along_z[1];
        const float c = from[2] + u * in.along_x[2] + h * in.along_z[2];
        const int out = (a * a + b * b + c * c > in.square) | (a < in.low[0]) | (a > in.high[0]) |
                        (b < in.low[1]) | (b > in.high[1]) | (c < in.low[2]) | (c > in.high[2]);
        beyond |= out & (code != 0);
    }
    return in.quick && !beyond;
}

static void look_at(const limits *in, uint32_t x, uint32_t y, uint32_t code, patch_finding *found)
{
    const gtx_patch *patch = in->patch;
    double point[3];
    texel_point(patch, (x + 0.5) / patch->rect[2], (y + 0.5) / patch->rect[3],
                (code - 1) / in->levels, point);
    if (!found->outside_sphere && !in_sphere(patch, point)) {
        found->outside_sphere = true;
        memcpy(found->sphere_point, point, sizeof point);
    }
    if (!found->outside_bounds && !in_box(in->bounds, point)) {
        found->outside_bounds = true;
        memcpy(found->bounds_point, point, sizeof point);
    }
}

static patch_finding walk_patch(const gtx_asset *asset, const gtx_patch *patch, const box *bounds)
{
    const uint32_t bytes = asset->info.height_bits / 8, width = patch->rect[2];
    const limits in = limits_of(patch, bounds, gtx_height_steps(8 * bytes));
    patch_finding found = {0};
    for (uint32_t y = 0; y < patch->rect[3]; ++y) {
        const size_t line = (size_t)patch->page * asset->info.page_height + patch->rect[1] + y;
        const uint8_t *row =
            asset->height + (line * asset->info.page_width + patch->rect[0]) * bytes;
        found.coded += bytes == 1 ? count_codes(row, 1, width) : count_codes(row, 2, width);
        if (bytes == 1 ? is_clear(&in, row, 1, y) : is_clear(&in, row, 2, y))
            continue;
        for (uint32_t x = 0; x < width; ++x) {
            const uint32_t code = gtx_height_code(asset, patch, x, y);
            if (code)
                look_at(&in, x, y, code, &found);
        }
    }
    return found;
}

static bool finite_frame(const gtx_patch *patch)
{
    double sum = (double)patch->coverage + patch->sphere[3]; /* of floats: it cannot overflow */
    sum += (double)patch->extent_x + patch->extent_y + patch->extent_z;
    for (int i = 0; i < 3; ++i)
        sum += (double)patch->origin[i] + patch->axis_x[i] + patch->axis_y[i] + patch->axis_z[i] +
               patch->sphere[i];
    return isfinite(sum);
}

static void check_patch(gtx_check *check, const gtx_asset *asset, uint32_t index, const box *bounds,
                        uint64_t offset)
{
    const gtx_patch *patch = &asset->patches[index];
    if (!finite_frame(patch)) /* told before */
        return;
    patch_finding found = walk_patch(asset, patch, bounds);
    double share = (double)found.coded / ((double)patch->rect[2] * patch->rect[3]);
    if (fabs(share - patch->coverage) > COVERAGE_TOLERANCE)
        gtx_break(check, GTX_RULE_PATCH_COVERAGE, offset + 60, "patch %u says %g and has %g", index,
                  (double)patch->coverage, share);
    const double *p = found.sphere_point;
    if (found.outside_sphere && patch->sphere[3] > 0)
        gtx_break(check, GTX_RULE_PATCH_SPHERE, offset + 80,
                  "patch %u has a point at (%g, %g, %g)", index, p[0], p[1], p[2]);
    p = found.bounds_point;
    if (found.outside_bounds)
        gtx_break(check, GTX_RULE_PATCH_BOUNDS, offset, "patch %u has a point at (%g, %g, %g)",
                  index, p[0], p[1], p[2]);
}

/* Whether a rectangle lies in block x of a line of blocks. */
static bool occupied(const gtx_occupancy *occupancy, uint64_t line, uint32_t x)
{
    uint64_t bit = line * occupancy->width + x;
    return occupancy->words[bit / 64] >> bit % 64 & 1;
}

/* The first texel of a page with a code outside every rectangle; false when there is none. */
static bool find_outside(const gtx_asset *asset, const gtx_occupancy *occupancy, uint32_t page,
                         uint32_t *out_x, uint32_t *out_y)
{
    const size_t width = asset->info.page_width, height = asset->info.page_height;
    const size_t bytes = asset->info.height_bits / 8, block = bytes << occupancy->shift;
    for (uint32_t y = 0; y < height; ++y) {
        const uint64_t line = (uint64_t)page * occupancy->height + (y >> occupancy->shift);
        const uint8_t *row = asset->height + (page * height + y) * width * bytes;
        for (uint32_t x = 0; x < occupancy->width; ++x) {
            if (occupied(occupancy, line, x))
                continue;
            for (size_t i = x * block; i < (x + 1) * block; ++i)
                if (row[i]) {
                    *out_x = (uint32_t)(i / bytes);
                    *out_y = y;
                    return true;
                }
        }
    }
    return false;
}

bool gtx_patch_holds(const gtx_asset *asset, uint32_t index)
{
    gtx_check quiet = {0};
    const box bounds = grown_bounds(&asset->info);
    check_patch(&quiet, asset, index, &bounds, 0);
    return quiet.broken == 0;
}

void gtx_check_maps(gtx_check *check, const gtx_asset *asset, const gtx_occupancy *occupancy,
                    const uint8_t *holds, const gtx_map_places *places)
{
    const gtx_info *info = &asset->info;
    box bounds = grown_bounds(info);
    for (uint32_t i = 0; i < info->patch_count; ++i)
        if (!holds || !holds[i])
            check_patch(check, asset, i, &bounds, places->patches + sizeof(gtx_patch) * i);
    for (uint32_t page = 0; page < info->page_count; ++page) {
        uint32_t x, y;
        if (!find_outside(asset, occupancy, page, &x, &y))
            continue;
        uint64_t texel = ((uint64_t)page * info->page_height + y) * info->page_width + x;
        uint64_t within = places->height_stored ? texel * (info->height_bits / 8) : 0;
        gtx_break(check, GTX_RULE_HEIGHT_OUTSIDE, places->height + within,
                  "page %u has a code at (%u, %u)", page, x, y);
    }
}
