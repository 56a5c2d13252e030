/* Height fields drawn as displaced grids: which blocks of their cells are in view, and their
 * triangles. */
#ifndef GTX_FRAME_GRID_H
#define GTX_FRAME_GRID_H

#include "frame/frustum.h"
#include "frame/plan.h"
#include "frame/scratch.h"

/* A point of a patch's level 0, as geotex_lod.vert reads it: a node, or a place between nodes. */
typedef struct gtx_grid_vertex {
    uint16_t x, y;            /* in parts of a cell, GTX_GRID_PARTS a side */
    uint16_t code, rest;      /* rest: the height above the code, GTX_GRID_PARTS^2 to a code */
    uint32_t patch;
} gtx_grid_vertex;

enum { GTX_GRID_PARTS = 4 };

/* In grid space. */
static inline void gtx_grid_place(const gtx_grid_vertex *v, double out[3])
{
    const double parts = GTX_GRID_PARTS;
    out[0] = v->x / parts;
    out[1] = v->y / parts;
    out[2] = v->code + v->rest / (parts * parts);
}

/* fmax is a call. */
static inline double gtx_grid_greater(double a, double b)
{
    return a > b ? a : b;
}

/* Drawn alike: first those seen from the front, then those from behind; of either those that show
 * whole, which leave the depth test first, then others; of these first those that may be lit at
 * their vertices, then those whose pixels look maps up. */
enum { GTX_GRID_MAPPED = 1, GTX_GRID_TRIMMED = 2, GTX_GRID_BEHIND = 4, GTX_GRID_LOOKS = 8 };

/* A block whose nodes the GPU displaces, of any level, as geotex_lod.vert reads it: its patch +
 * 2^28 times the level, and its first node. Drawn alike: those that show whole, those that do not,
 * and of either those of patches that are seen from two sides. */
typedef struct gtx_displaced_block {
    uint32_t patch;
    uint16_t x, y;
} gtx_displaced_block;

enum {
    GTX_BLOCKS_TRIMMED = 1, GTX_BLOCKS_TWO_SIDED = 2, GTX_BLOCK_LOOKS = 4,
    GTX_BLOCK_TRIANGLES = 2 * GTX_SLAB_CELLS * GTX_SLAB_CELLS
};

/* What is drawn of one instance: vertices, and corners of triangles by their looks; or blocks. */
typedef struct gtx_grids {
    gtx_scratch blocks[GTX_BLOCK_LOOKS];
    uint32_t block_count[GTX_BLOCK_LOOKS];
    uint16_t block_indices[3 * GTX_BLOCK_TRIANGLES]; /* of any block */
    gtx_scratch vertices, indices[GTX_GRID_LOOKS], slots, covers, shown;
    uint32_t vertex_count, index_count[GTX_GRID_LOOKS];
    gtx_rtin_triangle triangles[GTX_RTIN_TRIANGLES];
    uint64_t drawn;           /* triangles so far: tests look at them */
} gtx_grids;

/* How much they hold. */
typedef struct gtx_grids_state {
    uint32_t vertices, indices[GTX_GRID_LOOKS];
} gtx_grids_state;

/* refine.c: a patch while its triangles are found. */
typedef struct gtx_refining {
    const gtx_allocator *hooks;
    gtx_grids *grids;
    const gtx_rtin *rtin;
    const gtx_rtin_node *nodes;
    const gtx_rtin_block *blocks;
    const gtx_slab *slabs;    /* of level 0 */
    uint32_t patch, row;
    bool two_sided, mapped;   /* mapped: nothing is lit at vertices */
    int turn;                 /* of a triangle's corners: 0 or 1 */
    uint32_t depth;           /* levels that are halved: all by their errors, or some anyway */
    bool by_error;
    double w[4], eye[4];      /* of clip space, over grid space; and there */
    double reach[GTX_RTIN_LEVELS]; /* how much nearer may be what halving a middle
                                          changes */
    double scale;             /* w at which an error's unit is what the view allows */
    double code;              /* the same of a code; 0: no cell is divided */
    double reach_of_cell;
    double per_unit, per_twist; /* over the scale, and over that of a fourth of a code */
    double near;              /* w below which all triangles are to be lit at vertices */
} gtx_refining;

