/* Fragment shaders once a sample: what they are told of a pixel becomes of a sample, by decorations
 * put into their SPIR-V. Drivers need not do so by themselves where sample shading is on. */
#include "vulkan/device.h"

#include "base/alloc.h"

#include <string.h>

/* Of SPIR-V. */
enum {
    HEAD = 5, BOUND = 3, CAPABILITY = 17, VARIABLE = 59, DECORATE = 71, MEMBER_DECORATE = 72,
    INPUT = 1, FLAT = 14, SAMPLE = 17, LOCATION = 30, SAMPLE_RATE_SHADING = 35
};

/* What is known of an id. */
enum { IS_INPUT = 1, IS_FLAT = 2, HAS_LOCATION = 4 };

static uint32_t length_of(uint32_t word)
{
    return word >> 16 ? word >> 16 : 1;
}

/* Fills what is known of ids; returns where the first decoration is, 0 if there is none. */
static size_t look(const uint32_t *words, size_t count, uint8_t *known)
{
    size_t first = 0;
    for (size_t i = HEAD; i < count; i += length_of(words[i])) {
        const uint32_t op = words[i] & 0xffff;
        if (!first && (op == DECORATE || op == MEMBER_DECORATE))
            first = i;
        if (op == DECORATE && (words[i + 2] == FLAT || words[i + 2] == LOCATION))
            known[words[i + 1]] |= words[i + 2] == FLAT ? IS_FLAT : HAS_LOCATION;
        if (op == VARIABLE && words[i + 3] == INPUT)
            known[words[i + 2]] |= IS_INPUT;
    }
    return first;
}

uint32_t *gtx_vk_by_samples(const gtx_vk *vk, const uint32_t *words, size_t *bytes)
{
    enum { NEW = 3, ADDED = 2 };
    const size_t count = *bytes / sizeof *words;
    const uint32_t ids = words[BOUND];
    uint8_t *known = gtx_alloc_array(&vk->allocator, ids, 1);
    uint32_t *out = NULL;
    if (!known)
        return NULL;
    const size_t first = look(words, count, known);
    size_t inputs = 0, n = first + ADDED;
    for (uint32_t id = 0; id < ids; ++id)
        inputs += known[id] == (IS_INPUT | HAS_LOCATION);
    *bytes = (count + ADDED + NEW * inputs) * sizeof *words;
    out = first ? gtx_alloc_array(&vk->allocator, *bytes, 1) : NULL;
    if (out) {
        memcpy(out, words, HEAD * sizeof *words);
        out[HEAD] = ADDED << 16 | CAPABILITY;
        out[HEAD + 1] = SAMPLE_RATE_SHADING;
        memcpy(out + HEAD + ADDED, words + HEAD, (first - HEAD) * sizeof *words);
        for (uint32_t id = 0; id < ids; ++id)
            if (known[id] == (IS_INPUT | HAS_LOCATION)) {
                const uint32_t decoration[NEW] = {NEW << 16 | DECORATE, id, SAMPLE};
                memcpy(out + n, decoration, sizeof decoration);
                n += NEW;
            }
        memcpy(out + n, words + first, (count - first) * sizeof *words);
    }
    gtx_free_array(&vk->allocator, known, ids, 1);
    return out;
}
