/* Triangles that are picked by where they face: what facing.c needs of their order. */
#ifndef GTX_FRAME_FACING_H
#define GTX_FRAME_FACING_H

#include "frame/lod.h"

enum { GTX_CACHED_VERTICES = 64 };

/* Vertices of a group in a cache where each has one place, and how many of the corners that come
 * next are shaded. */
typedef struct gtx_face_order {
    uint16_t cached[GTX_CACHED_VERTICES];
    uint32_t ahead;
} gtx_face_order;

void gtx_face_order_begin(gtx_face_order *order);
/* Of triangles that are drawn after those before. With `turn` any corner may come first. */
void gtx_order_faces(gtx_face_order *order, gtx_lod_face *face, uint32_t count, bool turn);

#endif
