/* The functions of the image module, as image.c finds them with dlsym. */
#ifndef GTX_IMAGE_MODULE_H
#define GTX_IMAGE_MODULE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GTX_IMAGE_MODULE_SYMBOL "gtx_image_module"
#define GTX_IMAGE_MODULE_VERSION 4

enum { GTX_IMAGE_MAX_MESSAGE = 200 };

/* All return 0 for success and otherwise fill `message`. */
typedef struct gtx_image_functions {
    uint32_t version;
    /* `format` is "png" (bytes), "png16" (uint16_t) or "exr" (floats). */
    int (*write)(const char *path, const char *format, uint32_t width, uint32_t height,
                 uint32_t channels, const void *pixels, char message[GTX_IMAGE_MAX_MESSAGE]);
    /* *pixels gets 4 * *width * *height bytes from malloc. `data` NULL: the file at `path`. */
    int (*read)(const char *path, const void *data, size_t size, uint64_t max_pixels,
                uint32_t *width, uint32_t *height, uint8_t **pixels,
                char message[GTX_IMAGE_MAX_MESSAGE]);
    /* The same as *channels channels of 8 or 16 bits, *depth bytes each, as the file has them. */
    int (*read_raw)(const char *path, uint64_t max_pixels, uint32_t *width, uint32_t *height,
                    uint32_t *channels, uint32_t *depth, void **pixels,
                    char message[GTX_IMAGE_MAX_MESSAGE]);
    /* The first channel as floats; *least and *greatest of its type, 0 for floats. */
    int (*read_values)(const char *path, uint64_t max_pixels, uint32_t *width, uint32_t *height,
                       double *least, double *greatest, float **values,
                       char message[GTX_IMAGE_MAX_MESSAGE]);
    /* What the header claims; `data` as above. */
    int (*measure)(const char *path, const void *data, size_t size, uint32_t *width,
                   uint32_t *height, char message[GTX_IMAGE_MAX_MESSAGE]);
} gtx_image_functions;

#ifdef __cplusplus
}
#endif
#endif
