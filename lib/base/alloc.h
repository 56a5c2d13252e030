/* Memory through the caller's hooks, and a budget over it. */
#ifndef GTX_BASE_ALLOC_H
#define GTX_BASE_ALLOC_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The hooks to keep in an object: *allocator, or malloc and free when it is NULL or empty. */
gtx_allocator gtx_allocator_or_default(const gtx_allocator *allocator);

/* `count` x `size` bytes, zeroed; NULL when the product overflows, when it is zero, or when memory
 * is out. */
void *gtx_alloc_array(const gtx_allocator *allocator, size_t count, size_t size);

/* The same, not zeroed, for what is written before it is read. */
void *gtx_alloc_raw(const gtx_allocator *allocator, size_t count, size_t size);

/* Gives back what either returned for (allocator, count, size). NULL is fine. */
void gtx_free_array(const gtx_allocator *allocator, void *memory, size_t count, size_t size);

#ifdef __cplusplus
}
#endif
#endif
