/* Small assets made in memory, for the tests of every room. */
#ifndef GTX_TESTS_FIXTURE_H
#define GTX_TESTS_FIXTURE_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a height field is at one place. */
typedef struct fixture_texel {
    double height;              /* 0..1 of extent_z; negative: empty */
    double trim;                /* texels outside the outline, negative inside */
    double normal[3];           /* object space, of any length */
    uint8_t color[4];
} fixture_texel;

/* Fills *out at texel coordinates (x, y) of a patch, which are fractional at mip levels. */
typedef void (*fixture_field)(const gtx_patch *patch, double x, double y, const void *user,
                              fixture_texel *out);

/* `frame` gives origin, axes, extents, width and height (rect[2] and rect[3], multiples of
 * 2^(mips - 1)) and flags; the rest of the record is filled in. */
typedef struct fixture_patch {
    gtx_patch frame;
    fixture_field field;
    const void *user;
} fixture_patch;

/* Samples the height fields, packs them into one page and makes an asset; gtx_close frees it. Ends
 * the program when the asset breaks a rule. */
gtx_asset *fixture_build(const fixture_patch *patches, uint32_t count, uint32_t height_bits,
                         uint32_t mips);

/* The same into caller's memory hooks. */
gtx_asset *fixture_build_with(const fixture_patch *patches, uint32_t count, uint32_t height_bits,
                              uint32_t mips, const gtx_allocator *allocator);

/* A frame along the axes of object space: texel (0, 0) at height 0 is at `corner`, texels are
 * `pitch` apart, heights 0..1 span `depth`. */
gtx_patch fixture_frame(const double corner[3], uint32_t width, uint32_t height, double pitch,
                        double depth);

/* A plane of 32 x 24 texels, 0.125 apart, from (0, 0) to (3.875, 2.875), at height `z` of 0..1:
 * the codes of the middle for z = 0.5. */
gtx_asset *fixture_flat(double z, uint32_t height_bits);

/* One bumpy height field of 64 x 48 texels in a tilted frame, with a ragged outline and two holes.
 * `flags` are those of the patch. */
gtx_asset *fixture_bumpy(uint32_t height_bits, uint16_t flags);

/* A sphere around the origin: six patches of texels x texels (48 or more, a multiple of 8) that
 * overlap by 1.5 texels and are trimmed there. */
gtx_asset *fixture_sphere(double radius, uint32_t texels, uint32_t height_bits);

/* The same with some of the six faces left out: bit 2 * axis + (1 for the negative side). */
gtx_asset *fixture_sphere_without(double radius, uint32_t texels, uint32_t height_bits,
                                  uint32_t faces);

#ifdef __cplusplus
}
#endif
#endif
