/* Checking the rules of format/gtx.md, for opening, validating and creating alike. */
#ifndef GTX_ASSET_CHECK_H
#define GTX_ASSET_CHECK_H

#include "asset/asset.h"
#include "asset/section.h"
#include "base/error.h"
#include "base/limits.h"

#include <stdbool.h>

typedef enum gtx_rule {
#define GTX_RULE(number, id, name, result, sentence) GTX_RULE_##id = number,
#include "asset/rules.def"
#undef GTX_RULE
} gtx_rule;

/* A run of checks. The first broken rule fills `error`; every one is reported to `fn`. */
typedef struct gtx_check {
    gtx_issue_fn fn;              /* may be NULL */
    void *user;
    gtx_error *error;             /* may be NULL */
    bool keep_going;              /* go on after a broken rule, where that is safe */
    bool in_file;                 /* offsets are offsets in a file */
    bool beginning;               /* only the beginning of a file is there */
    gtx_result result;            /* of the first broken rule or failure */
    uint64_t broken;              /* rules broken so far */
    bool failed;                  /* another failure: of memory, or a limit */
} gtx_check;

/* Reports a broken rule: its sentence, followed by what was found instead. */
void gtx_break(gtx_check *check, gtx_rule rule, uint64_t offset, const char *format, ...)
    GTX_PRINTF(4, 5);

/* Ends the run for another reason than a broken rule. */
void gtx_check_fail(gtx_check *check, gtx_result result, const char *format, ...) GTX_PRINTF(3, 4);

/* Ends it because `what` would exceed a limit. */
void gtx_check_limit(gtx_check *check, gtx_limited which, const char *what, uint64_t wanted,
                     uint64_t allowed);

/* Whether the run is over. */
static inline bool gtx_check_over(const gtx_check *check)
{
    return check->failed || (check->broken && !check->keep_going);
}

/* The checked content of a file's header and section table. */
typedef struct gtx_layout {
    gtx_info info;
    gtx_section sections[GTX_MAX_SECTIONS];
    uint32_t section_count;
    bool known;                   /* the sections can be read */
} gtx_layout;

/* Checks the first bytes of a file: whether they are an asset's, and whether it is complete.
 * `file_size` is 0 if it is not known yet. */
void gtx_check_head(gtx_check *check, const uint8_t *data, size_t size, uint64_t file_size);

/* Checks header, table and padding of a file, or of the part of it that is there. */
void gtx_check_file(gtx_check *check, const uint8_t *data, uint64_t size, gtx_layout *out);

/* Checks the values of the header that an asset keeps, except emission_scale. False if sizes must
 * not be computed from them. */
bool gtx_check_info(gtx_check *check, const gtx_info *info);

/* emission_scale, once it is known whether there is emission. */
void gtx_check_emission(gtx_check *check, const gtx_info *info);

/* One bit per block of 2^(mip_count-1) x 2^(mip_count-1) texels of all pages, page by page: set if
 * a rectangle covers it. */
typedef struct gtx_occupancy {
    uint64_t *words;
    size_t word_count;
    uint32_t shift;               /* log2 of the block's side */
    uint32_t width, height;       /* blocks of a page */
} gtx_occupancy;

/* Bytes of the occupancy of an asset. */
uint64_t gtx_occupancy_size(const gtx_info *info);

/* Checks patch records, rectangles and their overlap. `offset` is that of the first record. Fills
 * `out`, to be freed with gtx_occupancy_free; it stays empty if rectangles are wrong. */
void gtx_check_patches(gtx_check *check, const gtx_asset *asset, uint64_t offset,
                       gtx_occupancy *out);
void gtx_occupancy_free(gtx_occupancy *occupancy, const gtx_allocator *allocator);

/* Whether patch `index` keeps the per-patch rules of gtx_check_maps, which may then skip it. */
bool gtx_patch_holds(const gtx_asset *asset, uint32_t index);

/* Offsets of the patch records and of the height section in the file, and whether the codes are
 * stored there uncompressed. */
typedef struct gtx_map_places {
    uint64_t patches, height;
    bool height_stored;
} gtx_map_places;

/* Checks heights against patches: coverage, spheres, bounds, codes outside. `holds` has a byte per
 * patch, 1 if gtx_patch_holds; or is NULL. */
void gtx_check_maps(gtx_check *check, const gtx_asset *asset, const gtx_occupancy *occupancy,
                    const uint8_t *holds, const gtx_map_places *places);

/* Checks an LOD mesh, after the finer one and if no patch broke a rule. `offset` is that of its
 * section. */
void gtx_check_lod(gtx_check *check, const gtx_asset *asset, uint32_t level, uint64_t offset);

/* Checks the text of META. */
void gtx_check_meta(gtx_check *check, const char *meta, size_t size, uint64_t offset);

#endif
