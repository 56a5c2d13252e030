/* The struct of a gtx_caster: a height field per patch, and a hierarchy over blocks of their
 * cells. */
#ifndef GTX_TRACE_CASTER_H
#define GTX_TRACE_CASTER_H

#include "asset/asset.h"
#include "derive/hierarchy.h"

#include <stdbool.h>

/* A patch's height field for casting: the codes of one level, with the frame, trim and normals that
 * a hit needs. Grid space: x and y in texels of level 0 (texel i at x = i), z in codes. The map
 * from object space is affine, so t is the same in both. */
typedef struct gtx_height_field {
    double to_grid[3][4];       /* rows: linear part and translation */
    float normal_frame[3][3];   /* rows x', y', z' */
    uint32_t width, height;     /* texels of level 0 */
    uint32_t level;             /* of the codes */
    double trim_limit;          /* greatest trim code that shows at that level */
    uint32_t nodes_x, nodes_y;
    uint32_t first_block, blocks_x;
    uint16_t *code;             /* of the nodes of the level */
    uint8_t *trim, *normal;     /* texels of level 0 */
    bool two_sided;
} gtx_height_field;

/* A block of a height field's cells: GTX_BLOCK x GTX_BLOCK, or fewer at its far edges. */
typedef struct gtx_block {
    uint64_t solid;             /* bit GTX_BLOCK * j + i: the cell (x + i, y + j) exists */
    uint32_t field;
    uint16_t x, y;
    uint16_t low, high;         /* codes of its cells */
} gtx_block;

struct gtx_caster {
    gtx_allocator allocator;
    uint32_t field_count, block_count;
    gtx_height_field *fields;
    gtx_block *blocks;          /* of each height field in rows; the hierarchy is over those that
                                   have a cell */
    gtx_hierarchy tree;
    double ray_offset;          /* of the asset, in object units */
    /* What the height fields point into. */
    uint16_t *code;
    uint8_t *trim, *normal;
    size_t code_count, texel_count;
};

enum { GTX_RAY_FLAGS = GTX_RAY_ANY | GTX_RAY_TWO_SIDED | GTX_RAY_EXHAUSTIVE };

/* A ray in double; in object space, or in the grid space of a height field. */
typedef struct gtx_line {
    double origin[3], direction[3];
    double t_min, t_max;
} gtx_line;

/* A crossing that was accepted. */
typedef struct gtx_crossing {
    double t;                   /* the ray's t_max when there is none */
    uint32_t field;             /* UINT32_MAX when there is none */
    double x, y;                /* texels of level 0 */
    bool back;
    uint64_t visited;           /* cells visited to find it */
} gtx_crossing;

/* A cell of the level as a bilinear patch over [x0, x1] x [y0, y1]:
 * z = c + cx u + cy v + cxy u v, with u and v in 0..1. */
typedef struct gtx_cell {
    double x0, x1, y0, y1;
    double c, cx, cy, cxy;
} gtx_cell;

/* field.c: builds height fields, all at one level or each at its coarsest level within an error,
 * and looks values up in them. */
gtx_result gtx_fields_build(gtx_caster *caster, const gtx_asset *asset,
                            const gtx_caster_desc *desc, gtx_error *error);
void gtx_fields_free(gtx_caster *caster);
gtx_line gtx_field_line(const gtx_height_field *field, const gtx_line *ray);
gtx_cell gtx_field_cell(const gtx_height_field *field, uint32_t i, uint32_t j);
bool gtx_field_solid(const gtx_caster *caster, const gtx_height_field *field, uint32_t i,
                     uint32_t j);
/* The code of the trim map at (x, y), and whether it shows the height field there. */
double gtx_field_trim(const gtx_height_field *field, double x, double y);
bool gtx_field_shows(const gtx_height_field *field, double x, double y);
/* The unit normals at (x, y) in object space: of the map, and of the surface of a cell. */
void gtx_field_normal(const gtx_height_field *field, double x, double y, float out[3]);
void gtx_field_facet(const gtx_height_field *field, const gtx_cell *cell, double x, double y,
                     float out[3]);

/* walk.c and exhaustive.c: the first accepted crossing of one block or height field, with
 * t_min <= t < best->t (t = best->t too, when the height field's index is lower), replaces *best.
 * `both` accepts crossings from below. `line` is the ray in the height field's grid space, `ray` in
 * object space. */
void gtx_walk_block(const gtx_caster *caster, const gtx_block *block, const gtx_line *line,
                    bool both, gtx_crossing *best);
void gtx_walk_field(const gtx_caster *caster, uint32_t field, const gtx_line *ray, bool both,
                    gtx_crossing *best);
void gtx_search_field(const gtx_caster *caster, uint32_t field, const gtx_line *ray, bool both,
                      gtx_crossing *best);

/* caster.c: converts a ray to double, false if by definition it hits nothing; finds its nearest
 * crossing, or any with GTX_RAY_ANY; and describes that in object space. */
bool gtx_read_ray(const gtx_ray *ray, gtx_line *out);
gtx_crossing gtx_cast_line(const gtx_caster *caster, const gtx_line *line, uint32_t flags);
gtx_hit gtx_describe(const gtx_caster *caster, const gtx_crossing *crossing);
/* Calls `fn` with the first crossing, from above or below, of every block that the ray hits, in no
 * particular order. A crossing on the border of two blocks is reported twice. Returns the number of
 * blocks that were tested. */
typedef void (*gtx_crossing_fn)(const gtx_crossing *crossing, void *user);
uint32_t gtx_cast_each(const gtx_caster *caster, const gtx_line *ray, gtx_crossing_fn fn,
                       void *user);

#endif
