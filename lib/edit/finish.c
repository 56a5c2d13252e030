/* The results of an edit: a new asset, or updates of one that is being drawn. */
#include "edit/edit.h"

#include "asset/section.h"
#include "base/alloc.h"
#include "base/error.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* An asset with the edit's maps and none of their texels. Levels of an LOD mesh are those of the
 * surface as it was, and stay behind. NULL when memory is out. */
static gtx_asset *new_asset(const gtx_edit *edit, const gtx_info *info, const gtx_patch *patches)
{
    const gtx_asset *source = edit->source;
    gtx_info bare = *info;
    bare.lod_levels = 0;
    bare.content_hash = bare.file_size = 0;
    const gtx_sizes sizes = {.meta = source->meta_size};
    gtx_asset *asset = gtx_asset_new(&edit->allocator, &bare, &sizes, true);
    if (!asset)
        return NULL;
    memcpy(asset->patches, patches, bare.patch_count * sizeof *patches);
    if (source->meta_size)
        memcpy(asset->meta, source->meta, source->meta_size);
    return asset;
}

/* Grows a box around a patch's texels with a code. */
static void grow_box(const gtx_asset *asset, const gtx_patch *patch, float low[3], float high[3])
{
    const uint32_t w = patch->rect[2], h = patch->rect[3], bits = asset->info.height_bits;
    for (uint32_t t = 0; t < w * h; ++t) {
        const uint32_t code = gtx_height_code(asset, patch, t % w, t / w);
        double point[3];
        if (!code)
            continue;
        gtx_texel_point(patch, t % w, t / w, gtx_code_height(code, bits), point);
        for (int k = 0; k < 3; ++k) {
            low[k] = fminf(low[k], (float)point[k]);
            high[k] = fmaxf(high[k], (float)point[k]);
        }
    }
}

void gtx_edit_write_bounds(gtx_asset *asset)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t p = 0; p < asset->info.patch_count; ++p)
        grow_box(asset, &asset->patches[p], low, high);
    for (int k = 0; k < 3 && low[0] <= high[0]; ++k) {
        asset->info.bounds_min[k] = low[k];
        asset->info.bounds_max[k] = high[k];
    }
}

/* The rectangle that a patch needs: its own while it fits. */
static gtx_window choose_window(const gtx_edit *edit, uint32_t patch)
{
    const uint16_t *rect = edit->source->patches[patch].rect;
    const uint32_t grain = 1u << (edit->source->info.mip_count - 1);
    const gtx_window same = {.low = {0, 0}, .size = {rect[2], rect[3]}};
    if (!edit->fields[patch].moved)
        return same;
    gtx_window window = gtx_edit_window(edit, &edit->fields[patch]);
    for (int a = 0; a < 2; ++a) {
        const int64_t end = (int64_t)window.low[a] + window.size[a];
        if (!window.size[a] || (window.low[a] >= 0 && end <= same.size[a])) {
            window.low[a] = 0;
            window.size[a] = same.size[a];
        }
        window.size[a] = (window.size[a] + grain - 1) / grain * grain;
    }
    return window;
}

/* An asset whose texels are tiny beside an edit would grow without end. */
static const uint64_t MAX_GROWTH = 16, MIN_ROOM = 1 << 20;

/* Records with the windows' sizes, placed on pages. */
static gtx_result lay_out(const gtx_edit *edit, gtx_window *windows, gtx_patch *patches,
                          gtx_info *info, gtx_error *error)
{
    bool grown = false;
    uint64_t texels = 0, most = MIN_ROOM;
    for (uint32_t p = 0; p < edit->count; ++p) {
        most += MAX_GROWTH * patches[p].rect[2] * patches[p].rect[3];
        windows[p] = choose_window(edit, p);
        for (int a = 0; a < 2; ++a) {
            if (windows[p].size[a] > GTX_MAX_PAGE_SIDE / 2)
                return gtx_fail(error, GTX_ERROR_LIMIT, "patch %u would be %u texels wide", p,
                                windows[p].size[a]);
            grown |= patches[p].rect[2 + a] != windows[p].size[a];
            patches[p].rect[2 + a] = (uint16_t)windows[p].size[a];
        }
        texels += (uint64_t)windows[p].size[0] * windows[p].size[1];
    }
    if (texels > most)
        return gtx_fail(error, GTX_ERROR_LIMIT, "the edited surface takes %" PRIu64
                        " texels, %" PRIu64 " times as many as before or more", texels,
                        MAX_GROWTH);
    return grown ? gtx_edit_place(patches, &edit->allocator, info, error) : GTX_OK;
}

