/* The LOD mesh of a model: its levels as buffers, how one is chosen and how it is drawn. */
#ifndef GTX_FRAME_LOD_H
#define GTX_FRAME_LOD_H

#include "asset/asset.h"

#include <geotex/frame.h>
#include <stdbool.h>

/* A vertex on a border between patches is stored once for each of them. */
typedef struct gtx_lod_vertex {
    uint16_t position[3];
    uint16_t normal;          /* octahedral */
    uint32_t patch;
} gtx_lod_vertex;

/* The same of levels that are never lit by normals, where patches have few numbers. */
typedef struct gtx_lod_narrow_vertex {
    uint16_t position[3], patch;
} gtx_lod_narrow_vertex;

/* Consecutive patches with vertices of their own, few enough to be one draw: llvmpipe then takes
 * indices as they are and shades each vertex once. */
typedef struct gtx_lod_run {
    uint32_t end;             /* triangles of the level up to its own last one */
    uint32_t first_vertex, vertex_count;
} gtx_lod_run;

/* The plane of a triangle, and its corners, counted from one vertex for many runs. */
typedef struct gtx_lod_face {
    int8_t normal[3];
    int16_t offset;
    uint16_t corner[3];
} gtx_lod_face;

typedef struct gtx_lod_level {
    float place[4];           /* origin and step of the positions */
    float error;              /* object units; 0: as near to the source as height fields */
    bool lit;                 /* at its vertices, while the model has normals alone: the finest */
    bool far;                 /* its triangles span patches: not mixed with edited ones */
    uint32_t triangle_count;
    uint32_t *first;          /* triangles first[i]..first[i + 1] - 1 are those of patch order[i] */
    uint32_t *border;         /* from border[i] on they share a vertex with another patch */
    gtx_lod_run *runs;        /* room for a patch each; indices count from a run's first vertex */
    uint32_t run_count;
    gtx_lod_face *faces;      /* NULL, or all triangles, where what faces the eye is to be picked */
    float faces_middle[3], faces_radius; /* around them, in steps */
    uint32_t index_size;      /* bytes */
    uint32_t vertex_size;     /* of either kind */
    uint64_t vertex_offset, index_offset;
    uint64_t vertex_bytes;
    uint32_t source_vertices; /* in the asset's level */
    struct gtx_lod_copy *copies; /* of each of these, while the level is made */
    gtx_result result;        /* of measuring it */
} gtx_lod_level;

/* Meshes with more, as of leaves or dirty scans, are seldom seen from behind all of them. */
enum { GTX_MAX_OPENINGS = 64 };

typedef struct gtx_lod_opening {
    double out[3], middle[3]; /* the way out, unit, and the middle of the rim */
    double before;            /* how far before that the rim begins, along the way out */
    double steep;             /* the rim's extent along that way over its diameter */
} gtx_lod_opening;

/* All levels share one buffer of vertices and one of indices, the finest first. */
typedef struct gtx_lod_meshes {
    uint32_t level_count, patch_count;
    gtx_lod_level levels[GTX_MAX_LODS];
    uint32_t *order;          /* of the patches: those seen from the front alone come first */
    uint32_t one_sided;       /* how many */
    bool first_provokes;      /* as told: which vertex gives flat values, also of grids */
    bool light_vertices;      /* likewise: normals of vertices are enough */
    bool *edited;             /* a patch each: its height field has changed, and it must be cast */
    uint32_t edited_count;
    float low[3], high[3];    /* bounds in object space */
    bool solid;               /* with its openings closed the finest level bounds a volume */
    gtx_lod_opening openings[GTX_MAX_OPENINGS];
    uint32_t opening_count;
    /* Patches that share a vertex of the finest level with patch i:
     * neighbours[first_neighbour[i]]..neighbours[first_neighbour[i + 1] - 1]. */
    uint32_t *first_neighbour, *neighbours;
    uint32_t neighbour_count;
    uint8_t *vertices, *indices;  /* both freed once they are uploaded */
    uint64_t vertex_bytes, index_bytes, vertex_bytes_sent, index_bytes_sent;
    uint32_t vertex_buffer, index_buffer; /* names in OpenGL */
} gtx_lod_meshes;