/* Begins a patch, with w of clip space as a linear function over its grid space, and the eye in
 * that. */
gtx_refining gtx_refine(const gtx_frustum *f, const gtx_model *model, uint32_t patch,
                        const double w[4], const double eye[4], gtx_grids *grids,
                        const gtx_allocator *hooks);
/* Adds the triangles of a block. False without memory. */
bool gtx_refine_block(const gtx_refining *r, uint32_t column, uint32_t row);

/* What is halved of a level in a block, wherever it is: middles of the error `all` and more, and of
 * less than `none` not; and rough ones. */
typedef struct gtx_halved {
    uint32_t all, none;
    uint16_t all_rough, any_rough; /* GTX_RTIN_ROUGH or 0 */
} gtx_halved;

/* Nodes of a block and around it, 16 a row: of those that there are none of, no cell is solid. */
enum {
    GTX_BLOCK_ROW = 16, GTX_BLOCK_NODES = GTX_BLOCK_ROW * (GTX_RTIN_CELLS + 3),
    GTX_BLOCK_PLACES = GTX_RTIN_CELLS * GTX_GRID_PARTS + 1
};

static inline uint32_t gtx_block_node(uint32_t x, uint32_t y)
{
    return GTX_BLOCK_ROW * (y + 1) + x + 1;
}

/* A block while its triangles are found. */
typedef struct gtx_refined {
    gtx_rtin_node nodes[GTX_BLOCK_NODES];
    uint8_t divided[GTX_BLOCK_NODES]; /* how the cell from each on is: see divide.c */
    bool found;               /* these are known, and slots of places between nodes are there: */
    uint32_t places[GTX_BLOCK_PLACES * GTX_BLOCK_PLACES]; /* their vertices */
    gtx_rtin_block shown;
    uint32_t x, y, *slots;    /* the first node */
    bool front;               /* the eye is above all triangles */
    uint32_t twist;           /* cells of no more are not divided */
    gtx_halved halved[GTX_RTIN_LEVELS];
} gtx_refined;

/* A place in parts of cells of a block, and its height, GTX_GRID_PARTS^2 a code. */
typedef struct gtx_grid_point {
    uint32_t x, y, z;
} gtx_grid_point;

/* divide.c: whether a cell of a block is divided, or sides of it are. */
bool gtx_is_divided(const gtx_refining *r, gtx_refined *b, const uint8_t cell[2]);
/* Cuts half of such a cell, of which the points begin with the corners, as those of a triangle,
 * into triangles that meet those over cells beside it. Finds the other points; returns which are
 * the corners of triangles, as digits. */
enum { GTX_HALF_POINTS = 9, GTX_HALF_TRIANGLES = 8 };
const char *gtx_divide_half(const gtx_refined *b, const uint8_t cell[2],
                            gtx_grid_point points[GTX_HALF_POINTS]);

/* mix.c: takes those patches out of the planner's plan that are drawn so, and those that they hide,
 * and fills its grids with the blocks of theirs that are in view and may face the eye, in the order
 * of the plan. Without memory they are cast; it is false when none can be drawn so. */
bool gtx_blocks_fill(const gtx_draw_call *draw, const gtx_model *model,
                     const gtx_instance_data *placed);

/* displace.c: fills in the triangles of blocks. */
void gtx_block_triangles(uint16_t out[3 * GTX_BLOCK_TRIANGLES]);
/* The same where the GPU displaces blocks; all that are seen of the patches that take
 * less so than cast. */
bool gtx_displace_fill(const gtx_draw_call *draw, const gtx_model *model,
                       const gtx_instance_data *placed);

void gtx_grids_free(gtx_grids *grids, const gtx_allocator *allocator);

#endif
