/* Assets as solids: what is inside a closed surface, how much, and solids combined: union,
 * intersection, difference (Santos, de Toledo, Gattass, "Solid Height-map Sets", SPM 2008).
 *
 * A point is inside where the surface winds around it: the generalized winding number (Jacobson,
 * Kavan, Sorkine-Hornung, SIGGRAPH 2013) is above a half. It is summed over the cells of the height
 * fields, of far ones together (Barill et al., "Fast Winding Numbers for Soups and Clouds",
 * SIGGRAPH 2018). Where patches overlap, each counts by its depth inside its outline, so that
 * overlap counts once. A gap between patches, or a hole in the source, shifts the number by the
 * share of the view that it takes and no more: beside small gaps insides stay right.
 *
 * An asset does not say whether its source was closed; it is measured, as `openness`. The rules of
 * geotex.h hold here too. */
#ifndef GEOTEX_SOLID_H
#define GEOTEX_SOLID_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An asset prepared for questions about its inside. Immutable; any number of threads may ask at
 * once. Keeps no reference to the asset. */
typedef struct gtx_solid gtx_solid;

typedef struct gtx_solid_desc {
    const gtx_allocator *allocator;
    const gtx_jobs *jobs;         /* used during the call */
    gtx_limits limits;            /* memory, cells and work, of which a million steps take some
                                     0.2 s; texels count as bytes read */
    float max_openness;           /* 0..1: more is refused; 0 = 0.01 */
    uint32_t reserved[5];
} gtx_solid_desc;

typedef struct gtx_solid_facts {
    double volume;                /* object units cubed; of parts that lie in each other twice */
    double area;                  /* object units squared */
    /* Share of 1024 points, spread evenly over the bounds, at which no whole number >= 0 is within
     * 1/4 of the winding number: whether they are inside is in doubt. 0 for closed surfaces that
     * face outwards; 1/3 for half a sphere. */
    double openness;
} gtx_solid_facts;

/* Prepares an asset: some 100 bytes per texel, from the descriptor's allocator, that
 * gtx_solid_destroy frees. `desc` may be NULL.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, EMPTY (no cell shows), INPUT (the surface is more
 * open than max_openness, or faces inwards; the message tells how much). */
GTX_API gtx_result gtx_solid_create(const gtx_asset *asset, const gtx_solid_desc *desc,
                                    gtx_solid **out, gtx_error *error);
/* NULL is fine. */
GTX_API void gtx_solid_destroy(gtx_solid *solid);

/* Copied to *out; zeros for NULL. */
GTX_API void gtx_solid_measure(const gtx_solid *solid, gtx_solid_facts *out);

/* How often the surface winds around each point, relative to the asset's anchor: close to 1 inside
 * and 0 outside, a half on the surface. NaN for a point that is not finite. Takes no memory, and
 * some microseconds a point. Errors: ARGUMENT. */
GTX_API gtx_result gtx_solid_winding(const gtx_solid *solid, const float (*points)[3],
                                     float *numbers, size_t count);

/* 1 for points inside, where the winding number is above a half, else 0. Errors: ARGUMENT. */
GTX_API gtx_result gtx_solid_inside(const gtx_solid *solid, const float (*points)[3],
                                    uint8_t *inside, size_t count);

/* ---- combining -------------------------------------------------------------------------- */

typedef enum gtx_combine_op {
    GTX_COMBINE_UNION = 0,        /* what is inside a or b */
    GTX_COMBINE_INTERSECT = 1,    /* inside both */
    GTX_COMBINE_SUBTRACT = 2      /* inside a, and not b */
} gtx_combine_op;

typedef struct gtx_combine_desc {
    gtx_combine_op op;
    float max_openness;           /* of either asset, as for gtx_solid_desc */
    const gtx_allocator *allocator;   /* for the new asset too */
    const gtx_jobs *jobs;         /* used during the call */
    gtx_limits limits;            /* memory and cells of either asset; work; patches */
    uint32_t reserved[6];
} gtx_combine_desc;

/* Patches of a first, then of b. */
typedef struct gtx_combine_result {
    uint32_t whole[2], cut[2], dropped[2];
    gtx_solid_facts facts[2];
    /* The surface of the result is that of a and b but for its ends, where the two cross: those are
     * within this distance of the crossing, object units. 0 when nothing was cut. What one asset
     * has between the texels of the other, and thinner than these, may be missed. */
    double error;
} gtx_combine_result;

/* Makes an asset of the parts of two assets' surfaces that bound their union, intersection or
 * difference. Heights, normals and looks stay as they are; trims get a new outline where the
 * surfaces cross, to a sixteenth of a texel; patches of b that bound a hollow are turned round.
 * Where the surfaces coincide, within a quarter of a texel and 11 degrees, one of them is kept if
 * they face the same way, and for a difference if they do not; none otherwise. Coordinates are
 * those of object space, whatever the anchors; the result has a's anchor and unit, the greater
 * height_bits and the smaller mip_count of both, and every map that one of them has: what the other
 * lacks is filled with its constant. LOD meshes stay behind: gtx_cook_lod_meshes makes them. The
 * same assets and options give the same bytes.
 * `desc` and `result` may be NULL; gtx_close frees the asset.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, INPUT (an asset is open; the units differ), EMPTY
 * (nothing is left). */
GTX_API gtx_result gtx_combine(const gtx_asset *a, const gtx_asset *b, const gtx_combine_desc *desc,
                               gtx_asset **out, gtx_combine_result *result, gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
