/* How a section's bytes are coded in the file: filters and zstd. */
#ifndef GTX_ASSET_CODEC_H
#define GTX_ASSET_CODEC_H

#include "asset/section.h"

/* Whether this build has zstd. */
bool gtx_has_zstd(void);
/* Such as "1.5.4", of the library that is linked; empty without. */
const char *gtx_zstd_version(void);

/* Whether sections of a kind may have a filter. */
bool gtx_filter_fits(gtx_section_kind kind, uint32_t filter);

/* Filters 0 to 3. Writes the filtered image to `out`; both have gtx_shape_size(image) bytes. */
void gtx_filter_apply(gtx_map_shape image, uint32_t filter, const uint8_t *in, uint8_t *out);

/* Turns `coded` back into the image, in `out`. The two are distinct with GTX_FILTER_PLANES, and may
 * be the same otherwise; `coded` is overwritten. */
void gtx_filter_undo(gtx_map_shape image, uint32_t filter, uint8_t *coded, uint8_t *out);

/* Filter 5, of heights. */
void gtx_heights_apply(gtx_map_shape image, const uint8_t *in, uint8_t *coded);
void gtx_heights_undo(gtx_map_shape image, const uint8_t *coded, uint8_t *out);

/* Filter 4, of trim and normals. The asset has its patches, with rectangles that hold, its heights,
 * and what is finer than this level. `scratch` has what gtx_apply_size says beyond the image. */
void gtx_surface_apply(const gtx_asset *asset, const gtx_section *section, const uint8_t *in,
                       uint8_t *coded, uint8_t *scratch);

/* An image of filter 4, and which of its texels have a height. */
typedef struct gtx_layer {
    const gtx_asset *asset;
    gtx_section_kind kind;
    uint32_t level;
    gtx_map_shape shape;
    size_t rows, texels, occupied;
    uint8_t *ring;                /* of gtx_fill, for all pages */
    const uint8_t *finer;         /* 1 where a texel of the finer level has a height */
} gtx_layer;

/* Marks the texels of a level that have a height: 1, and 0 elsewhere. `finer` has those of the
 * level before, and is not looked at for level 0. The two may be the same. */
void gtx_mark_level(const gtx_asset *asset, uint32_t level, const uint8_t *finer, uint8_t *out);

/* A layer of marked levels; finer and asset as above. */
gtx_layer gtx_layer_of(const gtx_asset *asset, const gtx_section *section, uint8_t *ring,
                       const uint8_t *finer);

/* Undoes the filter, in this order: texels with a height, once those of the finer level are there;
 * the others of each patch, in any order; what differs from the rules. Marks become rings by the
 * second: all levels, and trim, must have had theirs. */
void gtx_surface_undo_occupied(gtx_layer *layer, const uint8_t *coded, uint8_t *out);
void gtx_surface_undo_patch(const gtx_layer *layer, uint32_t patch, uint8_t *out);
void gtx_surface_undo_rest(const gtx_layer *layer, const uint8_t *coded, uint8_t *out);

/* Bytes of a section between zstd and its filter, where they are not undone in place; and what
 * applying the filter takes beside the image. */
uint64_t gtx_coded_size(const gtx_section *section);
uint64_t gtx_apply_size(const gtx_section *section, gtx_map_shape image);

/* Bytes of a zstd decoder's memory, aligned to 8; 0 without zstd. */
size_t gtx_decoder_size(void);

/* Decompresses a section of scheme 2 into `coded` (section->size bytes). NULL, or what is wrong. */
const char *gtx_decompress(void *decoder, const gtx_section *section, const uint8_t *bytes,
                           uint8_t *coded);

/* Undoes a section's filter, any but 4. NULL, or what is wrong. */
const char *gtx_undo_filter(const gtx_asset *asset, const gtx_section *section, uint8_t *coded,
                            uint8_t *out);

/* Bytes of a zstd encoder's memory, aligned to 8, for sections of `size`; 0 without zstd. */
size_t gtx_encoder_size(int level, uint64_t size);

/* What encoding takes from the caller: an encoder's memory, and gtx_apply_size bytes for the
 * filter. */
typedef struct gtx_encoder {
    int level;
    void *memory;
    size_t size;
    uint8_t *filtered;
} gtx_encoder;

/* Encodes a section of the asset, whose bytes in memory are `data`, into `out`, which has as many.
 * Returns the bytes written, 0 when they are not fewer. */
size_t gtx_encode_section(const gtx_encoder *encoder, const gtx_section *section,
                          const gtx_asset *asset, const uint8_t *data, uint8_t *out);

#endif
