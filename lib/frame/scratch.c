/* Scratch that lives from draw to draw. */
#include "frame/scratch.h"

#include "base/alloc.h"

#include <string.h>

void *gtx_scratch_reserve(const gtx_allocator *allocator, gtx_scratch *scratch, size_t count,
                          size_t size)
{
    const size_t wanted = count * size;
    if (wanted <= scratch->size && scratch->data)
        return scratch->data;
    gtx_scratch_free(allocator, scratch);
    const size_t room = wanted + wanted / 2 + 64;
    scratch->data = gtx_alloc_array(allocator, room, 1);
    scratch->size = scratch->data ? room : 0;
    return scratch->data;
}

bool gtx_scratch_grow(const gtx_allocator *allocator, gtx_scratch *scratch, size_t count,
                      size_t size)
{
    if (count * size <= scratch->size)
        return true;
    gtx_scratch old = *scratch;
    *scratch = (gtx_scratch){0};
    if (!gtx_scratch_reserve(allocator, scratch, count, size)) {
        *scratch = old;
        return false;
    }
    if (old.data)
        memcpy(scratch->data, old.data, old.size);
    gtx_scratch_free(allocator, &old);
    return true;
}

void gtx_scratch_free(const gtx_allocator *allocator, gtx_scratch *scratch)
{
    gtx_free_array(allocator, scratch->data, scratch->size, 1);
    *scratch = (gtx_scratch){0};
}
