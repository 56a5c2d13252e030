/* Which sections of a file have arrived: those that its first bytes hold, and those in pieces of
 * the rest. */
#ifndef GTX_ASSET_ARRIVAL_H
#define GTX_ASSET_ARRIVAL_H

#include "asset/check.h"
#include "asset/read.h"

typedef struct gtx_arrival {
    const uint8_t *data;                       /* the first bytes */
    uint64_t size;
    const gtx_file_part *pieces;
    uint32_t piece_count;
    bool patches;                              /* are there; else the coarsest LOD mesh alone is */
    bool normals;                              /* and heights are there, too */
    gtx_section parts[GTX_MAX_KNOWN_SECTIONS]; /* to decode: patches, LOD meshes, images */
    uint32_t part_count;
    int images[GTX_SECTION_META + 1];          /* the finest level of each kind, or -1 */
    uint32_t lods;                             /* LOD meshes that are there */
} gtx_arrival;

/* How many first bytes show more than `size`: to the end of the next section of those before
 * heights, of which patches show nothing alone; the whole file where there is none. */
uint64_t gtx_arrival_needed(const gtx_layout *layout, uint64_t size);

/* Fills in what has arrived of the bytes and pieces. Levels of LOD meshes count from the finest
 * that is there. */
void gtx_arrival_find(gtx_arrival *arrival, const gtx_layout *layout);

/* Keeps of each image the level that is nearest to `shift` and not finer and, where it has mip
 * levels, all coarser ones. */
void gtx_arrival_choose(gtx_arrival *arrival, uint32_t shift);

/* The bytes of a section; NULL where they are not there. */
const uint8_t *gtx_arrived_bytes(const gtx_arrival *arrival, const gtx_section *section);

#endif
