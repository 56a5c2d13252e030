/* The module of PNG and JPEG, which are most images: libpng and libjpeg alone, for OpenImageIO with
 * all that it needs takes longer to load than most images take to read. */
#include "image/png_jpeg/codec.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int fail(char *message, const char *path, const gtx_codec *codec)
{
    snprintf(message, GTX_IMAGE_MAX_MESSAGE, "%s%s%.120s", path ? path : "", path ? ": " : "",
             codec->no_memory ? "out of memory" : codec->message);
    return codec->no_memory ? GTX_IMAGE_NO_MEMORY : GTX_IMAGE_FAILED;
}

/* Fills codec->size, and codec->pixels unless only the size is wanted. Returns 0, or fails. */
static int decode(const char *path, const void *data, size_t size, gtx_codec *codec, char *message)
{
    /* It only reads. */
    FILE *file = path ? fopen(path, "rb") : fmemopen((void *)(uintptr_t)data, size, "rb");
    if (!file) {
        snprintf(codec->message, sizeof codec->message, "cannot be opened");
        return fail(message, path, codec);
    }
    const int is_png = getc(file) == 0x89;
    rewind(file);
    const int failed = (is_png ? gtx_png_decode : gtx_jpeg_decode)(file, codec);
    fclose(file);
    if (!failed)
        return 0;
    free(codec->pixels);
    return fail(message, path, codec);
}

static int read_rgba(const char *path, const void *data, size_t size, uint64_t max_pixels,
                     gtx_image *out, char *message)
{
    gtx_codec codec = {.wanted = GTX_CODEC_RGBA, .max_pixels = max_pixels};
    const int failed = decode(path, data, size, &codec, message);
    if (!failed)
        *out = (gtx_image){codec.width, codec.height, codec.pixels};
    return failed;
}

static int read_raw(const char *path, uint64_t max_pixels, gtx_raw_image *out, char *message)
{
    gtx_codec codec = {.wanted = GTX_CODEC_AS_STORED, .max_pixels = max_pixels};
    const int failed = decode(path, NULL, 0, &codec, message);
    if (!failed)
        *out = (gtx_raw_image){codec.width, codec.height, codec.channels, codec.depth,
                               codec.pixels};
    return failed;
}

static int read_values(const char *path, uint64_t max_pixels, gtx_value_image *out, char *message)
{
    gtx_raw_image raw = {0};
    const int failed = read_raw(path, max_pixels, &raw, message);
    if (failed)
        return failed;
    const size_t count = (size_t)raw.width * raw.height;
    *out = (gtx_value_image){raw.width, raw.height, 0, raw.depth == 2 ? 65535 : 255,
                             malloc(count * sizeof(float))};
    const uint8_t *bytes = raw.pixels;
    const uint16_t *words = raw.pixels;
    for (size_t i = 0; out->values && i < count; ++i)
        out->values[i] = raw.depth == 2 ? words[i * raw.channels] : bytes[i * raw.channels];
    free(raw.pixels);
    return out->values ? 0 : fail(message, path, &(gtx_codec){.no_memory = 1});
}

static int measure(const char *path, const void *data, size_t size, uint32_t *width,
                   uint32_t *height, char *message)
{
    gtx_codec codec = {.wanted = GTX_CODEC_SIZE};
    const int failed = decode(path, data, size, &codec, message);
    if (!failed) {
        *width = codec.width;
        *height = codec.height;
    }
    return failed;
}

static int encode(const gtx_image_rows *rows, void **data, size_t *size, char *message)
{
    gtx_codec codec = {.width = rows->width, .height = rows->height, .channels = rows->channels,
                       .depth = strcmp(rows->format, "png16") ? 1 : 2};
    char *bytes = NULL;
    FILE *file = open_memstream(&bytes, size);
    int failed = !file || gtx_png_encode(file, rows->pixels, &codec);
    if (file && fclose(file))
        failed = codec.no_memory = 1;
    if (!file)
        codec.no_memory = 1;
    if (failed) {
        free(bytes);
        return fail(message, NULL, &codec);
    }
    *data = bytes;
    return 0;
}

__attribute__((visibility("default"))) const gtx_image_functions gtx_image_module = {
    GTX_IMAGE_MODULE_VERSION, encode, read_rgba, read_raw, read_values, measure};
