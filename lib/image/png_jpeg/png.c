/* PNG, through libpng. It leaves by longjmp where it fails: what has to be there afterwards lies in
 * the caller's gtx_codec and in `state`, outside of the function that calls setjmp. */
#include "image/png_jpeg/codec.h"

#include <png.h>

#include <stdlib.h>
#include <string.h>

typedef struct state {
    png_structp png;
    png_infop info;
    png_bytep *rows;
    gtx_codec *codec;
} state;

static void on_error(png_structp png, png_const_charp text)
{
    gtx_codec *codec = png_get_error_ptr(png);
    snprintf(codec->message, sizeof codec->message, "PNG: %s", text);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp text)
{
    (void)png;
    (void)text;
}

static png_voidp take(png_structp png, png_alloc_size_t size)
{
    gtx_codec *codec = png_get_mem_ptr(png);
    void *memory = malloc(size);
    codec->no_memory |= !memory;
    return memory;
}

static void give_back(png_structp png, png_voidp memory)
{
    (void)png;
    free(memory);
}

int gtx_codec_take(gtx_codec *codec)
{
    const uint64_t count = (uint64_t)codec->width * codec->height;
    if (count == 0 || count > codec->max_pixels) {
        snprintf(codec->message, sizeof codec->message, "not an image of a supported size");
        return 0;
    }
    codec->pixels = malloc((size_t)count * codec->channels * codec->depth);
    codec->no_memory = !codec->pixels;
    return codec->pixels != NULL;
}

/* Every kind becomes grey or colour, with alpha or without, of 8 or 16 bits. */
static void ask_for(state *s)
{
    const uint16_t one = 1;
    png_set_expand(s->png);
    if (s->codec->wanted == GTX_CODEC_RGBA) {
        png_set_scale_16(s->png);
        png_set_gray_to_rgb(s->png);
        png_set_add_alpha(s->png, 255, PNG_FILLER_AFTER);
    } else if (*(const uint8_t *)&one) {
        png_set_swap(s->png);
    }
}

static int read_pixels(state *s)
{
    gtx_codec *codec = s->codec;
    if (setjmp(png_jmpbuf(s->png)))
        return 1;
    png_set_interlace_handling(s->png);
    ask_for(s);
    png_read_update_info(s->png, s->info);
    codec->channels = png_get_channels(s->png, s->info);
    codec->depth = png_get_bit_depth(s->png, s->info) / 8;
    if (!gtx_codec_take(codec))
        return 1;
    const size_t stride = (size_t)codec->width * codec->channels * codec->depth;
    s->rows = malloc(codec->height * sizeof *s->rows);
    if (!s->rows || png_get_rowbytes(s->png, s->info) != stride) {
        codec->no_memory = !s->rows;
        return 1;
    }
    for (size_t y = 0; y < codec->height; ++y)
        s->rows[y] = (png_bytep)codec->pixels + y * stride;
    png_read_image(s->png, s->rows);
    return 0;
}

static int read_header(state *s, FILE *file)
{
    /* Not of pixels; they may be packed to a thousandth. */
    static const png_byte ignored[] = "tEXt\0zTXt\0iTXt\0iCCP\0sPLT\0eXIf\0hIST";
    if (setjmp(png_jmpbuf(s->png)))
        return 1;
    png_set_keep_unknown_chunks(s->png, PNG_HANDLE_CHUNK_NEVER, ignored, sizeof ignored / 5);
    png_init_io(s->png, file);
    png_read_info(s->png, s->info);
    s->codec->width = png_get_image_width(s->png, s->info);
    s->codec->height = png_get_image_height(s->png, s->info);
    return 0;
}

int gtx_png_decode(FILE *file, gtx_codec *codec)
{
    state s = {.codec = codec};
    s.png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, codec, on_error, on_warning, codec,
                                     take, give_back);
    s.info = s.png ? png_create_info_struct(s.png) : NULL;
    codec->no_memory |= !s.info;
    const int failed = !s.info || read_header(&s, file) ||
                       (codec->wanted != GTX_CODEC_SIZE && read_pixels(&s));
    free(s.rows);
    png_destroy_read_struct(&s.png, &s.info, NULL);
    return failed;
}

static int write_pixels(const state *s, FILE *file, const uint8_t *pixels)
{
    static const int kinds[] = {0, PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA,
                                PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
    const gtx_codec *codec = s->codec;
    const size_t stride = (size_t)codec->width * codec->channels * codec->depth;
    const uint16_t one = 1;
    if (setjmp(png_jmpbuf(s->png)))
        return 1;
    png_init_io(s->png, file);
    png_set_IHDR(s->png, s->info, codec->width, codec->height, (int)codec->depth * 8,
                 kinds[codec->channels], PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB_gAMA_and_cHRM(s->png, s->info, PNG_sRGB_INTENT_ABSOLUTE);
    png_write_info(s->png, s->info);
    if (codec->depth == 2 && *(const uint8_t *)&one)
        png_set_swap(s->png);
    for (size_t y = 0; y < codec->height; ++y)
        png_write_row(s->png, pixels + y * stride);
    png_write_end(s->png, s->info);
    return 0;
}

int gtx_png_encode(FILE *file, const void *pixels, gtx_codec *codec)
{
    state s = {.codec = codec};
    s.png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, codec, on_error, on_warning, codec,
                                      take, give_back);
    s.info = s.png ? png_create_info_struct(s.png) : NULL;
    codec->no_memory |= !s.info;
    const int failed = !s.info || write_pixels(&s, file, pixels);
    png_destroy_write_struct(&s.png, &s.info);
    return failed;
}
