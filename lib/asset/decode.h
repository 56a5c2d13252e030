/* Decoding the sections of a file, in jobs that may run at the same time. */
#ifndef GTX_ASSET_DECODE_H
#define GTX_ASSET_DECODE_H

#include "asset/codec.h"

/* A section on its way into the asset. */
typedef struct gtx_part {
    uint32_t index;               /* in the file's table */
    const gtx_section *section;
    const uint8_t *bytes;         /* as the file has them */
    void *decoder;                /* of zstd; NULL where the section is stored */
    uint8_t *coded;               /* decompressed; NULL where `out` is good for that */
    uint8_t *out;                 /* in the asset; zeros once something is wrong */
    const char *wrong;            /* why it cannot be decoded, or NULL */
    uint64_t hash;                /* of what was decoded */
    bool holds;                   /* an LOD mesh: it breaks no rule */
    gtx_layer layer;              /* of filter 4 */
} gtx_part;

/* What is decoded, and one block of memory for it. */
typedef struct gtx_decoding {
    const gtx_jobs *jobs;         /* or NULL */
    gtx_part parts[GTX_MAX_KNOWN_SECTIONS]; /* in the order of the file, that of patches first */
    uint32_t part_count;
    bool hashed, zstd;            /* hashes are wanted; some part is compressed */
    uint64_t size;                /* of the block */
    uint8_t *block;
    uint8_t *marks;               /* of filter 4, all levels, or NULL */
    uint8_t *holds;               /* a byte a patch: 1 where gtx_patch_holds */
    gtx_asset *asset;
} gtx_decoding;

/* What decoding a file takes whose table holds, and which lives on; `jobs` may be NULL. */
void gtx_decoding_plan(gtx_decoding *out, const gtx_section *sections, uint32_t count,
                       const gtx_info *info, const gtx_jobs *jobs);

/* Makes room, for the bytes of a file and an asset of their own. False when memory is out. */
bool gtx_decoding_begin(gtx_decoding *decoding, gtx_asset *asset, const uint8_t *data);
void gtx_decoding_end(gtx_decoding *decoding, const gtx_allocator *allocator);

/* Decodes the patches. */
void gtx_decode_patches(gtx_decoding *decoding);

/* Decodes all others; and finds which patches and LOD meshes hold, for their checks to be
 * left out. Filter 4 needs rectangles that hold and heights: maps stay as they are without. LOD
 * meshes hold only where the patches do. */
void gtx_decode_rest(gtx_decoding *decoding, bool rectangles_hold, bool patches_hold);

/* Whether the part was, or will be, decoded. */
bool gtx_part_known(const gtx_decoding *decoding, const gtx_part *part, bool rectangles_hold);

#endif
