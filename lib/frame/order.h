/* A stable radix sort by floats. */
#ifndef GTX_FRAME_ORDER_H
#define GTX_FRAME_ORDER_H

#include <stddef.h>
#include <stdint.h>

/* A float as an unsigned key of the same order, and the index of what it belongs to. */
typedef struct gtx_rank {
    uint32_t key, place;
} gtx_rank;

gtx_rank gtx_rank_of(float value, uint32_t place);
/* Stable, least first. `room` is scratch for as many. */
void gtx_order(gtx_rank *ranks, gtx_rank *room, size_t count);

#endif
