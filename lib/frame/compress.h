/* Encodes the maps of a model as compressed textures: BC, or ETC2 and EAC. */
#ifndef GTX_FRAME_COMPRESS_H
#define GTX_FRAME_COMPRESS_H

#include "asset/asset.h"
#include "frame/units.h"

#include <stdbool.h>

/* How a unit's map is stored. */
typedef struct gtx_storage {
    gtx_format format;
    uint32_t texel_size, block_size; /* one of them is 0 */
} gtx_storage;

/* Of colours, whether they are opaque all over. */
gtx_storage gtx_storage_of(uint32_t unit, gtx_compression compress, bool opaque);
/* The number that files have for it: a VkFormat; 0 where it is no format of blocks. */
uint32_t gtx_block_number(gtx_format format);
/* Of formats that are blocks, bytes of one. */
uint32_t gtx_block_size(gtx_format format);

/* A level of a map, or the rows of blocks of it that are wanted. */
typedef struct gtx_block_rows {
    gtx_format format;
    uint32_t level, width, height;   /* of a page at the level */
    const uint8_t *texels;           /* of the level, all pages */
    uint32_t channels;               /* bytes a texel */
    uint32_t page, first, end;       /* rows of blocks */
    uint32_t left, right;            /* blocks of them */
    uint8_t *out;                    /* the first block; rows follow without gaps */
} gtx_block_rows;

/* Texels that nothing shows have no part in what is lost. */
void gtx_compress_rows(const gtx_asset *asset, const gtx_block_rows *rows);

#endif
