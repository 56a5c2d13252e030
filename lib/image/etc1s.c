/* BasisLZ with ETC1S blocks: two lists, of base colours and of the sixteen steps of a block, and
 * per block a number of each, packed by Huffman codes (KTX 2.0, appendix B). */
#include "image/basis.h"

#include "base/error.h"
#include "image/huffman.h"

#include <stdlib.h>
#include <string.h>

enum {
    GLOBAL_HEADER = 20, IMAGE_DESC = 20, IS_P_FRAME = 2,
    REPEAT_PREDICTION = 256, MIN_PREDICTION_RUN = 3,
    MIN_SELECTOR_RUN = 3, LONG_SELECTOR_RUN = 63
};

typedef struct ends {
    uint8_t rgb[3], table; /* rgb: 5 bits each */
} ends;

/* What all images of a file share, and what takes part in reading it. */
typedef struct codebook {
    uint32_t endpoint_count, selector_count, history_size;
    ends *endpoints;
    uint32_t *selectors; /* two bits a texel */
    gtx_huffman color[3], table, prediction, delta, selector, run, scratch;
} codebook;

static uint32_t u16(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8;
}

static uint32_t u32(const uint8_t *p)
{
    return u16(p) | u16(p + 2) << 16;
}

/* ---- the two lists ---- */

static void take_endpoints(gtx_bits *bits, codebook *book)
{
    uint8_t last[3] = {16, 16, 16}, table = 0;
    for (int i = 0; i < 3; ++i)
        gtx_huffman_read(bits, &book->color[i]);
    gtx_huffman_read(bits, &book->table);
    const uint32_t channels = gtx_take_bit(bits) ? 1 : 3;
    for (uint32_t i = 0; i < book->endpoint_count && !bits->over; ++i) {
        ends *e = &book->endpoints[i];
        e->table = table = (table + gtx_huffman_take(bits, &book->table)) & 7;
        for (uint32_t c = 0; c < channels; ++c) {
            const gtx_huffman *codes = &book->color[last[c] < 10 ? 0 : last[c] < 22 ? 1 : 2];
            last[c] = (last[c] + gtx_huffman_take(bits, codes)) & 31;
        }
        for (uint32_t c = 0; c < 3; ++c)
            e->rgb[c] = last[channels == 3 ? c : 0];
    }
}

static void take_selectors(gtx_bits *bits, codebook *book)
{
    if (gtx_take_bits(bits, 2))
        bits->over = 1; /* reserved */
    const int plain = (int)gtx_take_bit(bits);
    if (!plain)
        gtx_huffman_read(bits, &book->scratch);
    for (uint32_t i = 0; i < book->selector_count && !bits->over; ++i) {
        uint32_t rows = plain || !i ? 0 : book->selectors[i - 1];
        for (uint32_t shift = 0; shift < 32; shift += 8)
            rows ^= (plain || !i ? gtx_take_bits(bits, 8)
                                 : gtx_huffman_take(bits, &book->scratch) & 255)
                    << shift;
        book->selectors[i] = rows;
    }
}

static void take_tables(gtx_bits *bits, codebook *book)
{
    gtx_huffman_read(bits, &book->prediction);
    gtx_huffman_read(bits, &book->delta);
    gtx_huffman_read(bits, &book->selector);
    gtx_huffman_read(bits, &book->run);
    book->history_size = gtx_take_bits(bits, 13);
}

static gtx_result fail(gtx_error *error, const char *what)
{
    return gtx_fail(error, GTX_ERROR_READ, "%s of the KTX2 image ends too early or is broken",
                    what);
}

