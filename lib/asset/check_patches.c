/* Patch records: frames, rectangles, and that no two rectangles of a page overlap. */
#include "asset/check.h"

#include "base/alloc.h"

#include <math.h>

#define UNIT_TOLERANCE 1e-3
#define MIN_DETERMINANT 0.099
#define MIN_DEPTH (0.999 / 4096)

static double dot(const float a[3], const float b[3])
{
    return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

static double determinant(const gtx_patch *p)
{
    const float *x = p->axis_x, *y = p->axis_y, *z = p->axis_z;
    return ((double)x[1] * y[2] - (double)x[2] * y[1]) * z[0] +
           ((double)x[2] * y[0] - (double)x[0] * y[2]) * z[1] +
           ((double)x[0] * y[1] - (double)x[1] * y[0]) * z[2];
}

/* The floats of a record are its first 16 words and the sphere. */
static bool check_finite(gtx_check *check, const gtx_patch *patch, uint32_t index, uint64_t offset)
{
    const float *values[] = {patch->origin, patch->axis_x, patch->axis_y, patch->axis_z,
                             patch->sphere};
    const uint32_t offsets[] = {0, 16, 32, 48, 80};
    const float fourth[] = {patch->extent_x, patch->extent_y, patch->extent_z, patch->coverage,
                            patch->sphere[3]};
    for (uint32_t row = 0; row < 5; ++row) {
        for (uint32_t i = 0; i < 4; ++i) {
            float value = i < 3 ? values[row][i] : fourth[row];
            if (isfinite(value))
                continue;
            gtx_break(check, GTX_RULE_PATCH_FINITE, offset + offsets[row] + 4 * i,
                      "patch %u has %g", index, (double)value);
            return false;
        }
    }
    return true;
}

static void check_frame(gtx_check *check, const gtx_patch *patch, uint32_t index, uint64_t offset)
{
    double ex = patch->extent_x, ey = patch->extent_y, ez = patch->extent_z;
    if (ex <= 0)
        gtx_break(check, GTX_RULE_PATCH_EXTENT, offset + 12, "extent_x of patch %u is %g", index,
                  ex);
    if (ey <= 0)
        gtx_break(check, GTX_RULE_PATCH_EXTENT, offset + 28, "extent_y of patch %u is %g", index,
                  ey);
    if (ez <= 0 || ez < MIN_DEPTH * fmax(ex, ey))
        gtx_break(check, GTX_RULE_PATCH_EXTENT, offset + 44, "extent_z of patch %u is %g", index,
                  ez);

    const float *axes[] = {patch->axis_x, patch->axis_y, patch->axis_z};
    for (uint32_t i = 0; i < 3; ++i) {
        double length = sqrt(dot(axes[i], axes[i]));
        if (fabs(length - 1) > UNIT_TOLERANCE)
            gtx_break(check, GTX_RULE_PATCH_AXIS_UNIT, offset + 16 * (i + 1),
                      "axis_%c of patch %u has length %g", "xyz"[i], index, length);
    }
    double det = determinant(patch);
    if (det < MIN_DETERMINANT)
        gtx_break(check, GTX_RULE_PATCH_HANDEDNESS, offset + 16, "that of patch %u is %g", index,
                  det);
    if (patch->sphere[3] <= 0)
        gtx_break(check, GTX_RULE_PATCH_SPHERE, offset + 92, "the radius of patch %u is %g", index,
                  (double)patch->sphere[3]);
}

/* False when the rectangle does not lie on a page. */
static bool check_rectangle(gtx_check *check, const gtx_info *info, const gtx_patch *patch,
                            uint32_t index, uint64_t offset)
{
    bool usable = true;
    if (patch->page >= info->page_count) {
        gtx_break(check, GTX_RULE_PATCH_PAGE, offset + 64, "patch %u is on page %u of %u", index,
                  patch->page, info->page_count);
        usable = false;
    }
    uint32_t x = patch->rect[0], y = patch->rect[1], w = patch->rect[2], h = patch->rect[3];
    uint32_t block_mask = (1u << (info->mip_count - 1)) - 1;
    if (w < 2 || h < 2 || x + w > info->page_width || y + h > info->page_height ||
        (x | y | w | h) & block_mask) {
        gtx_break(check, GTX_RULE_PATCH_RECTANGLE, offset + 68, "patch %u has %u x %u at %u, %u",
                  index, w, h, x, y);
        usable = false;
    }
    return usable;
}

static bool check_record(gtx_check *check, const gtx_info *info, const gtx_patch *patch,
                         uint32_t index, uint64_t offset)
{
    if (check_finite(check, patch, index, offset))
        check_frame(check, patch, index, offset);
    bool usable = check_rectangle(check, info, patch, index, offset);
    if (patch->flags & ~GTX_PATCH_TWO_SIDED)
        gtx_break(check, GTX_RULE_PATCH_FLAGS, offset + 78, "patch %u has 0x%04x", index,
                  (unsigned)patch->flags);
    for (uint32_t i = 0; i < 7; ++i) {
        if (patch->reserved[i]) {
            gtx_break(check, GTX_RULE_PATCH_RESERVED, offset + 100 + 4 * i, "patch %u has 0x%08x",
                      index, patch->reserved[i]);
            break;
        }
    }
    return usable;
}

static gtx_occupancy occupancy_shape(const gtx_info *info)
{
    gtx_occupancy shape = {.shift = info->mip_count - 1,
                           .width = info->page_width >> (info->mip_count - 1),
                           .height = info->page_height >> (info->mip_count - 1)};
    uint64_t blocks = (uint64_t)info->page_count * shape.width * shape.height;
    shape.word_count = (size_t)((blocks + 63) / 64);
    return shape;
}

uint64_t gtx_occupancy_size(const gtx_info *info)
{
    return (uint64_t)occupancy_shape(info).word_count * sizeof(uint64_t);
}

void gtx_occupancy_free(gtx_occupancy *occupancy, const gtx_allocator *allocator)
{
    gtx_free_array(allocator, occupancy->words, occupancy->word_count, sizeof(uint64_t));
    *occupancy = (gtx_occupancy){0};
}

/* Sets `count` bits from `first` on; false when one was set already. */
static bool claim_bits(uint64_t *words, uint64_t first, uint64_t count)
{
    while (count) {
        uint64_t bit = first % 64, take = 64 - bit < count ? 64 - bit : count;
        uint64_t mask = (take == 64 ? UINT64_MAX : ((uint64_t)1 << take) - 1) << bit;
        if (words[first / 64] & mask)
            return false;
        words[first / 64] |= mask;
        first += take;
        count -= take;
    }
    return true;
}

/* Marking stops at the first block that is taken, so that all rectangles together cost no more
 * than the pages have blocks. */
static bool claim_rectangle(const gtx_occupancy *occupancy, const gtx_patch *patch)
{
    uint32_t shift = occupancy->shift;
    uint32_t x = patch->rect[0] >> shift, y = patch->rect[1] >> shift;
    uint32_t w = patch->rect[2] >> shift, h = patch->rect[3] >> shift;
    for (uint32_t row = 0; row < h; ++row) {
        uint64_t line = (uint64_t)patch->page * occupancy->height + y + row;
        if (!claim_bits(occupancy->words, line * occupancy->width + x, w))
            return false;
    }
    return true;
}

void gtx_check_patches(gtx_check *check, const gtx_asset *asset, uint64_t offset,
                       gtx_occupancy *out)
{
    const gtx_info *info = &asset->info;
    bool usable = true;
    *out = (gtx_occupancy){0};
    for (uint32_t i = 0; i < info->patch_count; ++i)
        if (!check_record(check, info, &asset->patches[i], i, offset + sizeof(gtx_patch) * i))
            usable = false;
    if (!usable || gtx_check_over(check))
        return;

    gtx_occupancy occupancy = occupancy_shape(info);
    occupancy.words = gtx_alloc_array(&asset->allocator, occupancy.word_count, sizeof(uint64_t));
    if (!occupancy.words) {
        gtx_check_fail(check, GTX_ERROR_MEMORY, "out of memory while checking rectangles");
        return;
    }
    for (uint32_t i = 0; i < info->patch_count; ++i) {
        if (claim_rectangle(&occupancy, &asset->patches[i]))
            continue;
        gtx_break(check, GTX_RULE_PATCH_OVERLAP, offset + sizeof(gtx_patch) * i + 68,
                  "patch %u overlaps one before it", i);
        usable = false;
    }
    if (usable)
        *out = occupancy;
    else
        gtx_occupancy_free(&occupancy, &asset->allocator);
}
