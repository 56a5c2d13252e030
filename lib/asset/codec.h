/* How a section's bytes are coded in the file: filters and zstd. */
#ifndef GTX_ASSET_CODEC_H
#define GTX_ASSET_CODEC_H

#include "asset/section.h"

/* Whether this build has zstd. */
bool gtx_has_zstd(void);

/* Writes the filtered image to `out`; both have gtx_shape_size(image) bytes. */
void gtx_filter_apply(gtx_map_shape image, uint32_t filter, const uint8_t *in, uint8_t *out);

/* Turns `coded` back into the image, in `out`. With GTX_FILTER_PLANES the two must be distinct and
 * `coded` is overwritten; otherwise they may be the same. */
void gtx_filter_undo(gtx_map_shape image, uint32_t filter, uint8_t *coded, uint8_t *out);

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

/* Whether undoing the section's filter takes a buffer of its size. */
bool gtx_filter_is_buffered(const gtx_section *section);

/* Decodes a section of scheme 2 into `out` (section->size bytes). NULL, or what is wrong. */
const char *gtx_decode_section(gtx_codec *codec, const gtx_section *section, gtx_map_shape image,
                               const uint8_t *bytes, uint8_t *out);

/* Encodes an image or a level of the shell, or plain bytes when section->filter is 0, into `out`.
 * Returns the bytes written, 0 when they are not fewer than section->size. */
size_t gtx_encode_section(gtx_codec *codec, const gtx_section *section, gtx_map_shape image,
                          int level, const uint8_t *data, uint8_t *out);

#endif