static gtx_result read_codebook(const gtx_basis_image *image, codebook *book, gtx_error *error)
{
    const uint8_t *data = image->global;
    const uint64_t head = GLOBAL_HEADER + (uint64_t)IMAGE_DESC * image->image_count;
    if (image->global_size < head)
        return fail(error, "the global data");
    const uint64_t sizes[3] = {u32(data + 4), u32(data + 8), u32(data + 12)};
    if (sizes[0] + sizes[1] + sizes[2] > image->global_size - head)
        return fail(error, "the global data");
    book->endpoint_count = u16(data);
    book->selector_count = u16(data + 2);
    book->endpoints = calloc(book->endpoint_count + 1, sizeof *book->endpoints);
    book->selectors = calloc(book->selector_count + 1, sizeof *book->selectors);
    if (!book->endpoints || !book->selectors)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the image");
    static void (*const takes[3])(gtx_bits *, codebook *) = {take_endpoints, take_selectors,
                                                             take_tables};
    data += head;
    for (int i = 0; i < 3; data += sizes[i++]) {
        gtx_bits bits = {data, (size_t)sizes[i], 0, 0};
        takes[i](&bits, book);
        if (bits.over)
            return fail(error, "the global data");
    }
    return GTX_OK;
}

/* ---- slices ---- */

/* What the blocks before have left. */
typedef struct slice {
    gtx_bits bits;
    const codebook *book;
    uint32_t columns, endpoint, prediction, last_prediction, prediction_run, selector_run;
    uint32_t *history, rover;  /* selectors that were used, the newer half in turn */
    uint16_t *above;           /* endpoints of the row before, replaced from the left */
    uint8_t *below;            /* predictions for the second row of two */
} slice;

/* Chunks of n bits, the bit above them telling of another. */
static uint32_t take_number(gtx_bits *bits, uint32_t n)
{
    uint32_t value = 0;
    for (uint32_t shift = 0; shift < 32; shift += n) {
        const uint32_t chunk = gtx_take_bits(bits, n + 1);
        value |= (chunk & ((1u << n) - 1)) << shift;
        if (!(chunk >> n))
            return value;
    }
    bits->over = 1;
    return 0;
}

/* For 2 x 2 blocks at once, two bits each. */
static uint32_t take_prediction(slice *s)
{
    if (s->prediction_run) {
        --s->prediction_run;
        return s->last_prediction;
    }
    const uint32_t symbol = gtx_huffman_take(&s->bits, &s->book->prediction);
    if (symbol == REPEAT_PREDICTION)
        s->prediction_run = take_number(&s->bits, 4) + MIN_PREDICTION_RUN - 1;
    else
        s->last_prediction = symbol & 255;
    return s->last_prediction;
}

/* `corner` is the endpoint above and to the left. */
static uint32_t take_endpoint(slice *s, uint32_t x, uint32_t y, uint32_t corner)
{
    if (!(x & 1)) {
        if (!(y & 1)) {
            s->prediction = take_prediction(s);
            s->below[x / 2] = (uint8_t)(s->prediction >> 4);
        } else {
            s->prediction = s->below[x / 2];
        }
    }
    const uint32_t from = s->prediction & 3;
    s->prediction >>= 2;
    if ((from != 1 && from != 3 && !x) || ((from == 1 || from == 2) && !y))
        s->bits.over = 1; /* there is no block on that side */
    uint32_t endpoint = from == 0 ? s->endpoint : from == 1 ? s->above[x] : corner;
    if (from == 3) {
        endpoint = s->endpoint + gtx_huffman_take(&s->bits, &s->book->delta);
        endpoint -= endpoint >= s->book->endpoint_count ? s->book->endpoint_count : 0;
    }
    if (endpoint >= s->book->endpoint_count)
        s->bits.over = 1;
    return s->endpoint = s->bits.over ? 0 : endpoint;
}

/* One that was used: it moves half way to the front. */
static uint32_t used_selector(slice *s, uint32_t place)
{
    if (place >= s->book->history_size) {
        s->bits.over = 1;
        return 0;
    }
    const uint32_t selector = s->history[place];
    s->history[place] = s->history[place / 2];
    s->history[place / 2] = selector;
    return selector;
}

static uint32_t take_selector(slice *s)
{
    const uint32_t known = s->book->selector_count;
    uint32_t symbol = known;
    if (s->selector_run) {
        --s->selector_run;
    } else {
        symbol = gtx_huffman_take(&s->bits, &s->book->selector);
        if (symbol == known + s->book->history_size) {
            const uint32_t run = gtx_huffman_take(&s->bits, &s->book->run);
            s->selector_run = MIN_SELECTOR_RUN - 1 +
                              (run == LONG_SELECTOR_RUN ? take_number(&s->bits, 7) : run);
            symbol = known;
        }
    }
    if (symbol >= known)
        return used_selector(s, symbol - known);
    if (s->book->history_size) {
        s->history[s->rover++] = symbol;
        if (s->rover == s->book->history_size)
            s->rover /= 2;
    }
    return symbol;
}

