/* TGA (Truevision, 1991): true colour, grey and palettes, plain or packed as runs. */
#include "image/targa.h"

#include "base/error.h"

#include <stdlib.h>
#include <string.h>

enum { PALETTE = 1, TRUE_COLOR = 2, GREY = 3, RUNS = 8, FROM_RIGHT = 16, FROM_TOP = 32 };

typedef struct header {
    uint32_t kind, bits, width, height, alpha_bits, origin;
    uint32_t id, first, colors, color_bits;   /* of the palette; first: the number of its first */
} header;

/* What is left of the file. */
typedef struct input {
    const uint8_t *at, *end;
} input;

static uint32_t u16(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8;
}

static int is_color_size(uint32_t bits)
{
    return bits == 15 || bits == 16 || bits == 24 || bits == 32;
}

static header read_header(const uint8_t *p)
{
    return (header){.kind = p[2], .bits = p[16], .width = u16(p + 12), .height = u16(p + 14),
                    .alpha_bits = p[17] & 15, .origin = p[17], .id = p[0], .first = u16(p + 3),
                    .colors = p[1] ? u16(p + 5) : 0, .color_bits = p[7]};
}

int gtx_is_targa(const void *data, size_t size)
{
    const uint8_t *p = data;
    if (size < GTX_TARGA_HEADER || p[1] > 1)
        return 0;
    const header h = read_header(p);
    if (!h.width || !h.height || (p[1] && !is_color_size(h.color_bits)))
        return 0;
    switch (h.kind & ~(uint32_t)RUNS) {
    case PALETTE: return h.colors > 0 && h.bits == 8;
    case TRUE_COLOR: return is_color_size(h.bits);
    case GREY: return h.bits == 8 || h.bits == 16;
    default: return 0;
    }
}

gtx_result gtx_targa_measure(const void *data, size_t size, uint32_t *width, uint32_t *height,
                             gtx_error *error)
{
    (void)size;
    (void)error;
    const header h = read_header(data);
    *width = h.width;
    *height = h.height;
    return GTX_OK;
}

static uint8_t of_5_bits(uint32_t value)
{
    return (uint8_t)((value & 31) * 255 / 31);
}

/* One colour of a file, blue first, as RGBA. */
static void color(const uint8_t *p, uint32_t bits, uint32_t alpha_bits, uint8_t rgba[4])
{
    if (bits <= 16) {
        const uint32_t v = u16(p);
        rgba[0] = of_5_bits(v >> 10);
        rgba[1] = of_5_bits(v >> 5);
        rgba[2] = of_5_bits(v);
        rgba[3] = alpha_bits && bits == 16 && !(v >> 15) ? 0 : 255;
    } else {
        rgba[0] = p[2];
        rgba[1] = p[1];
        rgba[2] = p[0];
        rgba[3] = alpha_bits && bits == 32 ? p[3] : 255;
    }
}

/* 0 where the palette has no such colour. */
static int pixel(const header *h, const uint8_t *palette, const uint8_t *p, uint8_t rgba[4])
{
    const uint32_t kind = h->kind & ~(uint32_t)RUNS;
    if (kind == TRUE_COLOR) {
        color(p, h->bits, h->alpha_bits, rgba);
    } else if (kind == GREY) {
        memset(rgba, p[0], 3);
        rgba[3] = h->bits == 16 && h->alpha_bits ? p[1] : 255;
    } else {
        if (p[0] < h->first || p[0] - h->first >= h->colors)
            return 0;
        color(palette + (size_t)(p[0] - h->first) * ((h->color_bits + 7) / 8), h->color_bits,
              h->alpha_bits, rgba);
    }
    return 1;
}

/* Where the n-th pixel of the file lies in the image. */
static size_t place(const header *h, size_t n)
{
    const size_t x = n % h->width, y = n / h->width;
    return (h->origin & FROM_TOP ? y : h->height - 1 - y) * h->width +
           (h->origin & FROM_RIGHT ? h->width - 1 - x : x);
}

static const char *read_pixels(const header *h, const uint8_t *palette, input in, uint8_t *out)
{
    const size_t count = (size_t)h->width * h->height, size = (h->bits + 7) / 8;
    for (size_t n = 0; n < count;) {
        size_t length = count - n, step = size;
        if (h->kind & RUNS) {
            if (in.at == in.end)
                return "the TGA image ends too early";
            const size_t run = (size_t)(*in.at & 127) + 1;
            step = *in.at++ & 128 ? 0 : size; /* one pixel many times, or as many pixels */
            length = run < length ? run : length;
        }
        if ((size_t)(in.end - in.at) < (step ? length * size : size))
            return "the TGA image ends too early";
        for (size_t i = 0; i < length; ++i, ++n, in.at += step)
            if (!pixel(h, palette, in.at, out + 4 * place(h, n)))
                return "the TGA image names a colour that its palette lacks";
        in.at += step ? 0 : size;
    }
    return NULL;
}

gtx_result gtx_targa_decode(const void *data, size_t size, uint64_t max_pixels, gtx_image *out,
                            gtx_error *error)
{
    const header h = read_header(data);
    input in = {(const uint8_t *)data + GTX_TARGA_HEADER, (const uint8_t *)data + size};
    const size_t before = h.id + (size_t)h.colors * ((h.color_bits + 7) / 8);
    const uint64_t count = (uint64_t)h.width * h.height;
    enum { LONGEST_RUN = 128 };
    if (count > max_pixels)
        return gtx_fail(error, GTX_ERROR_READ, "not an image of a supported size");
    if ((size_t)(in.end - in.at) < before ||
        count / LONGEST_RUN > (size_t)(in.end - in.at) - before) /* before memory is taken */
        return gtx_fail(error, GTX_ERROR_READ, "the TGA image ends too early");
    uint8_t *pixels = malloc((size_t)count * 4);
    if (!pixels)
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory");
    const uint8_t *palette = in.at + h.id;
    in.at += before;
    const char *problem = read_pixels(&h, palette, in, pixels);
    if (problem) {
        free(pixels);
        return gtx_fail(error, GTX_ERROR_READ, "%s", problem);
    }
    *out = (gtx_image){h.width, h.height, pixels};
    return GTX_OK;
}