/* Built in four steps: begin; measure each level; place, which allocates the buffers of all; fill
 * each level. Levels may be measured, and filled, in any order or in parallel. Whatever fails,
 * gtx_lod_free frees what was allocated. An asset without an LOD mesh has no levels. */
bool gtx_lod_begin(const gtx_asset *asset, const gtx_allocator *allocator, gtx_lod_meshes *out);
void gtx_lod_measure(const gtx_asset *asset, uint32_t level, const gtx_allocator *allocator,
                     gtx_lod_meshes *out);
/* Errors: MEMORY, CORRUPT. */
gtx_result gtx_lod_place(const gtx_allocator *allocator, gtx_lod_meshes *out, gtx_error *error);
void gtx_lod_fill(const gtx_asset *asset, uint32_t level, const gtx_allocator *allocator,
                  gtx_lod_meshes *out);
/* lod_normals.c: whether a level may be lit by normals of its vertices; normals made up for the
 * finest level of a file's beginning that has none, as a file has them, else, and without memory,
 * NULL; and of a level that is filled its normals, and whether they are enough. */
bool gtx_lod_may_be_lit(const gtx_asset *asset, uint32_t level, const gtx_lod_meshes *of);
uint8_t *gtx_lod_normals(const gtx_asset *asset, uint32_t level, const gtx_lod_mesh *source,
                         const gtx_allocator *allocator);
void gtx_lod_light(const gtx_asset *asset, uint32_t level, const gtx_lod_mesh *source,
                   gtx_lod_meshes *out);
/* lod_neighbours.c: of a model's finest level; `meetings` counts its vertices once for each patch
 * that has them. False without memory. */
bool gtx_lod_find_neighbours(const gtx_lod_mesh *source, uint32_t meetings,
                             const gtx_allocator *allocator, gtx_lod_meshes *out);
/* openings.c: of a model's finest level; nothing without memory. Afterwards whether nobody sees a
 * back of a level from an eye in front of all of it. */
struct gtx_frustum;
void gtx_lod_find_openings(const gtx_asset *asset, const gtx_allocator *allocator,
                           gtx_lod_meshes *out);
bool gtx_lod_hides_backs(const gtx_lod_meshes *lods, uint32_t level,
                         const struct gtx_frustum *f);
/* facing.c: the faces of levels of many triangles that are filled and have indices of 16 bits, in
 * an order of their own within what is drawn of a patch; none without memory. Whoever submits the
 * model's draws takes indices that they bring along. */
void gtx_lod_find_faces(const gtx_allocator *allocator, gtx_lod_meshes *out);
void gtx_lod_free_staging(gtx_lod_meshes *lods, const gtx_allocator *allocator);
void gtx_lod_free(gtx_lod_meshes *lods, const gtx_allocator *allocator);

/* Marks a patch whose height field has changed. */
static inline void gtx_lod_mark(gtx_lod_meshes *lods, uint32_t patch)
{
    lods->edited_count += !lods->edited[patch];
    lods->edited[patch] = true;
}

/* What of a patch is drawn by a level. */
typedef enum gtx_lod_part { GTX_LOD_NOTHING, GTX_LOD_BORDER, GTX_LOD_ALL } gtx_lod_part;

/* lod_ranges.c: what is drawn of a level: the parts, an array of gtx_lod_part by patch, or with
 * NULL all patches that are not edited; of those seen from one side or from two. Writes at most two
 * ranges a patch, and returns how many. */
uint32_t gtx_lod_ranges(const gtx_lod_meshes *lods, uint32_t level, bool two_sided,
                        const uint8_t *parts, gtx_range *ranges);

#endif
