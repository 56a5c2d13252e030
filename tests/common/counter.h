/* Memory hooks that fail one allocation, and count what is not given back. Needs cmocka before
 * it. */
#ifndef GTX_TESTS_COUNTER_H
#define GTX_TESTS_COUNTER_H

#include <stdlib.h>

typedef struct counter {
    long until_failure;       /* allocations that go well before; below 0: all do */
    long bytes;
} counter;

static inline void *counted_alloc(size_t size, void *user)
{
    counter *c = user;
    if (c->until_failure-- == 0)
        return NULL;
    size_t *block = malloc(size + 16); /* the size in front: it must come back */
    assert_non_null(block);
    *block = size;
    c->bytes += (long)size;
    return (char *)block + 16;
}

static inline void counted_free(void *memory, size_t size, void *user)
{
    size_t *block = (size_t *)((char *)memory - 16);
    assert_int_equal(*block, size);
    ((counter *)user)->bytes -= (long)size;
    free(block);
}

#endif
