/* Opens an image module on first use; what it encodes is written as every file is. */
#include "image/image.h"

#include "base/error.h"
#include "base/output.h"
#include "image/ktx.h"
#include "image/module.h"
#include "image/open.h"
#include "image/targa.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_PIXELS = 1 << 28 };

static const gtx_image_functions *module_functions(int is_png_or_jpeg, gtx_error *error)
{
    const char *name = is_png_or_jpeg ? "geotex-png-jpeg.so" : "geotex-image.so";
    char need[64];
    snprintf(need, sizeof need, "images need %s", name);
    const gtx_image_functions *functions =
        gtx_open_module(name, GTX_IMAGE_MODULE_SYMBOL, need, error);
    if (functions && functions->version != GTX_IMAGE_MODULE_VERSION) {
        gtx_fail(error, GTX_ERROR_UNSUPPORTED, "%s is of another version", name);
        return NULL;
    }
    return functions;
}

/* That which reads the file at `path`, or `data` where that is NULL. */
static const gtx_image_functions *module_to_read(const char *path, const void *data, size_t size,
                                                 gtx_error *error)
{
    char head[4];
    if (path) {
        FILE *file = fopen(path, "rb");
        size = file ? fread(head, 1, sizeof head, file) : 0;
        data = head;
        if (file)
            fclose(file);
    }
    return module_functions((size >= 4 && !memcmp(data, "\x89PNG", 4)) ||
                                (size >= 3 && !memcmp(data, "\xff\xd8\xff", 3)), error);
}

static gtx_result result_of(int failed, gtx_result otherwise)
{
    return failed == GTX_IMAGE_NO_MEMORY ? GTX_ERROR_MEMORY : otherwise;
}

static gtx_result encode_image(gtx_image_rows rows, void **data, size_t *size, gtx_error *error)
{
    char message[GTX_IMAGE_MAX_MESSAGE];
    if (!rows.pixels || !rows.width || !rows.height)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "an image without pixels or size");
    const gtx_image_functions *module = module_functions(!strncmp(rows.format, "png", 3), error);
    if (!module)
        return GTX_ERROR_UNSUPPORTED;
    const int failed = module->encode(&rows, data, size, message);
    if (failed)
        return gtx_fail(error, result_of(failed, GTX_ERROR_WRITE), "%s", message);
    return GTX_OK;
}

static gtx_result write_image(const char *path, gtx_image_rows rows, gtx_error *error)
{
    void *data;
    size_t size;
    if (!path)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "an image without a path");
    gtx_result result = encode_image(rows, &data, &size, error);
    if (result)
        return result;
    result = gtx_write_file(path, data, size, error);
    free(data);
    return result;
}

static gtx_result check_png(uint32_t channels, gtx_error *error)
{
    return channels == 1 || channels == 3 || channels == 4
               ? GTX_OK
               : gtx_fail(error, GTX_ERROR_ARGUMENT, "a PNG of %u channels", channels);
}

gtx_result gtx_image_write_png(const char *path, uint32_t width, uint32_t height, uint32_t channels,
                               const uint8_t *pixels, gtx_error *error)
{
    const gtx_result checked = check_png(channels, error);
    return checked ? checked
                   : write_image(path, (gtx_image_rows){"png", width, height, channels, pixels, 1,
                                                        0}, error);
}

gtx_result gtx_image_encode_png(uint32_t width, uint32_t height, uint32_t channels,
                                const uint8_t *pixels, void **data, size_t *size, gtx_error *error)
{
    const gtx_result checked = check_png(channels, error);
    return checked ? checked
                   : encode_image((gtx_image_rows){"png", width, height, channels, pixels, 1, 0},
                                  data, size, error);
}

gtx_result gtx_image_write_png16(const char *path, uint32_t width, uint32_t height,
                                 const uint16_t *pixels, gtx_error *error)
{
    return write_image(path, (gtx_image_rows){"png16", width, height, 1, pixels, 1, 0}, error);
}

gtx_result gtx_image_write_exr(const char *path, uint32_t width, uint32_t height, const float *z,
                               gtx_error *error)
{
    return write_image(path, (gtx_image_rows){"exr", width, height, 1, z, 1, 0}, error);
}

gtx_result gtx_image_write_gif(const char *path, uint32_t width, uint32_t height, uint32_t frames,
                               double frames_per_second, const uint8_t *pixels, gtx_error *error)
{
    enum { MAX_GIF_SIDE = 65535 };
    if (width > MAX_GIF_SIDE || height > MAX_GIF_SIDE)
        return gtx_fail(error, GTX_ERROR_LIMIT, "a GIF of %u x %u", width, height);
    return write_image(path, (gtx_image_rows){"gif", width, height, 4, pixels, frames,
                                              (float)frames_per_second}, error);
}

