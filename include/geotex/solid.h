/* Closed assets as solids: inside tests, volumes, and union, intersection and difference (Santos,
 * de Toledo, Gattass, "Solid Height-map Sets", SPM 2008).
 *
 * A point is inside where the generalized winding number of the surface (Jacobson, Kavan,
 * Sorkine-Hornung, SIGGRAPH 2013) is above one half. The number is summed over the cells of the
 * height fields, with distant cells grouped (Barill et al., "Fast Winding Numbers for Soups and
 * Clouds", SIGGRAPH 2018). Overlapping patches are weighted by depth inside their outlines, so that
 * overlap counts once. A gap between patches or a hole in the source changes the number by the
 * solid angle that it subtends, as a fraction of the sphere: near small gaps the answer stays
 * right.
 *
 * An asset does not record whether its source was closed; `openness` measures it. The rules of
 * geotex.h apply here too. */
#ifndef GEOTEX_SOLID_H
#define GEOTEX_SOLID_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An asset prepared for inside tests. Keeps no reference to the asset. Immutable; any number of
 * threads may use it at once. */
typedef struct gtx_solid gtx_solid;

typedef struct gtx_solid_desc {
    const gtx_allocator *allocator;
    const gtx_jobs *jobs;         /* used during the call */
    gtx_limits limits;            /* of memory, cells and work (a million steps take some 0.2 s);
                                     texels count as bytes read */
    float max_openness;           /* 0..1: assets above it are refused; 0 = 0.01 */
    uint32_t reserved[5];
} gtx_solid_desc;

typedef struct gtx_solid_facts {
    double volume;                /* cubic object units; where parts of the surface enclose the same
                                     space it counts for each */
    double area;                  /* square object units */
    /* Share of 1024 points, spread evenly over the bounds, at which inside or outside is in doubt:
     * no whole number >= 0 is within 1/4 of the winding number. 0 for closed surfaces that face
     * outwards; 1/3 for half a sphere. */
    double openness;
} gtx_solid_facts;

/* Prepares an asset. Takes some 100 bytes per texel from the descriptor's allocator; free it with
 * gtx_solid_destroy. `desc` may be NULL.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, EMPTY (the asset has no surface), INPUT (openness
 * exceeds max_openness, or the surface faces inwards; the message has the figure). */
GTX_API gtx_result gtx_solid_create(const gtx_asset *asset, const gtx_solid_desc *desc,
                                    gtx_solid **out, gtx_error *error);
/* NULL is fine. */
GTX_API void gtx_solid_destroy(gtx_solid *solid);

/* Copies the facts to *out; zeros if `solid` is NULL. */
GTX_API void gtx_solid_measure(const gtx_solid *solid, gtx_solid_facts *out);

/* The winding number of the surface around each point (relative to the asset's anchor): about 1
 * inside, 0 outside, 1/2 on the surface. NaN for a point that is not finite. Allocates nothing;
 * takes some microseconds per point. Errors: ARGUMENT. */
GTX_API gtx_result gtx_solid_winding(const gtx_solid *solid, const float (*points)[3],
                                     float *numbers, size_t count);

/* Sets inside[i] to 1 where the winding number is above 1/2, else to 0. Errors: ARGUMENT. */
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
    float max_openness;           /* of each asset, as for gtx_solid_desc */
    const gtx_allocator *allocator;   /* for the new asset too */
    const gtx_jobs *jobs;         /* used during the call */
    gtx_limits limits;            /* of memory and cells per asset; of work; of patches */
    uint32_t reserved[6];
} gtx_combine_desc;

typedef struct gtx_combine_result {
    uint32_t whole[2], cut[2], dropped[2];    /* numbers of patches of a, then of b */
    gtx_solid_facts facts[2];     /* of a, then of b */
    /* Object units: where the surfaces of a and b cross, the result's new outlines are within this
     * distance of the true crossing. 0 when nothing was cut. Parts of one asset that are thinner
     * than the texels of the other may be missed. */
    double error;
} gtx_combine_result;

/* Makes an asset of the parts of two assets' surfaces that bound their union, intersection or
 * difference. Heights, normals, colours and materials are unchanged; where the surfaces cross,
 * patches get new outlines, to 1/16 texel; patches of b that become the wall of a cavity are
 * reversed. Where the surfaces coincide, within 1/4 texel and 11 degrees, one of the two is kept:
 * for a union or an intersection if they face the same way, for a difference if they do not.
 *
 * Both assets are placed in object space by their anchors. The result has a's anchor and unit, the
 * greater height_bits and the smaller mip_count of both, and every map that either has, filled with
 * the map's default for the other. It has no LOD meshes: make them with gtx_cook_lod_meshes. The
 * same assets and options give the same bytes. `desc` and `result` may be NULL; free the asset with
 * gtx_close.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, INPUT (an asset is open; the units differ), EMPTY
 * (nothing is left). */
GTX_API gtx_result gtx_combine(const gtx_asset *a, const gtx_asset *b, const gtx_combine_desc *desc,
                               gtx_asset **out, gtx_combine_result *result, gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
