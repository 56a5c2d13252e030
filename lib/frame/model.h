/* The inside of models, and what is derived of an asset for them. */
#ifndef GTX_FRAME_MODEL_H
#define GTX_FRAME_MODEL_H

#include "derive/rtin.h"
#include "geotex_records.glsl"
#include "frame/lod.h"
#include "frame/units.h"

#include <geotex/frame.h>
#include <stdbool.h>

enum {
    GTX_MAX_LEVELS = 3 + 5 * GTX_MAX_MIPS,
    GTX_MAX_PROXY_KINDS = 1 + GTX_MAX_MIPS,
    GTX_PATCHES_ROW = 1 << GTX_PATCHES_ROW_BITS,
    GTX_RECORDS_A_ROW = GTX_PATCHES_ROW / GTX_RECORD_TEXELS
};

/* A patch's record and a slab, as geotex_records.glsl lays them out. */
typedef float gtx_record[GTX_RECORD_TEXELS][4];
typedef float gtx_slab_texel[4];

/* One mip level of a texture, waiting for its upload. All layers follow one another. */
typedef struct gtx_level {
    uint32_t unit, level, width, height, layers;
    uint32_t texel_size, block_size; /* one of them is 0 */
    uint32_t next_row;        /* of all rows of all layers, the first one not uploaded yet */
    uint8_t *data;            /* freed once it is uploaded, unless it is the asset's */
    bool borrowed, encoded;   /* encoded: its source is blocks already */
} gtx_level;

/* Rows of a layer, of texels or blocks; bytes of a row, and of all layers. */
static inline uint32_t gtx_level_rows(const gtx_level *l)
{
    return l->block_size ? (l->height + 3) / 4 : l->height;
}

static inline size_t gtx_level_row_size(const gtx_level *l)
{
    return l->block_size ? ((size_t)l->width + 3) / 4 * l->block_size
                         : (size_t)l->width * l->texel_size;
}

static inline size_t gtx_level_size(const gtx_level *l)
{
    return gtx_level_row_size(l) * gtx_level_rows(l) * l->layers;
}

/* Bounds and errors that a patch's proxy is chosen by. */
typedef struct gtx_patch_facts {
    float sphere[4], hull[4]; /* around the height field; around the proxies */
    float error[GTX_MAX_MIPS]; /* of each level, as gtx_grid_error has it, never falling */
    float twist[GTX_MAX_MIPS]; /* how far two triangles are from a cell of it, at most, as errors
                                  count; never falling, 0 at level 0 */
    float area[3];            /* of the blocks' planes, as a vector: toward an eye far away it is
                                 what they cover, if all face it */
    bool boxed;               /* too large for hulls, or edited ones outgrew their room: cast by the
                                 box instead */
} gtx_patch_facts;

struct gtx_model {
    gtx_allocator allocator;
    uint32_t height_bits, mip_count, patch_count, page_count, page_width, page_height;
    uint64_t layout;          /* gtx_model_layout of the asset */
    bool has_color, has_material, has_emission, ready;
    float emission_scale;     /* 0: no emission */
    bool has_constant_material; /* ignoring edits */
    uint8_t constant_material[4];
    bool flat_material;       /* its texture is a single texel */
    gtx_format formats[UNIT_COUNT];
    gtx_level levels[GTX_MAX_LEVELS];
    uint32_t level_count;
    gtx_proxies proxies;      /* freed once they are uploaded; indices are packed, ... */
    uint32_t proxy_index_size; /* ... of so many bytes: 2 where they are below 65535 */
    uint64_t vertex_bytes_sent, index_bytes_sent;
    /* Proxies are in order of their kind, boxes first and then the hulls of each level, and of
     * patches. Where each begins, and the end: kind_count * patch_count + 1. */
    uint32_t kind_count, *first_vertex, *first_index;
    gtx_patch_facts *facts;   /* a patch each */
    float sphere[4];          /* around all proxies */
    float coarsest_error;     /* of all patches at the last level */
    float depth_complexity;   /* surfaces that face the eye behind a pixel, in the mean from
                                 outside, at least 1 */
    uint32_t boxed_count;
    bool bare;                /* no height field has a cell: LOD meshes are all there is */
    gtx_lod_meshes lods;
    /* Slabs of all levels, and where those of a patch's level begin: mip_count * patch_count + 1
     * numbers. */
    gtx_slab *slabs;
    uint32_t *first_slab;
    /* Displaced grids: a patch each, blocks of each slab of level 0, and nodes, of which those of a
     * patch begin at first_node: patch_count + 1 numbers. */
    gtx_rtin *rtins;
    gtx_rtin_block *blocks;
    gtx_rtin_node *nodes;
    size_t *first_node;
    gtx_record *records;
    gtx_model_size size;
    uint32_t textures[UNIT_COUNT], vertices, indices; /* names in OpenGL */
};

