/* Huffman codes, whose lengths are packed by Huffman codes. */
#include "image/huffman.h"

#include <string.h>

enum { LENGTH_SYMBOLS = 21 };

/* False if there are more codes than their lengths leave room for. */
static int make_codes(gtx_huffman *h, const uint8_t *lengths, uint32_t symbols)
{
    uint32_t first[GTX_HUFFMAN_LENGTH + 2] = {0}, room = 1;
    memset(h->count, 0, sizeof h->count);
    for (uint32_t i = 0; i < symbols; ++i)
        ++h->count[lengths[i]];
    h->count[0] = 0;
    for (uint32_t n = 1; n <= GTX_HUFFMAN_LENGTH; ++n) {
        first[n + 1] = first[n] + h->count[n];
        room = 2 * room;
        if (h->count[n] > room)
            return 0;
        room -= h->count[n];
    }
    for (uint32_t i = 0; i < symbols; ++i)
        if (lengths[i])
            h->symbols[first[lengths[i]]++] = (uint16_t)i;
    return 1;
}

/* Where no code is found the bits are spoilt. */
uint32_t gtx_huffman_take(gtx_bits *bits, const gtx_huffman *h)
{
    uint32_t code = 0, first = 0, index = 0;
    for (uint32_t n = 1; n <= GTX_HUFFMAN_LENGTH; ++n) {
        code = code << 1 | gtx_take_bit(bits);
        if (code - first < h->count[n])
            return h->symbols[index + code - first];
        index += h->count[n];
        first = (first + h->count[n]) << 1;
    }
    bits->over = 1;
    return 0;
}

/* How often a length is repeated; *length is the one before, or becomes 0. */
static uint32_t take_run(gtx_bits *bits, uint32_t symbol, uint8_t *length)
{
    static const struct {
        uint8_t bits, least;
    } runs[] = {{3, 3}, {7, 11}, {2, 3}, {7, 7}};
    if (symbol < 17) {
        *length = (uint8_t)symbol;
        return 1;
    }
    if (symbol < 19)
        *length = 0;
    else if (!*length)
        bits->over = 1; /* nothing to repeat */
    return runs[symbol - 17].least + gtx_take_bits(bits, runs[symbol - 17].bits);
}

void gtx_huffman_read(gtx_bits *bits, gtx_huffman *out)
{
    static const uint8_t order[LENGTH_SYMBOLS] = {17, 18, 19, 20, 0, 8,  7, 9,  6, 10, 5,
                                                  11, 4,  12, 3,  13, 2, 14, 1, 15, 16};
    gtx_huffman of_lengths;
    uint8_t lengths[GTX_HUFFMAN_SYMBOLS], small[LENGTH_SYMBOLS] = {0}, length = 0;
    const uint32_t symbols = gtx_take_bits(bits, 14);
    memset(out->count, 0, sizeof out->count);
    if (!symbols)
        return;
    const uint32_t codes = gtx_take_bits(bits, 5);
    if (codes > LENGTH_SYMBOLS) {
        bits->over = 1;
        return;
    }
    for (uint32_t i = 0; i < codes; ++i)
        small[order[i]] = (uint8_t)gtx_take_bits(bits, 3);
    if (!make_codes(&of_lengths, small, LENGTH_SYMBOLS))
        bits->over = 1;
    for (uint32_t at = 0; at < symbols && !bits->over;) {
        const uint32_t run = take_run(bits, gtx_huffman_take(bits, &of_lengths), &length);
        if (run > symbols - at) {
            bits->over = 1;
            return;
        }
        memset(lengths + at, length, run);
        at += run;
    }
    if (!bits->over && !make_codes(out, lengths, symbols))
        bits->over = 1;
}
