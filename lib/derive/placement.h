/* Transforms of instances, for rays on the CPU and in shaders. */
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

/* How far off an asset's surface rays begin that must not meet its ripples, in object units: two of
 * its height steps, for a height field rounds the surface by half a step up or down, or the 32nd
 * part of a texel, which is how far its cells cut into what is as round as 4 texels. Of the
 * coarsest patch. */
double gtx_ray_offset(const gtx_asset *asset);

#ifdef __cplusplus
}
#endif
#endif
