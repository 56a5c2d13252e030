/* The rules of format/gtx.md: one way of checking for opening, validating and creating. */
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

/* A run of checks. The first broken rule fills `error`; `fn` hears of every one. */
typedef struct gtx_check {
    gtx_issue_fn fn;              /* may be NULL */
    void *user;
    gtx_error *error;             /* may be NULL */
    bool keep_going;              /* look for more after a broken rule, where that is safe */
    bool in_file;                 /* offsets mean something */
    bool beginning;               /* of a file: its end may be missing */
    gtx_result result;            /* of what came first: a broken rule, or a failure */
    uint64_t broken;              /* rules broken so far */
    bool failed;                  /* something else went wrong: memory, a limit */
} gtx_check;

/* Reports a broken rule: its sentence, followed by what was found instead. */
void gtx_break(gtx_check *check, gtx_rule rule, uint64_t offset, const char *format, ...)
    GTX_PRINTF(4, 5);

/* Ends the run for a reason that is no rule. */
void gtx_check_fail(gtx_check *check, gtx_result result, const char *format, ...) GTX_PRINTF(3, 4);

/* Ends it because `what` would take more than is allowed. */
void gtx_check_limit(gtx_check *check, gtx_limited which, const char *what, uint64_t wanted,
                     uint64_t allowed);

/* Whether the run is over. */
static inline bool gtx_check_over(const gtx_check *check)
{
    return check->failed || (check->broken && !check->keep_going);
}

/* What a file's header and table say, once they hold. */
typedef struct gtx_layout {
    gtx_info info;
    gtx_section sections[GTX_MAX_SECTIONS];
    uint32_t section_count;
    bool known;                   /* the sections can be read */
} gtx_layout;

/* What the first bytes of a file tell: that it is no asset, or not the whole of one. `file_size` is
 * 0 where it is not known yet. */
void gtx_check_head(gtx_check *check, const uint8_t *data, size_t size, uint64_t file_size);

/* Header, table and padding of a file, or of as much as is there. */
void gtx_check_file(gtx_check *check, const uint8_t *data, uint64_t size, gtx_layout *out);

/* The values of the header that an asset keeps, but for emission_scale. False when no size may be
 * computed from them. */
bool gtx_check_info(gtx_check *check, const gtx_info *info);

/* emission_scale, once it is known whether there is emission. */
void gtx_check_emission(gtx_check *check, const gtx_info *info);

/* One bit for each block of 2^(mip_count-1) x 2^(mip_count-1) texels of all pages, page by page:
 * set where a rectangle lies. */
typedef struct gtx_occupancy {
    uint64_t *words;
    size_t word_count;
    uint32_t shift;               /* log2 of the block's side */
    uint32_t width, height;       /* blocks a page */
} gtx_occupancy;

/* Bytes that the occupancy of such an asset takes. */
uint64_t gtx_occupancy_size(const gtx_info *info);

/* Patch records, rectangles and their overlap. `offset` is that of the first record. Fills
 * `out`, to be freed with gtx_occupancy_free; it stays empty when rectangles are wrong. */
void gtx_check_patches(gtx_check *check, const gtx_asset *asset, uint64_t offset,
                       gtx_occupancy *out);
void gtx_occupancy_free(gtx_occupancy *occupancy, const gtx_allocator *allocator);

/* Whether patch `index` holds the rules that gtx_check_maps looks at for each: then it need not. */
bool gtx_patch_holds(const gtx_asset *asset, uint32_t index);

/* Where patch records and the height section lie in the file, and whether codes lie there as
 * such. */
typedef struct gtx_map_places {
    uint64_t patches, height;
    bool height_stored;
} gtx_map_places;

/* Heights against patches: coverage, spheres, bounds, codes outside. `holds`, or NULL, has a byte a
 * patch that is 1 where it is known to hold. */
void gtx_check_maps(gtx_check *check, const gtx_asset *asset, const gtx_occupancy *occupancy,
                    const uint8_t *holds, const gtx_map_places *places);

/* An LOD mesh, once the finer one is there, and patches that broke no rule. `offset`
 * is that of its section. */
void gtx_check_lod(gtx_check *check, const gtx_asset *asset, uint32_t level, uint64_t offset);

/* META's text. */
void gtx_check_meta(gtx_check *check, const char *meta, size_t size, uint64_t offset);

#endif
