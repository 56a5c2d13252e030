/* Reporting of broken rules, and the checks of the header's values and of META. */
#include "asset/check.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef struct rule_row {
    uint32_t number;
    gtx_result result;
    const char *name, *sentence;
} rule_row;

static const rule_row rules[] = {
#define GTX_RULE(number, id, name, result, sentence) {number, GTX_ERROR_##result, name, sentence},
#include "asset/rules.def"
#undef GTX_RULE
};

static const rule_row *find_rule(gtx_rule rule)
{
    const rule_row *row = rules;
    while (row->number != (uint32_t)rule)
        ++row;
    return row;
}

void gtx_break(gtx_check *check, gtx_rule rule, uint64_t offset, const char *format, ...)
{
    bool first = check->broken++ == 0 && !check->failed;
    if (!first && !check->fn)
        return;
    const rule_row *row = find_rule(rule);
    char found[160], message[240];
    va_list args;
    va_start(args, format);
    vsnprintf(found, sizeof found, format, args);
    va_end(args);
    snprintf(message, sizeof message, "%s, but %s", row->sentence, found);
    if (!check->in_file)
        offset = 0;
    if (first)
        check->result = gtx_fail(check->error, row->result, "%s", message);
    if (first && check->error) {
        check->error->rule = row->number;
        check->error->rule_name = row->name;
        check->error->offset = offset;
    }
    if (check->fn)
        check->fn(&(gtx_issue){row->number, 1, offset, row->name, message}, check->user);
}

void gtx_check_fail(gtx_check *check, gtx_result result, const char *format, ...)
{
    bool first = !check->broken && !check->failed;
    check->failed = true;
    if (!first)
        return;
    char message[240];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    check->result = gtx_fail(check->error, result, "%s", message);
}

void gtx_check_limit(gtx_check *check, gtx_limited which, const char *what, uint64_t wanted,
                     uint64_t allowed)
{
    if (!check->broken && !check->failed)
        check->result = gtx_fail_limit(check->error, which, what, wanted, allowed);
    check->failed = true;
}

static void check_counts(gtx_check *check, const gtx_info *info)
{
    if (info->patch_count < 1 || info->patch_count > GTX_MAX_PATCHES)
        gtx_break(check, GTX_RULE_PATCH_COUNT, 52, "it is %u", info->patch_count);
    if (info->page_count < 1 || info->page_count > GTX_MAX_PAGES)
        gtx_break(check, GTX_RULE_PAGE_COUNT, 56, "it is %u", info->page_count);
    bool mips_known = info->mip_count >= 1 && info->mip_count <= GTX_MAX_MIPS;
    uint32_t block = mips_known ? 1u << (info->mip_count - 1) : 1;
    const uint32_t sides[] = {info->page_width, info->page_height};
    for (uint32_t i = 0; i < 2; ++i)
        if (sides[i] < 8 || sides[i] > GTX_MAX_PAGE_SIDE || sides[i] % block)
            gtx_break(check, GTX_RULE_PAGE_SIZE, 60 + 4 * i, "the page is %u x %u", sides[0],
                      sides[1]);
    if (!mips_known)
        gtx_break(check, GTX_RULE_MIP_COUNT, 68, "it is %u", info->mip_count);
}

bool gtx_check_info(gtx_check *check, const gtx_info *info)
{
    uint64_t before = check->broken;
    check_counts(check, info);
    bool usable = check->broken == before;
    for (uint32_t i = 0; i < 3; ++i) {
        float low = info->bounds_min[i], high = info->bounds_max[i];
        if (!isfinite(low))
            gtx_break(check, GTX_RULE_BOUNDS, 72 + 4 * i, "component %u is %g", i, (double)low);
        if (!isfinite(high) || high < low)
            gtx_break(check, GTX_RULE_BOUNDS, 84 + 4 * i, "component %u goes from %g to %g", i,
                      (double)low, (double)high);
    }
    if (!isfinite(info->unit) || info->unit <= 0)
        gtx_break(check, GTX_RULE_UNIT, 96, "it is %g", (double)info->unit);
    for (uint32_t i = 0; i < 3; ++i)
        if (!isfinite(info->anchor[i]))
            gtx_break(check, GTX_RULE_ANCHOR, 104 + 8 * i, "component %u is %g", i,
                      info->anchor[i]);
    return usable;
}

void gtx_check_emission(gtx_check *check, const gtx_info *info)
{
    float scale = info->emission_scale;
    bool right = info->has_emission ? isfinite(scale) && scale > 0 : scale == 0 && !signbit(scale);
    if (!right)
        gtx_break(check, GTX_RULE_EMISSION_SCALE, 144, "it is %g %s EMIT", (double)scale,
                  info->has_emission ? "with" : "without");
}

/* Length of the UTF-8 sequence at `p`, 0 when there is none (RFC 3629, section 4). */
static size_t utf8_length(const uint8_t *p, size_t left)
{
    if (p[0] < 0x80)
        return 1;
    size_t length = p[0] >= 0xF0 ? 4 : p[0] >= 0xE0 ? 3 : 2;
    if (p[0] < 0xC2 || p[0] > 0xF4 || length > left)
        return 0;
    for (size_t i = 1; i < length; ++i)
        if ((p[i] & 0xC0) != 0x80)
            return 0;
    bool overlong = (p[0] == 0xE0 && p[1] < 0xA0) || (p[0] == 0xF0 && p[1] < 0x90);
    bool surrogate = p[0] == 0xED && p[1] > 0x9F;
    bool beyond = p[0] == 0xF4 && p[1] > 0x8F;
    return overlong || surrogate || beyond ? 0 : length;
}

void gtx_check_meta(gtx_check *check, const char *meta, size_t size, uint64_t offset)
{
    const uint8_t *text = (const uint8_t *)meta;
    for (size_t i = 0, length; i < size; i += length) {
        length = utf8_length(text + i, size - i);
        if (length == 0) {
            gtx_break(check, GTX_RULE_META, offset, "byte %zu of it is no UTF-8", i);
            return;
        }
    }
}
