/* Edits of an asset that anyone may have made, with numbers of any size. */
#include "fuzz/fuzz.hpp"

#include <geotex/edit.h>

#include <algorithm>
#include <cmath>

namespace fuzz {

/* The errors that edit.h lists; ARGUMENT only where numbers ask for it. */
static void listed(const char *call, const gtx_error &error, gtx_result more)
{
    REQUIRE(error.result == GTX_OK || error.result == GTX_ERROR_ARGUMENT ||
                error.result == GTX_ERROR_MEMORY || error.result == more,
            "%s: %d, rule %u: %s", call, error.result, error.rule, error.message);
}

static void lift(const gtx_edit_field *field, void *user)
{
    const float by = *static_cast<float *>(user);
    for (uint32_t i = 0; i < field->width * field->height; ++i)
        for (int k = 0; k < 3 && field->kind[i] == GTX_TEXEL_OWN; ++k)
            field->point[i][k] += by * field->normal[i][k];
}

static float size_of(const gtx_edit *edit, Random &random)
{
    static const float some[] = {0.1f, 0.5f, 1, 1.5f, 3, 10};
    return random.chance(16) ? random.number()
                            : gtx_edit_texel_size(edit) * some[random.below(6)];
}

static void blur(gtx_edit *edit, Random &random)
{
    gtx_error error = {};
    gtx_edit_blur how = {};
    how.flags = random.below(4);
    how.radius = how.flags & GTX_EDIT_WORLD ? size_of(edit, random)
                 : random.chance(4) ? random.number() : 0.3f + random.unit() * 3;
    if (random.chance(2))
        gtx_edit_gaussian(edit, &how, &error);
    else
        gtx_edit_high_boost(edit, &how, random.chance(4) ? random.number() : 2, &error);
    listed("blur", error, GTX_ERROR_LIMIT);
}

static void stamp(gtx_edit *edit, const gtx_info &info, Random &random)
{
    gtx_error error = {};
    gtx_edit_stamp_desc how = {};
    for (int k = 0; k < 3; ++k) {
        how.centre[k] = info.bounds_min[k] + (info.bounds_max[k] - info.bounds_min[k]) *
                                                 random.unit();
        how.direction[k] = random.unit() - 0.5f;
        how.up[k] = random.chance(3) ? random.number() : 0;
    }
    how.radius = size_of(edit, random);
    how.depth = size_of(edit, random);
    gtx_edit_stamp(edit, &how, &error);
    listed("stamp", error, GTX_OK);
}

static void set_heights(gtx_edit *edit, const gtx_asset *asset, const gtx_info &info,
                        Random &random)
{
    gtx_error error = {};
    const uint32_t patch = random.below(info.patch_count);
    const uint16_t *rect = gtx_patches(asset)[patch].rect;
    const uint32_t x = random.below(rect[2]), y = random.below(rect[3]);
    const uint32_t rectangle[4] = {x, y, std::min(rect[2] - x, 4u), std::min(rect[3] - y, 4u)};
    float heights[16];
    const bool wild = random.chance(4);
    for (float &height : heights)
        height = wild ? random.number() : random.unit() * 2 - 0.5f;
    gtx_edit_set_heights(edit, patch, rectangle, heights, &error);
    listed("set heights", error, GTX_OK);
}

static void pattern(gtx_edit *edit, Random &random)
{
    gtx_error error = {};
    const float values[4] = {0, 1, 0.5f, random.number()};
    const gtx_edit_image image = {values, 2, 2};
    gtx_edit_pattern(edit, &image, size_of(edit, random), size_of(edit, random), &error);
    listed("pattern", error, GTX_OK);
}

static void refresh(gtx_edit *edit, const gtx_info &info)
{
    gtx_error error = {};
    const gtx_asset *live = nullptr;
    const uint32_t *patches = nullptr;
    uint32_t count = 0;
    if (gtx_edit_refresh(edit, &live, &patches, &count, &error))
        return listed("refresh", error, GTX_OK);
    for (uint32_t i = 0; i < count; ++i)
        REQUIRE(patches[i] < info.patch_count, "patch %u is refreshed", patches[i]);
    round_trip(live, false, "what was refreshed");
}

void edit_asset(const gtx_asset *asset, uint64_t how)
{
    Random random(how);
    gtx_info info;
    gtx_get_info(asset, &info);
    Counted memory;
    const gtx_allocator hooks = memory.hooks();
    gtx_edit_desc desc = {};
    desc.allocator = &hooks;
    gtx_edit *edit = nullptr;
    gtx_error error = {};
    if (gtx_edit_begin(asset, &desc, &edit, &error))
        return REQUIRE(error.result == GTX_ERROR_EMPTY, "edit: %d %s", error.result,
                       error.message);
    for (uint32_t n = random.below(3); n < 4; ++n) {
        float by = size_of(edit, random);
        switch (random.below(6)) {
        case 0: blur(edit, random); break;
        case 1: stamp(edit, info, random); break;
        case 2: set_heights(edit, asset, info, random); break;
        case 3: pattern(edit, random); break;
        case 4: refresh(edit, info); break;
        default:
            error = {};
            gtx_edit_apply(edit, lift, &by, &error);
            listed("apply", error, GTX_OK);
        }
    }
    gtx_asset *out = nullptr;
    error = {};
    if (gtx_edit_finish(edit, &out, &error))
        listed("finish", error, GTX_ERROR_LIMIT);
    else
        round_trip(out, true, "what was edited");
    gtx_close(out);
    gtx_edit_end(edit);
}

} // namespace fuzz
