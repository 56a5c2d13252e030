/* Where instances stand in the world, for rays on the CPU and in shaders. */
#ifndef GTX_DERIVE_PLACEMENT_H
#define GTX_DERIVE_PLACEMENT_H

#include "derive/hierarchy.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gtx_placement {
    double world[3][4], object[3][4];  /* rows of object -> world, and of the inverse */
    double stretch;                    /* no vector gets longer by more */
} gtx_placement;

/* From a column-major matrix; false when it is not finite and affine, or has no inverse. */
bool gtx_placement_of(const float transform[16], gtx_placement *out);

/* The world's box around an object's, rounded outwards; of an empty one an empty one. */
gtx_box gtx_placement_box(const gtx_placement *placement, const gtx_box *object);

/* The greatest height step of an asset, in object units. */
double gtx_height_step(const gtx_asset *asset);

#ifdef __cplusplus
}
#endif
#endif
