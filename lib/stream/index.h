/* The index of a world, format/world.md: bytes and back. */
#ifndef GTX_STREAM_INDEX_H
#define GTX_STREAM_INDEX_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { GTX_INDEX_HEADER = 40, GTX_INDEX_RECORD = 136, GTX_INDEX_NAME = 24 };
#define GTX_INDEX_MAX_TILES (1u << 20)
#define GTX_INDEX_FILE "tiles.gtw"

/* First bytes of a file: how many, their XXH64, and what opening them takes. */
typedef struct gtx_index_part {
    uint64_t bytes, hash, memory;
} gtx_index_part;

typedef struct gtx_index_tile {
    double low[3], high[3];
    float error, beginning_error;
    uint32_t parent;
    gtx_index_part whole, beginning; /* the latter of 0 bytes: there is none */
    char name[GTX_INDEX_NAME];    /* terminated, zeros behind */
} gtx_index_tile;

/* Checks the header and the size, and gives count and unit. Errors: NOT_GTX, VERSION, TRUNCATED,
 * CORRUPT. */
gtx_result gtx_index_check(const uint8_t *data, size_t size, uint32_t *count, double *unit,
                           gtx_error *error);

/* Tile `number` of bytes that gtx_index_check passed. `tile` holds those before it already.
 * Errors: CORRUPT. */
gtx_result gtx_index_read(const uint8_t *data, gtx_index_tile *tile, uint32_t number,
                          gtx_error *error);

/* GTX_INDEX_HEADER + count * GTX_INDEX_RECORD bytes. */
void gtx_index_write(const gtx_index_tile *tiles, uint32_t count, double unit, uint8_t *out);

#ifdef __cplusplus
}
#endif
#endif
