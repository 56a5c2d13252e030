/* The Huffman codes of BasisLZ: those of Deflate (RFC 1951), of more symbols and up to 16 bits.
 * Inside of lib/image. */
#ifndef GTX_IMAGE_HUFFMAN_H
#define GTX_IMAGE_HUFFMAN_H

#include "image/bits.h"

enum { GTX_HUFFMAN_SYMBOLS = 16383, GTX_HUFFMAN_LENGTH = 16 };

/* Canonical codes: symbols by length, then by number. None at all where a table is empty. */
typedef struct gtx_huffman {
    uint16_t count[GTX_HUFFMAN_LENGTH + 1];
    uint16_t symbols[GTX_HUFFMAN_SYMBOLS];
} gtx_huffman;

/* Both set `over` of the bits where they find what no encoder writes. */
void gtx_huffman_read(gtx_bits *bits, gtx_huffman *out);
uint32_t gtx_huffman_take(gtx_bits *bits, const gtx_huffman *codes);

#endif
