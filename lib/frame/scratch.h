/* Arrays of scratch that grow. */
#ifndef GTX_FRAME_SCRATCH_H
#define GTX_FRAME_SCRATCH_H

#include <geotex/geotex.h>
#include <stdbool.h>

typedef struct gtx_scratch {
    void *data;
    size_t size;
} gtx_scratch;

/* Room of `count` x `size` bytes, or NULL; what is there may go. */
void *gtx_scratch_reserve(const gtx_allocator *allocator, gtx_scratch *scratch, size_t count,
                          size_t size);
/* The same, and what is there stays. False without memory. */
bool gtx_scratch_grow(const gtx_allocator *allocator, gtx_scratch *scratch, size_t count,
                      size_t size);
void gtx_scratch_free(const gtx_allocator *allocator, gtx_scratch *scratch);

#endif