/* looks.c: whether all that the asset shows has one material, and which. */
bool gtx_find_constant_material(const gtx_asset *asset, uint8_t material[4]);
/* Whether all texels of a level of a map of materials, or of a part of it, are that or none. */
bool gtx_is_material(const uint8_t *texels, size_t count, const uint8_t material[4]);

/* Whether all that the asset shows is opaque. */
bool gtx_is_opaque(const gtx_asset *asset);

/* model.c: frees the CPU's copy of maps and proxies. gtx_model_free frees all but its OpenGL
 * objects. */
void gtx_model_free_staging(gtx_model *model);
/* maps.c. Adds a level and its memory, not yet written, unless it borrows what is there already.
 * NULL without memory. */
uint8_t *gtx_model_add_level(gtx_model *model, gtx_level level);
/* All levels of all maps but cells. Of each that is a copy, or blocks, `sources` says of what.
 * False without memory. */
bool gtx_model_add_maps(gtx_model *model, const gtx_asset *asset, const gtx_model_desc *desc,
                        const void **sources);
/* Writes a piece of a level: a copy of its source, blocks of it, or empty, for what lies between
 * patches. */
void gtx_model_begin_level(gtx_model *model, const gtx_asset *asset, uint32_t index,
                           const uint8_t *source, uint32_t piece, uint32_t pieces);
/* reserve.c: room for records, slabs and displaced grids. False without memory. */
bool gtx_model_reserve_blocks(gtx_model *model, const gtx_asset *asset);
/* Rows of the texture of records and slabs, and which of its texels the slabs of a patch's level
 * begin at. */
uint32_t gtx_model_patch_rows(const gtx_model *model);
uint32_t gtx_model_slabs_at(const gtx_model *model, uint32_t patch, uint32_t level);
/* memory.c: bytes that gtx_model_prepare takes, from above. */
uint64_t gtx_model_memory(const gtx_asset *asset, const gtx_model_desc *desc);
/* A hash of where the patches' rectangles lie. */
uint64_t gtx_model_layout(const gtx_asset *asset);
/* Rows and columns of a page of codes of cells, and where those of a patch's level are in it
 * (GTX_HIGH_PAGE). */
uint32_t gtx_model_cell_rows(const gtx_model *model);
uint32_t gtx_model_cell_columns(const gtx_model *model);
void gtx_model_cells_at(const gtx_model *model, const gtx_patch *patch, uint32_t level,
                        uint32_t at[2]);
/* Writes 32-bit indices of proxies as the model has them, which may be in their place. */
void gtx_model_pack_indices(const gtx_model *model, const uint32_t *indices, uint32_t count,
                            void *out);
/* Bounds and more of all patches, from the facts, slabs and records of each. */
void gtx_model_sum_up(gtx_model *model);

/* deviation.c: for each mip level the standard deviation, along an axis across, of a patch's
 * normals about those that pixels of the level's texels look up, without the few that stray far:
 * 0.001 to 0.5, and 0.001 at 0. */
void gtx_normal_deviation(const gtx_asset *asset, uint32_t patch, const gtx_grid *finest,
                          float (*deviation)[4]);

/* patch.c: what is derived of a patch. */
typedef struct gtx_derived {
    gtx_proxies proxies[GTX_MAX_PROXY_KINDS]; /* the patch's are added to them */
    gtx_record record;
    gtx_patch_facts facts;
    gtx_slab *slabs[GTX_MAX_MIPS];            /* where those of each level go, ... */
    gtx_slab_texel *slab_texels[GTX_MAX_MIPS]; /* ... those for the GPU, ... */
    uint32_t slabs_at[GTX_MAX_MIPS];          /* ... and where shaders find these */
    gtx_rtin rtin;
    gtx_rtin_block *blocks;                   /* where those of level 0 go, and its nodes */
    gtx_rtin_node *nodes;
    void *cells[GTX_MAX_MIPS];                /* where codes of each level's go */
    size_t row_texels[GTX_MAX_MIPS];          /* from a row of codes to the next */
} gtx_derived;
/* Errors: MEMORY. */
gtx_result gtx_patch_derive(const gtx_asset *asset, uint32_t patch, const gtx_allocator *allocator,
                            gtx_derived *out, gtx_error *error);

#endif
