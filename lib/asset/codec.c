/* Sections of scheme 2: one zstd frame, with contexts in the caller's memory. */
#include "asset/codec.h"

#include "asset/lod.h"
#include "asset/order.h"
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

const char *gtx_zstd_version(void)
{
    return ZSTD_versionString();
}

size_t gtx_decoder_size(void)
{
    return ZSTD_estimateDCtxSize();
}

/* Differences hardly repeat: shorter matches cost more than they save, unless zstd weighs each.
 * Bunny and dragon: 1.6 % fewer bytes at level 3 and up to 9, and no slower; half, zstd's own, is
 * without; there is nothing above 7, which gives 1 % fewer at level 3 and the same from 5 on. */
#define SHORTEST_MATCH 6u

static ZSTD_compressionParameters parameters_of(int level, uint64_t size)
{
    ZSTD_compressionParameters out = ZSTD_getCParams(level, size, 0);
    if (out.strategy < ZSTD_btopt && out.minMatch < SHORTEST_MATCH)
        out.minMatch = SHORTEST_MATCH;
    return out;
}

/* How zstd finds matches in over 16 KB depends on whether it was compiled with vectors; told to
 * do as with them it gives the same bytes on all processors. Before 1.5.2 there was no choice. */
static bool is_alike(ZSTD_CCtx *context, const ZSTD_compressionParameters *p)
{
#if ZSTD_VERSION_NUMBER >= 10502
    const int rows = p->windowLog > 14 ? ZSTD_ps_enable : ZSTD_ps_disable;
    return !ZSTD_isError(ZSTD_CCtx_setParameter(context, ZSTD_c_useRowMatchFinder, rows));
#else
    (void)context, (void)p;
    return true;
#endif
}

size_t gtx_encoder_size(int level, uint64_t size)
{
    return ZSTD_estimateCCtxSize_usingCParams(parameters_of(level, size));
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
        gtx_lod_filter_apply(data, (size_t)section->size, coded, coded + section->size);
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

size_t gtx_encode_section(const gtx_encoder *encoder, const gtx_section *section,
                          const gtx_asset *asset, const uint8_t *data, uint8_t *out)
{
    size_t size = (size_t)section->size;
    data = gtx_bytes_in_file(asset, section, data, section->filter ? out : encoder->filtered);
    if (section->filter) {
        apply(section, asset, data, encoder->filtered);
        data = encoder->filtered;
    }
    ZSTD_CCtx *context = ZSTD_initStaticCCtx(encoder->memory, encoder->size);
    if (!context || size < 2)
        return 0;
    const ZSTD_compressionParameters p = parameters_of(encoder->level, size);
    if (ZSTD_isError(ZSTD_CCtx_reset(context, ZSTD_reset_session_and_parameters)) ||
        ZSTD_isError(ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, encoder->level)) ||
        ZSTD_isError(ZSTD_CCtx_setParameter(context, ZSTD_c_minMatch, (int)p.minMatch)) ||
        !is_alike(context, &p))
        return 0;
    const size_t written = ZSTD_compress2(context, out, size - 1, data, size);
    return ZSTD_isError(written) ? 0 : written;
}

#else

bool gtx_has_zstd(void)
{
    return false;
}

const char *gtx_zstd_version(void)
{
    return "";
}

size_t gtx_decoder_size(void)
{
    return 0;
}

size_t gtx_encoder_size(int level, uint64_t size)
{
    (void)level, (void)size;
    return 0;
}

const char *gtx_decompress(void *decoder, const gtx_section *section, const uint8_t *bytes,
                           uint8_t *coded)
{
    (void)decoder, (void)section, (void)bytes, (void)coded;
    return "this build has no zstd";
}

size_t gtx_encode_section(const gtx_encoder *encoder, const gtx_section *section,
                          const gtx_asset *asset, const uint8_t *data, uint8_t *out)
{
    (void)encoder, (void)section, (void)asset, (void)data, (void)out;
    return 0;
}

#endif

const char *gtx_undo_filter(const gtx_asset *asset, const gtx_section *section, uint8_t *coded,
                            uint8_t *out)
{
    gtx_map_shape image = gtx_section_shape(&asset->info, section->kind, section->level);
    if (section->filter == GTX_FILTER_STEPS &&
        !gtx_lod_filter_undo(coded, (size_t)section->size, out))
        return "the counts do not fit the size";
    if (section->filter == GTX_FILTER_HEIGHTS)
        gtx_heights_undo(image, coded, out);
    else if (section->filter && section->filter <= GTX_FILTER_PLANES_PAETH)
        gtx_filter_undo(image, section->filter, coded, out);
    return NULL;
}
