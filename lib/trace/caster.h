/* The inside of a gtx_caster: sheets (one a patch), and a hierarchy of boxes over them. */
#ifndef GTX_TRACE_CASTER_H
#define GTX_TRACE_CASTER_H

#include "asset/asset.h"

#include <stdbool.h>

/* Lowest and highest code of the solid cells under a node, their far edges included; an empty node
 * has min > max. */
typedef struct gtx_range {
    uint16_t min, max;
} gtx_range;

enum { GTX_MAX_TREE = 16 }; /* levels of a min-max tree: a page side has 14 bits */

/* One patch, cast at its level of detail. Grid space: x and y in texels of level 0 (texel i at
 * x = i), z in codes. The map from object space is affine, so t means the same in both.
 * Node (i, j) of tree level l covers cells (i << l) .. ((i + 1) << l) - 1 of the detail level. */
typedef struct gtx_sheet {
    double to_grid[3][4];       /* rows: linear part and translation */
    double low[3], high[3];     /* box of the solid cells in grid space; low[0] > high[0]: none */
    float normal_frame[3][3];   /* rows x', y', z' */
    uint32_t width, height;     /* texels of level 0 */
    uint32_t level;             /* of detail */
    double trim_limit;          /* code of the trim map at the limit of that level */
    uint32_t nodes_x;           /* row length of `code` */
    uint32_t levels;            /* of the tree; the last has one node */
    uint32_t tree_width[GTX_MAX_TREE];
    gtx_range *tree[GTX_MAX_TREE];
    uint16_t *code;             /* nodes of the detail level */
    uint8_t *trim, *normal;     /* texels of level 0 */
    bool two_sided;
} gtx_sheet;

/* A node of the hierarchy: `count` sheets order[first..] in a leaf, or (count = 0) two children at
 * nodes[first] and nodes[first + 1]. */
typedef struct gtx_bvh_node {
    float low[3], high[3];
    uint32_t first, count;
} gtx_bvh_node;

enum { GTX_BVH_DEPTH = 64 };

typedef struct gtx_bvh {
    gtx_bvh_node *nodes;
    uint32_t *order;
    uint32_t node_count, sheet_count; /* of `order` */
} gtx_bvh;

struct gtx_caster {
    gtx_allocator allocator;
    uint32_t sheet_count;
    gtx_sheet *sheets;
    gtx_bvh bvh;
    /* What the sheets point into. */
    uint16_t *code;
    gtx_range *ranges;
    uint8_t *trim, *normal;
    size_t code_count, range_count, texel_count;
};

/* A ray in double; in object space, or in the grid space of a sheet. */
typedef struct gtx_line {
    double origin[3], direction[3];
    double t_min, t_max;
} gtx_line;

/* A crossing that was accepted. */
typedef struct gtx_crossing {
    double t;                   /* the ray's t_max when there is none */
    uint32_t sheet;             /* UINT32_MAX when there is none */
    double x, y;                /* texels of level 0 */
    bool back;
} gtx_crossing;

/* A cell of the detail level as a bilinear patch over [x0, x1] x [y0, y1]:
 * z = c + cx u + cy v + cxy u v, with u and v in 0..1. */
typedef struct gtx_cell {
    double x0, x1, y0, y1;
    double c, cx, cy, cxy;
} gtx_cell;

/* sheet.c: sheets, all at one level or each at its coarsest within an error, and what is looked up
 * in them. */
gtx_result gtx_sheets_build(gtx_caster *caster, const gtx_asset *asset, uint32_t level,
                            double max_error, gtx_error *error);
void gtx_sheets_free(gtx_caster *caster);
gtx_line gtx_sheet_line(const gtx_sheet *sheet, const gtx_line *ray);
gtx_cell gtx_sheet_cell(const gtx_sheet *sheet, uint32_t i, uint32_t j);
/* Whether the trim map shows the sheet at (x, y). */
bool gtx_sheet_shows(const gtx_sheet *sheet, double x, double y);
/* The unit normals at (x, y) in object space: of the map, and of the surface of a cell. */
void gtx_sheet_normal(const gtx_sheet *sheet, double x, double y, float out[3]);
void gtx_sheet_facet(const gtx_sheet *sheet, const gtx_cell *cell, double x, double y,
                     float out[3]);

/* hierarchy.c */
gtx_result gtx_bvh_build(gtx_bvh *bvh, const gtx_sheet *sheets, uint32_t count,
                         const gtx_allocator *allocator, gtx_error *error);
void gtx_bvh_free(gtx_bvh *bvh, const gtx_allocator *allocator);

/* walk.c and exhaustive.c: the first accepted crossing of one sheet with t_min <= t < best->t
 * replaces *best (t = best->t too, when the sheet's index is lower). `both` accepts crossings from
 * below. */
void gtx_walk_sheet(const gtx_caster *caster, uint32_t sheet, const gtx_line *ray, bool both,
                    gtx_crossing *best);
void gtx_search_sheet(const gtx_caster *caster, uint32_t sheet, const gtx_line *ray, bool both,
                      gtx_crossing *best);

#endif
