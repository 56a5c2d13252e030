/* The functions of the image module, as image.c finds them with dlsym. */
#ifndef GTX_IMAGE_MODULE_H
#define GTX_IMAGE_MODULE_H

#include "image/image.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GTX_IMAGE_MODULE_SYMBOL "gtx_image_module"
#define GTX_IMAGE_MODULE_VERSION 7

enum { GTX_IMAGE_MAX_MESSAGE = 200 };

/* What to write; `format` is "png" (bytes), "png16" (uint16_t), "exr" (floats) or "gif" (bytes,
 * which alone has more than one frame: they follow each other in `pixels`). */
typedef struct gtx_image_rows {
    const char *format;
    uint32_t width, height, channels;
    const void *pixels;
    uint32_t frames;          /* 0: one */
    float frames_per_second;
} gtx_image_rows;

enum { GTX_IMAGE_FAILED = 1, GTX_IMAGE_NO_MEMORY = 2 };

/* All return 0 for success, and otherwise one of these and fill `message`. */
typedef struct gtx_image_functions {
    uint32_t version;
    /* The bytes of a file, from malloc. */
    int (*encode)(const gtx_image_rows *rows, void **data, size_t *size,
                  char message[GTX_IMAGE_MAX_MESSAGE]);
    /* The pixels come from malloc. `data` NULL: the file at `path`. */
    int (*read)(const char *path, const void *data, size_t size, uint64_t max_pixels,
                gtx_image *out, char message[GTX_IMAGE_MAX_MESSAGE]);
    int (*read_raw)(const char *path, uint64_t max_pixels, gtx_raw_image *out,
                    char message[GTX_IMAGE_MAX_MESSAGE]);
    int (*read_values)(const char *path, uint64_t max_pixels, gtx_value_image *out,
                       char message[GTX_IMAGE_MAX_MESSAGE]);
    /* What the header claims; `data` as above. */
    int (*measure)(const char *path, const void *data, size_t size, uint32_t *width,
                   uint32_t *height, char message[GTX_IMAGE_MAX_MESSAGE]);
} gtx_image_functions;

#ifdef __cplusplus
}
#endif
#endif