gtx_result gtx_edit_copy_checked(const gtx_asset *asset, gtx_asset **out, gtx_error *error)
{
    const gtx_info *info = &asset->info;
    gtx_asset_desc desc = {
        .patches = asset->patches, .patch_count = info->patch_count,
        .page_count = info->page_count, .page_width = info->page_width,
        .page_height = info->page_height, .mip_count = info->mip_count,
        .height_bits = info->height_bits, .height = asset->height, .trim = asset->trim,
        .normal = (const uint8_t *const *)asset->normal, .meta = asset->meta,
        .meta_size = asset->meta_size, .emission_scale = info->emission_scale, .unit = info->unit,
        .source_triangles = info->source_triangles, .allocator = &asset->allocator};
    if (info->has_color)
        desc.color = (const uint8_t *const *)asset->color;
    if (info->has_material)
        desc.material = (const uint8_t *const *)asset->material;
    if (info->has_emission)
        desc.emission = (const uint8_t *const *)asset->emission;
    memcpy(desc.bounds_min, info->bounds_min, sizeof desc.bounds_min);
    memcpy(desc.bounds_max, info->bounds_max, sizeof desc.bounds_max);
    memcpy(desc.anchor, info->anchor, sizeof desc.anchor);
    gtx_error broken;
    const gtx_result result = gtx_create(&desc, out, &broken);
    if (result == GTX_ERROR_CORRUPT)
        return gtx_fail(error, GTX_ERROR_LIMIT, "no asset can hold the edited surface: %.170s",
                        broken.message);
    if (result && error)
        *error = broken;
    return result;
}

void gtx_edit_fill_far(gtx_asset *asset)
{
    const gtx_info *info = &asset->info;
    memset(asset->trim, 255, (size_t)info->page_count * info->page_width * info->page_height);
    for (uint32_t k = 0; k < info->mip_count; ++k)
        memset(asset->normal[k], 128, 2 * info->page_count * gtx_page_texels(asset, k));
}

static gtx_result write_all(const gtx_edit *edit, const gtx_window *windows, gtx_asset *asset,
                            gtx_error *error)
{
    gtx_result result = GTX_OK;
    gtx_edit_fill_far(asset);
    for (uint32_t p = 0; !result && p < edit->count; ++p)
        if (edit->fields[p].moved)
            result = gtx_edit_write_patch(edit, p, &windows[p], asset, error);
        else
            gtx_edit_copy_patch(edit, p, asset);
    gtx_edit_write_bounds(asset);
    return result;
}

gtx_result gtx_edit_finish(const gtx_edit *edit, gtx_asset **out, gtx_error *error)
{
    if (!edit || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "finishing needs an edit");
    const gtx_allocator *hooks = &edit->allocator;
    gtx_info info = edit->source->info;
    gtx_window *windows = gtx_alloc_array(hooks, edit->count, sizeof *windows);
    gtx_patch *patches = gtx_alloc_array(hooks, edit->count, sizeof *patches);
    gtx_asset *asset = NULL;
    gtx_result result = GTX_OK;
    if (!windows || !patches) {
        result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory for %u patches", edit->count);
    } else {
        memcpy(patches, edit->source->patches, edit->count * sizeof *patches);
        result = lay_out(edit, windows, patches, &info, error);
    }
    if (!result) {
        asset = new_asset(edit, &info, patches);
        result = asset ? write_all(edit, windows, asset, error)
                       : gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the edited maps");
    }
    if (!result)
        result = gtx_edit_copy_checked(asset, out, error);
    gtx_close(asset);
    gtx_free_array(hooks, windows, edit->count, sizeof *windows);
    gtx_free_array(hooks, patches, edit->count, sizeof *patches);
    return result;
}

static gtx_result begin_live(gtx_edit *edit, gtx_error *error)
{
    edit->live = new_asset(edit, &edit->source->info, edit->source->patches);
    if (!edit->live)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the maps that are drawn");
    gtx_edit_fill_far(edit->live);
    for (uint32_t p = 0; p < edit->count; ++p)
        gtx_edit_copy_patch(edit, p, edit->live);
    return GTX_OK;
}

gtx_result gtx_edit_refresh(gtx_edit *edit, const gtx_asset **asset, const uint32_t **patches,
                            uint32_t *count, gtx_error *error)
{
    if (!edit || !asset || !patches || !count)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a refresh needs an edit and its results");
    gtx_result result = edit->live ? GTX_OK : begin_live(edit, error);
    if (result)
        return result;
    uint32_t changed = 0;
    for (uint32_t p = 0; p < edit->count; ++p) {
        if (edit->fields[p].shown)
            continue;
        const uint16_t *rect = edit->source->patches[p].rect;
        const gtx_window window = {.low = {0, 0}, .size = {rect[2], rect[3]}};
        result = gtx_edit_write_patch(edit, p, &window, edit->live, error);
        if (result)
            return result;
        edit->changed[changed++] = p;
    }
    /* Only now: a call that failed is repeated from its beginning. */
    for (uint32_t i = 0; i < changed; ++i)
        edit->fields[edit->changed[i]].shown = true;
    /* Bounds grow only: there is no time to look at the other patches. */
    for (uint32_t i = 0; i < changed; ++i)
        grow_box(edit->live, &edit->live->patches[edit->changed[i]], edit->live->info.bounds_min,
                 edit->live->info.bounds_max);
    *asset = edit->live;
    *patches = edit->changed;
    *count = changed;
    return GTX_OK;
}