/* ---- what is decoded here ---- */

static const struct own {
    int (*is)(const void *data, size_t size);
    gtx_result (*measure)(const void *data, size_t size, uint32_t *width, uint32_t *height,
                          gtx_error *error);
    gtx_result (*decode)(const void *data, size_t size, uint64_t max_pixels, gtx_image *out,
                         gtx_error *error);
} own[] = {{gtx_is_ktx, gtx_ktx_measure, gtx_ktx_decode},
           {gtx_is_targa, gtx_targa_measure, gtx_targa_decode}};

/* NULL for what the module is to read. */
static const struct own *own_of(const void *data, size_t size)
{
    for (size_t i = 0; data && i < sizeof own / sizeof *own; ++i)
        if (own[i].is(data, size))
            return &own[i];
    return NULL;
}

static gtx_result read_image(const char *path, const void *data, size_t size, gtx_image *out,
                             gtx_error *error)
{
    char message[GTX_IMAGE_MAX_MESSAGE];
    gtx_image image = {0};
    const struct own *decoder = own_of(data, size);
    if (decoder)
        return decoder->decode(data, size, MAX_PIXELS, out, error);
    const gtx_image_functions *module = module_to_read(path, data, size, error);
    if (!module)
        return GTX_ERROR_UNSUPPORTED;
    const int failed = module->read(path, data, size, MAX_PIXELS, &image, message);
    if (failed)
        return gtx_fail(error, result_of(failed, GTX_ERROR_READ), "%s", message);
    *out = image;
    return GTX_OK;
}

gtx_result gtx_image_read(const char *path, gtx_image *out, gtx_error *error)
{
    if (!path || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "no path or no place for the image");
    return read_image(path, NULL, 0, out, error);
}

gtx_result gtx_image_decode(const void *data, size_t size, gtx_image *out, gtx_error *error)
{
    if (!data || !size || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "no bytes or no place for the image");
    return read_image(NULL, data, size, out, error);
}

gtx_result gtx_image_read_raw(const char *path, gtx_raw_image *out, gtx_error *error)
{
    char message[GTX_IMAGE_MAX_MESSAGE];
    gtx_raw_image image = {0};
    if (!path || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "no path or no place for the image");
    const gtx_image_functions *module = module_to_read(path, NULL, 0, error);
    if (!module)
        return GTX_ERROR_UNSUPPORTED;
    const int failed = module->read_raw(path, MAX_PIXELS, &image, message);
    if (failed)
        return gtx_fail(error, result_of(failed, GTX_ERROR_READ), "%s", message);
    *out = image;
    return GTX_OK;
}

gtx_result gtx_image_read_values(const char *path, gtx_value_image *out, gtx_error *error)
{
    char message[GTX_IMAGE_MAX_MESSAGE];
    gtx_value_image image = {0};
    if (!path || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "no path or no place for the image");
    const gtx_image_functions *module = module_to_read(path, NULL, 0, error);
    if (!module)
        return GTX_ERROR_UNSUPPORTED;
    const int failed = module->read_values(path, MAX_PIXELS, &image, message);
    if (failed)
        return gtx_fail(error, result_of(failed, GTX_ERROR_READ), "%s", message);
    *out = image;
    return GTX_OK;
}

static gtx_result measure(const char *path, const void *data, size_t size, uint32_t *width,
                          uint32_t *height, gtx_error *error)
{
    char message[GTX_IMAGE_MAX_MESSAGE];
    const struct own *decoder = own_of(data, size);
    if (decoder)
        return decoder->measure(data, size, width, height, error);
    const gtx_image_functions *module = module_to_read(path, data, size, error);
    if (!module)
        return GTX_ERROR_UNSUPPORTED;
    const int failed = module->measure(path, data, size, width, height, message);
    if (failed)
        return gtx_fail(error, result_of(failed, GTX_ERROR_READ), "%s", message);
    return GTX_OK;
}

gtx_result gtx_image_measure(const void *data, size_t size, uint32_t *width, uint32_t *height,
                             gtx_error *error)
{
    if (!data || !size || !width || !height)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "no bytes or no place for the size");
    return measure(NULL, data, size, width, height, error);
}

gtx_result gtx_image_measure_file(const char *path, uint32_t *width, uint32_t *height,
                                  gtx_error *error)
{
    if (!path || !width || !height)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "no path or no place for the size");
    return measure(path, NULL, 0, width, height, error);
}

void gtx_image_free(gtx_image *image)
{
    if (!image)
        return;
    free(image->pixels);
    *image = (gtx_image){0};
}
