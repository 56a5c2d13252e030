/* Sections of scheme 2: one zstd frame, with contexts in the caller's memory. */
#include "asset/codec.h"

#include "asset/shell.h"
#include "base/alloc.h"

#ifdef GTX_ZSTD
/* Contexts inside given memory, their sizes and frame headers are zstd's "static" interface. */
#define ZSTD_STATIC_LINKING_ONLY
#include <zstd.h>

#define LARGEST_WINDOW (1ull << 27)

bool gtx_has_zstd(void)
{
    return true;
}

size_t gtx_decoder_size(void)
{
    return ZSTD_estimateDCtxSize();
}

bool gtx_encoder_begin(gtx_codec *codec, const gtx_allocator *allocator, size_t filtered_size,
                       int level)
{
    *codec = (gtx_codec){.allocator = *allocator, .context_size = ZSTD_estimateCCtxSize(level),
                         .filtered_size = filtered_size};
    codec->context = gtx_alloc_raw(allocator, codec->context_size, 1);
    codec->filtered = gtx_alloc_raw(allocator, filtered_size, 1);
    return codec->context && (codec->filtered || !filtered_size);
}

static void apply(const gtx_section *section, const gtx_asset *asset, const uint8_t *data,
                  uint8_t *coded)
{
    gtx_map_shape image = gtx_section_shape(&asset->info, section->kind, section->level);
    if (section->filter == GTX_FILTER_SURFACE)
        gtx_surface_apply(asset, section, data, coded, coded + section->size);
    else if (section->filter == GTX_FILTER_HEIGHTS)
        gtx_heights_apply(image, data, coded);
    else if (section->filter == GTX_FILTER_STEPS)
        gtx_shell_filter_apply(data, (size_t)section->size, coded);
    else
        gtx_filter_apply(image, section->filter, data, coded);
}

const char *gtx_decompress(void *decoder, const gtx_section *section, const uint8_t *bytes,
                           uint8_t *coded)
{
    ZSTD_frameHeader frame;
    size_t stored = (size_t)section->stored_size, size = (size_t)section->size;
    if (ZSTD_getFrameHeader(&frame, bytes, stored) != 0 || frame.frameType != ZSTD_frame)
        return "there is no zstd frame";
    if (frame.frameContentSize != section->size)
        return "the frame states another size";
    if (frame.windowSize > LARGEST_WINDOW)
        return "the frame needs a window above 2^27 bytes";
    if (ZSTD_findFrameCompressedSize(bytes, stored) != stored)
        return "the frame does not fill the section";

    ZSTD_DCtx *context = ZSTD_initStaticDCtx(decoder, gtx_decoder_size());
    if (!context || ZSTD_decompressDCtx(context, coded, size, bytes, stored) != size)
        return "the frame does not decode";
    return NULL;
}

size_t gtx_encode_section(gtx_codec *codec, const gtx_section *section, const gtx_asset *asset,
                          int level, const uint8_t *data, uint8_t *out)
{
    size_t size = (size_t)section->size;
    if (section->filter) {
        apply(section, asset, data, codec->filtered);
        data = codec->filtered;
    }
    ZSTD_CCtx *context = ZSTD_initStaticCCtx(codec->context, codec->context_size);
    if (!context || size < 2)
        return 0;
    size_t written = ZSTD_compressCCtx(context, out, size - 1, data, size, level);
    return ZSTD_isError(written) ? 0 : written;
}

#else

bool gtx_has_zstd(void)
{
    return false;
}

size_t gtx_decoder_size(void)
{
    return 0;
}

bool gtx_encoder_begin(gtx_codec *codec, const gtx_allocator *allocator, size_t filtered_size,
                       int level)
{
    (void)filtered_size, (void)level;
    *codec = (gtx_codec){.allocator = *allocator};
    return true;
}

const char *gtx_decompress(void *decoder, const gtx_section *section, const uint8_t *bytes,
                           uint8_t *coded)
{
    (void)decoder, (void)section, (void)bytes, (void)coded;
    return "this build has no zstd";
}

size_t gtx_encode_section(gtx_codec *codec, const gtx_section *section, const gtx_asset *asset,
                          int level, const uint8_t *data, uint8_t *out)
{
    (void)codec, (void)section, (void)asset, (void)level, (void)data, (void)out;
    return 0;
}

#endif

const char *gtx_undo_filter(const gtx_asset *asset, const gtx_section *section, uint8_t *coded,
                            uint8_t *out)
{
    gtx_map_shape image = gtx_section_shape(&asset->info, section->kind, section->level);
    if (section->filter == GTX_FILTER_STEPS &&
        !gtx_shell_filter_undo(coded, (size_t)section->size, out))
        return "the counts do not fit the size";
    if (section->filter == GTX_FILTER_HEIGHTS)
        gtx_heights_undo(image, coded, out);
    else if (section->filter && section->filter <= GTX_FILTER_PLANES_PAETH)
        gtx_filter_undo(image, section->filter, coded, out);
    return NULL;
}

void gtx_codec_end(gtx_codec *codec)
{
    gtx_free_array(&codec->allocator, codec->context, codec->context_size, 1);
    gtx_free_array(&codec->allocator, codec->filtered, codec->filtered_size, 1);
}
