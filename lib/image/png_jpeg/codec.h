/* What the module of PNG and JPEG asks of its decoders. */
#ifndef GTX_IMAGE_CODEC_H
#define GTX_IMAGE_CODEC_H

#include "image/module.h"

#include <stdio.h>

enum gtx_codec_wanted { GTX_CODEC_SIZE, GTX_CODEC_RGBA, GTX_CODEC_AS_STORED };

typedef struct gtx_codec {
    enum gtx_codec_wanted wanted;
    uint64_t max_pixels;
    uint32_t width, height, channels;
    uint32_t depth;           /* bytes a channel */
    void *pixels;             /* from malloc, freed by the caller, of a failure too */
    char message[GTX_IMAGE_MAX_MESSAGE];
    int no_memory;
} gtx_codec;

/* Read a file from where it is; return 0, or not and say why in `message` or `no_memory`. */
int gtx_png_decode(FILE *file, gtx_codec *codec);
int gtx_jpeg_decode(FILE *file, gtx_codec *codec);

/* Writes rows of 8 or 16 bits a channel, marked as sRGB. Returns as above. */
int gtx_png_encode(FILE *file, const void *pixels, gtx_codec *codec);

/* Takes codec->pixels for the size, channels and depth that are known; 0 where that fails. */
int gtx_codec_take(gtx_codec *codec);

#endif
