/* Assets that keep every rule and are mad: patches stacked in one place, gauze that no ray hits. */
#ifndef GTX_TESTS_MAD_H
#define GTX_TESTS_MAD_H

#include <geotex/geotex.h>

typedef enum mad_place {
    MAD_STACK,                  /* all patches over the unit square, hardly apart */
    MAD_SHEET                   /* side by side over it, in rows */
} mad_place;

typedef enum mad_field {
    MAD_GAUZE,                  /* waves, inside the outline at every other texel and nowhere
                                   between: cells exist, and rays go through */
    MAD_RIDGES,                 /* such gauze in high folds, with one spike in a valley: hulls are
                                   thick, and a ray leaves and enters them again and again */
    MAD_NEEDLES                 /* a checkerboard of the lowest and the highest code, as high as the
                                   patch is wide */
} mad_field;

/* `count` two-sided patches of side x side texels; gtx_close frees the asset. Ends the program when
 * it breaks a rule. */
gtx_asset *mad_asset(uint32_t count, uint32_t side, mad_place place, mad_field field);

#endif
