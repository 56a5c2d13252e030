/* An order by floats. */
#ifndef GTX_RENDER_ORDER_H
#define GTX_RENDER_ORDER_H

#include <stddef.h>
#include <stdint.h>

/* What is put in order: a float's bits, so that they count as the float does, and whose it is. */
typedef struct gtx_rank {
    uint32_t key, place;
} gtx_rank;

gtx_rank gtx_rank_of(float value, uint32_t place);
/* Least first; equal ones stay as they are. `room` is for as many. */
void gtx_order(gtx_rank *ranks, gtx_rank *room, size_t count);

#endif
