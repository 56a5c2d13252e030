/* An array of scratch that grows and does not keep what it held. */
#ifndef GTX_RENDER_SCRATCH_H
#define GTX_RENDER_SCRATCH_H

#include <geotex/geotex.h>

typedef struct gtx_scratch {
    void *data;
    size_t size;
} gtx_scratch;

/* Room of `count` x `size` bytes, or NULL. */
void *gtx_scratch_reserve(const gtx_allocator *allocator, gtx_scratch *scratch, size_t count,
                          size_t size);
void gtx_scratch_free(const gtx_allocator *allocator, gtx_scratch *scratch);

#endif
