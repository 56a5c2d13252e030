/* How a section's bytes are coded in the file: filters and zstd. */
#ifndef GTX_ASSET_CODEC_H
#define GTX_ASSET_CODEC_H

#include "asset/section.h"

/* Whether this build has zstd. */
bool gtx_has_zstd(void);

/* Whether sections of a kind may have a filter. */
bool gtx_filter_fits(gtx_section_kind kind, uint32_t filter);

/* Filters 0 to 3. Writes the filtered image to `out`; both have gtx_shape_size(image) bytes. */
void gtx_filter_apply(gtx_map_shape image, uint32_t filter, const uint8_t *in, uint8_t *out);

/* Turns `coded` back into the image, in `out`. With GTX_FILTER_PLANES the two must be distinct and
 * `coded` is overwritten; otherwise they may be the same. */
void gtx_filter_undo(gtx_map_shape image, uint32_t filter, uint8_t *coded, uint8_t *out);

/* Filter 5, of heights. */
void gtx_heights_apply(gtx_map_shape image, const uint8_t *in, uint8_t *coded);
void gtx_heights_undo(gtx_map_shape image, const uint8_t *coded, uint8_t *out);

/* Filter 4, of trim and normals. The asset has its patches, with rectangles that hold, its heights,
 * and what is finer than this level. `scratch` has what gtx_undo_size, or gtx_apply_size, says beyond
 * the image's size. */
void gtx_surface_apply(const gtx_asset *asset, const gtx_section *section, const uint8_t *in,
                       uint8_t *coded, uint8_t *scratch);
void gtx_surface_undo(const gtx_asset *asset, const gtx_section *section, const uint8_t *coded,
                      uint8_t *out, uint8_t *scratch);

/* Bytes that undoing, or applying, a section's filter takes beside the image. */
uint64_t gtx_undo_size(const gtx_section *section, gtx_map_shape image);
uint64_t gtx_apply_size(const gtx_section *section, gtx_map_shape image);

/* A zstd context and a buffer for filtered images, from the caller's allocator. */
typedef struct gtx_codec {
    gtx_allocator allocator;
    void *context;
    size_t context_size;
    uint8_t *filtered;
    size_t filtered_size;
} gtx_codec;

/* Bytes of a decoder's context; 0 without zstd. */
size_t gtx_decoder_size(void);

/* A decoder, or an encoder of up to `level`; filtered_size may be 0. False when memory is out. Both
 * are freed with gtx_codec_end, also after a failure. */
bool gtx_decoder_begin(gtx_codec *codec, const gtx_allocator *allocator, size_t filtered_size);
bool gtx_encoder_begin(gtx_codec *codec, const gtx_allocator *allocator, size_t filtered_size,
                       int level);
void gtx_codec_end(gtx_codec *codec);

/* Decodes a section of scheme 2 into `out` (section->size bytes), with what the asset has already.
 * NULL, or what is wrong. */
const char *gtx_decode_section(gtx_codec *codec, const gtx_section *section,
                               const gtx_asset *asset, const uint8_t *bytes, uint8_t *out);

/* Encodes a section of the asset, whose bytes are `data`, into `out`. Returns the bytes
 * written, 0 when they are not fewer than section->size. */
size_t gtx_encode_section(gtx_codec *codec, const gtx_section *section, const gtx_asset *asset,
                          int level, const uint8_t *data, uint8_t *out);

#endif
