/* The world of a test program, and the fixtures of a group of tests that make and free it. Comes
 * after stream/host.h. */
#ifndef GTX_TESTS_STREAM_WORLD_H
#define GTX_TESTS_STREAM_WORLD_H

#include "stream/made.h"

static made_world world;

static inline int make_world(void **state)
{
    (void)state;
    made_begin(&world, false);
    return 0;
}

static inline int make_world_with_beginnings(void **state)
{
    (void)state;
    made_begin(&world, true);
    return 0;
}

static inline int free_world(void **state)
{
    (void)state;
    made_end(&world);
    return 0;
}

#endif
