/* Memory through the caller's hooks. */
#include "base/alloc.h"

#include "base/bytes.h"

#include <stdlib.h>
#include <string.h>

static void *default_alloc(size_t size, void *user)
{
    (void)user;
    return malloc(size);
}

static void default_free(void *memory, size_t size, void *user)
{
    (void)size;
    (void)user;
    free(memory);
}

gtx_allocator gtx_allocator_or_default(const gtx_allocator *allocator)
{
    if (allocator && allocator->alloc && allocator->free)
        return *allocator;
    return (gtx_allocator){default_alloc, default_free, NULL};
}

void *gtx_alloc_raw(const gtx_allocator *allocator, size_t count, size_t size)
{
    uint64_t bytes;
    if (!gtx_mul_u64(count, size, &bytes) || bytes == 0 || bytes > SIZE_MAX)
        return NULL;
    return allocator->alloc((size_t)bytes, allocator->user);
}

void *gtx_alloc_array(const gtx_allocator *allocator, size_t count, size_t size)
{
    void *memory = gtx_alloc_raw(allocator, count, size);
    if (memory)
        memset(memory, 0, count * size);
    return memory;
}

void gtx_free_array(const gtx_allocator *allocator, void *memory, size_t count, size_t size)
{
    if (memory)
        allocator->free(memory, count * size, allocator->user);
}
