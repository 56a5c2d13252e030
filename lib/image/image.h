/* Images on disk. What reads and writes them are modules, opened when something asks for them, so
 * that a program that needs none does not pay: geotex-png-jpeg.so holds libpng and libjpeg, and
 * geotex-image.so OpenImageIO, whose opening takes a quarter of a second. They are looked for from
 * the folder of the library or program that holds this code, and nowhere else: in that folder, in
 * geotex/ below it and in ../lib/geotex/. No variable of the environment has a say in it. */
#ifndef GTX_IMAGE_IMAGE_H
#define GTX_IMAGE_IMAGE_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Writes rows from the top; `channels` is 1 (grey), 3 (RGB) or 4 (RGBA), 8 bits each, sRGB. The
 * file is written as gtx_write_file does.
 * Errors: ARGUMENT, MEMORY, WRITE, UNSUPPORTED (the module cannot be opened). */
gtx_result gtx_image_write_png(const char *path, uint32_t width, uint32_t height, uint32_t channels,
                               const uint8_t *pixels, gtx_error *error);

/* The same into memory: *data is from malloc, and freed by the caller. Errors: likewise. */
gtx_result gtx_image_encode_png(uint32_t width, uint32_t height, uint32_t channels,
                                const uint8_t *pixels, void **data, size_t *size, gtx_error *error);

/* gtx_image_write_png for one grey channel of 16 bits. Errors: likewise. */
gtx_result gtx_image_write_png16(const char *path, uint32_t width, uint32_t height,
                                 const uint16_t *pixels, gtx_error *error);

/* Writes an OpenEXR image with the one float channel Z. Errors: likewise. */
gtx_result gtx_image_write_exr(const char *path, uint32_t width, uint32_t height, const float *z,
                               gtx_error *error);

/* Writes a GIF that plays its frames over and over, in 256 colours each. RGBA8 sRGB whose alpha
 * does not count, frame after frame, rows from the top. Errors: likewise, LIMIT (sides past
 * 65535). */
gtx_result gtx_image_write_gif(const char *path, uint32_t width, uint32_t height, uint32_t frames,
                               double frames_per_second, const uint8_t *pixels, gtx_error *error);

/* An image in memory, rows from the top. */
typedef struct gtx_image {
    uint32_t width, height;
    uint8_t *pixels;          /* 4 * width * height: sRGB colour, alpha 255 where there is none */
} gtx_image;

/* Reads any file OpenImageIO knows as RGBA8: grey spreads to three channels. Images of more than
 * 2^28 pixels are refused. Errors: ARGUMENT, MEMORY, LIMIT, READ, UNSUPPORTED. */
gtx_result gtx_image_read(const char *path, gtx_image *out, gtx_error *error);
/* An image with the channels and the depth that its file has. */
typedef struct gtx_raw_image {
    uint32_t width, height, channels;   /* 1..4 */
    uint32_t depth;           /* bytes a channel: 1 or 2 */
    void *pixels;             /* from malloc, freed by the caller; rows from the top */
} gtx_raw_image;

/* Reads a file of 8 or 16 bits a channel without changing a value. Errors: as gtx_image_read. */
gtx_result gtx_image_read_raw(const char *path, gtx_raw_image *out, gtx_error *error);
/* The first channel of an image as numbers: whole ones as they are, signed too, or floats. */
typedef struct gtx_value_image {
    uint32_t width, height;
    double least, greatest;   /* of the file's kind of whole number; both 0 for floats */
    float *values;            /* from malloc, freed by the caller; rows from the top */
} gtx_value_image;

/* Reads 8 or 16 bits or floats a channel. Errors: as gtx_image_read. */
gtx_result gtx_image_read_values(const char *path, gtx_value_image *out, gtx_error *error);
/* gtx_image_read from the bytes of a file, and of KTX2 too. Errors: likewise. */
gtx_result gtx_image_decode(const void *data, size_t size, gtx_image *out, gtx_error *error);
/* The size that such bytes claim, without decoding them. Errors: likewise. */
gtx_result gtx_image_measure(const void *data, size_t size, uint32_t *width, uint32_t *height,
                             gtx_error *error);
gtx_result gtx_image_measure_file(const char *path, uint32_t *width, uint32_t *height,
                                  gtx_error *error);
void gtx_image_free(gtx_image *image);

#ifdef __cplusplus
}
#endif
#endif
