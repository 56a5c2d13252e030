/* The inside of gtx_combine: the remaining piece of each patch, and the asset of all pieces. */
#ifndef GTX_EDIT_COMBINE_H
#define GTX_EDIT_COMBINE_H

#include "edit/edit.h"
#include "trace/solid/solid.h"

/* Which parts of an asset's surface bound the result: those inside the other asset or those
 * outside, and those that coincide with its surface, facing the same or the opposite way. */
typedef struct gtx_keep {
    bool inside, alike, opposed;
    bool turned;              /* the surface is reversed */
    float inset;              /* texels by which the outline is moved inwards */
} gtx_keep;

/* One of the two assets, and the other one that cuts it. */
typedef struct gtx_operand {
    const gtx_asset *asset;
    const gtx_solid *other;
    double shift[3];          /* from its own coordinates to the other's */
    gtx_keep keep;
} gtx_operand;

/* The remaining part of a patch. */
typedef struct gtx_piece {
    uint8_t *trim;            /* a code for each texel of the patch's rectangle; NULL: as it was */
    uint8_t *kept;            /* likewise, whether the height code stays */
    uint32_t low[2], size[2]; /* the part of the rectangle that stays; size 0: none */
    uint64_t steps;           /* of work, that cutting took */
    double error;             /* distance of the outline from the true crossing, object units */
    gtx_result result;        /* MEMORY or OK */
} gtx_piece;

/* cut.c: which texels of a patch stay, and where the cut crosses the edges of cells. */
enum { GTX_NO_LABEL = 0, GTX_DROPPED = 1, GTX_KEPT = 2 };
typedef struct gtx_cut {
    const gtx_operand *operand;
    const gtx_patch *patch;
    uint32_t width, height;
    double apart;             /* distance within which surfaces coincide, object units */
    uint8_t *label;           /* of each texel */
    bool coincided;
    uint64_t steps, left;     /* of work: done; the most that may be done */
} gtx_cut;
void gtx_cut_point(const gtx_cut *cut, double x, double y, double out[3]);
void gtx_cut_label(gtx_cut *cut);
/* Whether the place (x, y) on the surface, in texels, stays. */
bool gtx_cut_keeps(gtx_cut *cut, double x, double y);

/* outline.c: cuts a patch; the piece's arrays are of `hooks`. Any thread. */
gtx_piece gtx_cut_patch(const gtx_operand *operand, uint32_t patch, uint32_t grain, uint64_t left,
                        const gtx_allocator *hooks);
void gtx_free_piece(const gtx_operand *operand, uint32_t patch, gtx_piece *piece,
                    const gtx_allocator *hooks);

/* pieces.c: makes an asset of the pieces of both; `info` has its maps and their precision. Errors:
 * MEMORY, LIMIT. */
gtx_result gtx_join_pieces(const gtx_operand operands[2], gtx_piece *const pieces[2],
                           const gtx_info *info, const char *meta, size_t meta_size,
                           const gtx_allocator *hooks, gtx_asset **out, gtx_error *error);

#endif
