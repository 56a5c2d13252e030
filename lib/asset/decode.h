/* Decoding the sections of a file, in jobs that may run in parallel. */
#ifndef GTX_ASSET_DECODE_H
#define GTX_ASSET_DECODE_H

#include "asset/codec.h"

/* A section that is being decoded into the asset. */
typedef struct gtx_part {
    uint32_t index;               /* in the file's table */
    const gtx_section *section;
    const uint8_t *bytes;         /* in the file */
    void *decoder;                /* of zstd; NULL if the section is stored */
    uint8_t *coded;               /* decompressed bytes; NULL if `out` serves for them */
    uint8_t *out;                 /* in the asset; zeros if the section is invalid */
    const char *wrong;            /* why it cannot be decoded, or NULL */
    uint64_t hash;                /* of the decoded bytes */
    bool holds;                   /* an LOD mesh that breaks no rule */
    gtx_layer layer;              /* of filter 4 */
} gtx_part;

/* The parts of a file, and one block of memory for decoding them. */
typedef struct gtx_decoding {
    const gtx_jobs *jobs;         /* or NULL */
    gtx_part parts[GTX_MAX_KNOWN_SECTIONS]; /* patches first, if any, then as in the file */
    uint32_t part_count;
    bool hashed, zstd;            /* hashes are computed; some part is compressed */
    uint64_t size;                /* of the block */
    uint8_t *block;
    uint8_t *marks;               /* of filter 4, all levels, or NULL */
    uint8_t *holds;               /* a byte per patch: 1 if gtx_patch_holds */
    gtx_asset *asset;
} gtx_decoding;

/* Plans decoding a file with a valid table, which must outlive it; `jobs` may be NULL. */
void gtx_decoding_plan(gtx_decoding *out, const gtx_section *sections, uint32_t count,
                       const gtx_info *info, const gtx_jobs *jobs);

/* Allocates the block, for decoding `data` into `asset`. False when memory is out. */
bool gtx_decoding_begin(gtx_decoding *decoding, gtx_asset *asset, const uint8_t *data);
void gtx_decoding_end(gtx_decoding *decoding, const gtx_allocator *allocator);

/* Decodes the patches; of a beginning that has none, what is there instead. */
void gtx_decode_patches(gtx_decoding *decoding);

/* Decodes all other parts, and finds out which patches and LOD meshes are valid, so that checks can
 * skip them. Filter 4 needs valid rectangles and heights: without these, maps are left as they are.
 * LOD meshes are valid only if the patches are. */
void gtx_decode_rest(gtx_decoding *decoding, bool rectangles_hold, bool patches_hold);

/* Whether the part was, or will be, decoded. */
bool gtx_part_known(const gtx_decoding *decoding, const gtx_part *part, bool rectangles_hold);

#endif