static uint8_t clamped(int value)
{
    return (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
}

/* Into the colours, or, of the slice of alpha, into that. */
static void put_block(const gtx_basis_image *image, uint32_t x, uint32_t y, const ends *e,
                      uint32_t selector, int is_alpha, uint8_t *pixels)
{
    static const int16_t steps[8][2] = {{2, 8},   {5, 17},  {9, 29},  {13, 42},
                                        {18, 60}, {24, 80}, {33, 106}, {47, 183}};
    for (uint32_t i = 0; i < 16; ++i, selector >>= 2) {
        const uint32_t column = 4 * x + i % 4, row = 4 * y + i / 4, value = selector & 3;
        if (column >= image->width || row >= image->height)
            continue;
        const int size = steps[e->table][value == 0 || value == 3];
        uint8_t *p = pixels + 4 * ((size_t)row * image->width + column);
        for (int c = 0; c < 3; ++c) {
            const int base = e->rgb[c] << 3 | e->rgb[c] >> 2;
            if (!is_alpha || c == 1) /* alpha is green, where it is not grey */
                p[is_alpha ? 3 : c] = clamped(value < 2 ? base - size : base + size);
        }
    }
}

static void read_blocks(slice *s, const gtx_basis_image *image, int is_alpha, uint8_t *pixels)
{
    for (uint32_t y = 0; 4 * (uint64_t)y < image->height; ++y)
        for (uint32_t x = 0, corner = 0, next; x < s->columns; ++x, corner = next) {
            next = s->above[x];
            const uint32_t endpoint = take_endpoint(s, x, y, corner);
            s->above[x] = (uint16_t)endpoint;
            const uint32_t selector = take_selector(s);
            if (s->bits.over || selector >= s->book->selector_count) {
                s->bits.over = 1;
                return;
            }
            put_block(image, x, y, &s->book->endpoints[endpoint], s->book->selectors[selector],
                      is_alpha, pixels);
        }
}

static gtx_result read_slice(const gtx_basis_image *image, const codebook *book,
                             const uint8_t *place, int is_alpha, uint8_t *pixels, gtx_error *error)
{
    const uint64_t offset = u32(place), size = u32(place + 4);
    if (offset + size > image->level_size)
        return fail(error, "the data");
    slice s = {.bits = {image->level + offset, (size_t)size, 0, 0}, .book = book,
               .columns = (image->width + 3) / 4, .rover = book->history_size / 2};
    s.history = calloc(book->history_size + 1, sizeof *s.history);
    s.above = calloc(s.columns, sizeof *s.above);
    s.below = calloc(s.columns / 2 + 1, 1);
    const int whole = s.history && s.above && s.below;
    if (whole)
        read_blocks(&s, image, is_alpha, pixels);
    free(s.history);
    free(s.above);
    free(s.below);
    if (!whole)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the image");
    return s.bits.over ? fail(error, "the data") : GTX_OK;
}

gtx_result gtx_etc1s_decode(const gtx_basis_image *image, uint8_t *pixels, gtx_error *error)
{
    codebook *book = calloc(1, sizeof *book);
    if (!book)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the image");
    gtx_result result = read_codebook(image, book, error);
    const uint8_t *first = image->global + GLOBAL_HEADER;
    if (!result && u32(first) & IS_P_FRAME)
        result = gtx_fail(error, GTX_ERROR_UNSUPPORTED, "a frame of a film is no image");
    memset(pixels, 255, 4 * (size_t)image->width * image->height);
    if (!result)
        result = read_slice(image, book, first + 4, 0, pixels, error);
    if (!result && image->has_alpha)
        result = read_slice(image, book, first + 12, 1, pixels, error);
    free(book->endpoints);
    free(book->selectors);
    free(book);
    return result;
}
