/* The inside of renderers and models, for the files of this room. */
#ifndef GTX_RENDER_RENDERER_H
#define GTX_RENDER_RENDERER_H

#include "derive/derive.h"
#include "render/gl.h"
#include "render/lod.h"

#include <stdbool.h>

/* Texture units; a model has one texture a unit. Samplers of the shaders carry the same numbers. */
enum {
    UNIT_CELLS, UNIT_TRIM, UNIT_NORMALS, UNIT_COLORS, UNIT_PATCHES, UNIT_MATERIALS, UNIT_EMISSIONS,
    UNIT_COUNT,
    UNIT_CLEARED = 8, /* units that render.h promises to leave empty */
    UNIT_STREAM = 8,  /* a buffer's, which leaves the other textures of the unit alone */
    UNIT_RAYS = 13    /* the first of three, which gtx_rays_bind binds */
};

/* Each method by pass; the forward one without and with materials, for Lambert alone costs less. */
enum {
    PROGRAM_CAST, PROGRAM_CAST_MATERIAL, PROGRAM_CAST_DEPTH, PROGRAM_CAST_ID, PROGRAM_CAST_GBUFFER,
    PROGRAM_PAPER, PROGRAM_PAPER_MATERIAL, PROGRAM_PAPER_DEPTH, PROGRAM_PAPER_ID,
    PROGRAM_PAPER_GBUFFER,
    PROGRAM_LOD, PROGRAM_LOD_MATERIAL, PROGRAM_LOD_DEPTH, PROGRAM_LOD_ID,
    PROGRAM_LOD_GBUFFER, PROGRAM_LOD_FRONT, PROGRAM_LOD_COLOR,
    PROGRAM_LOD_COLOR_FRONT, PROGRAM_LOD_MATERIAL_FRONT, PROGRAM_LOD_EVEN_FRONT,
    PROGRAM_CAST_COLOR,
    /* what was cast by tiles */
    PROGRAM_TILES, PROGRAM_TILES_MATERIAL, PROGRAM_TILES_DEPTH, PROGRAM_TILES_ID,
    PROGRAM_TILES_GBUFFER, PROGRAM_TILES_COLOR,
    PROGRAM_LOD_DEPTH_ALONE, /* of an instance whose place is a uniform */
    PROGRAM_COUNT
};

typedef struct gtx_program {
    gl_uint object;
    gl_int clip_from_world, depth, light, detail, search, maps, lod, even;
    gl_int place;             /* of the only instance */
    gl_int tint, instance;    /* of what is cast by tiles */
} gtx_program;

struct gtx_shading {
    gtx_program cast, lod;
};

/* What the proxy's vertex shader reads for each instance. */
typedef struct gtx_instance_data {
    float world[3][4];        /* rows of object -> world */
    float object[3][4];       /* rows of the inverse's linear part, and the eye in object space */
    float tint[4];
    uint32_t id;
} gtx_instance_data;

typedef struct gtx_plan_entry {
    float distance;           /* how far behind the near plane, of a hull; negative: a box */
    uint32_t slot;            /* of the proxy */
    uint32_t patch, level;
} gtx_plan_entry;

/* What is drawn of one instance that is cast, as glMultiDrawElements takes it: first the boxes of
 * patches that the near plane cuts, level by level, then the hulls of others, nearest first. */
typedef struct gtx_plan {
    uint32_t capacity, count;
    uint32_t box_count[GTX_MAX_MIPS], hull_count; /* boxes by the level that is cast */
    gl_size *counts;
    const void **offsets;     /* into the buffer of indices */
    gtx_plan_entry *entries;
} gtx_plan;

/* A slab in view, and the tiles that it may cover. */
typedef struct gtx_seen_slab {
    float near;               /* the least t of its points */
    uint16_t x0, x1, y0, y1;
    int32_t sum[2], difference[2]; /* of x and y */
} gtx_seen_slab;

/* An array of scratch that grows and does not keep what it held. */
typedef struct gtx_scratch {
    void *data;
    size_t size;
} gtx_scratch;

/* Rows of gtx_place: see geotex_tiles.glsl. */
enum {
    PLACE_ORIGIN, PLACE_X, PLACE_Y, PLACE_DIRECTION, PLACE_CLIP_Z, PLACE_CLIP_W,
    PLACE_WORLD, PLACE_ROWS = PLACE_WORLD + 3
};

/* Casting by tiles: what one instance has in each tile of 4 x 4 pixels. What shaders read of it are
 * the parts of one stream: records of patches, slabs, heads of the lists, and the lists. */
typedef struct gtx_tiles {
    gl_uint vertex_array, corner_buffer, stream_buffer, stream_texture;
    gl_int max_texels;
    gtx_scratch seen, order, heads, records, slabs, lists, corners;
    uint32_t seen_count, tile_count, corner_count;
    uint32_t first_column, first_row, columns, rows; /* the rectangle of tiles that have heads */
    uint32_t record_texels, slab_texels, head_texels, list_texels;
    float place[PLACE_ROWS][4];
} gtx_tiles;

struct gtx_renderer {
    gtx_allocator allocator;
    gtx_jobs jobs;            /* the host's, or zeros */
    gtx_gl gl;
    void (*log)(const char *message, void *user);
    void *log_user;
    gtx_program programs[PROGRAM_COUNT]; /* 0: not needed yet */
    gl_uint vertex_array, instance_buffer;
    /* Scratch of gtx_draw: what is uploaded, and whose winding is turned. */
    gtx_instance_data *instances;
    bool *mirrored;
    uint8_t *ways;            /* 0: by casting; n: by level n - 1 of the LOD mesh */
    uint32_t instance_capacity;
    gtx_plan plan;
    gtx_tiles tiles;
    gtx_costs costs;          /* as told, or all 0 */
};

/* One mip level of a texture, waiting for its upload. All layers follow one another. */
typedef struct gtx_level {
    uint32_t unit, level, width, height, layers;
    uint32_t texel_size;
    uint32_t next_row;        /* of height * layers rows, the first one not uploaded yet */
    uint8_t *data;            /* freed once it is uploaded, unless it is the asset's */
    bool borrowed;
} gtx_level;

enum { GTX_MAX_LEVELS = 2 + 5 * GTX_MAX_MIPS };

/* A patch's record, as geotex_height_field.glsl reads them: rows of GTX_RECORDS_A_ROW of them. */
enum { GTX_RECORD_TEXELS = 11, GTX_RECORDS_A_ROW = 128 };

enum { GTX_MAX_PROXY_KINDS = 1 + GTX_MAX_MIPS };

/* What the choice of a patch's proxy goes by. */
typedef struct gtx_patch_facts {
    float sphere[4], hull[4]; /* around the height field; around the proxies */
    float error[GTX_MAX_MIPS]; /* of each level, as gtx_grid_error has it, never falling */
    bool boxed;               /* edited, and its hulls do not fit their place: cast by its box */
} gtx_patch_facts;

struct gtx_model {
    gtx_allocator allocator;
    uint32_t height_bits, mip_count, patch_count, page_count, page_width, page_height;
    uint64_t layout;          /* gtx_model_layout of the asset */
    bool has_color, has_material, has_emission, ready;
    float emission_scale;     /* 0: no emission */
    bool has_even_material;   /* all over, but for patches that were edited: */
    float even_material[4];
    gtx_level levels[GTX_MAX_LEVELS];
    uint32_t level_count;
    gtx_proxies proxies;      /* freed once they are uploaded */
    uint64_t vertex_bytes_sent, index_bytes_sent;
    /* Proxies are in order of their kind, boxes first and then the hulls of each level, and of
     * patches. Where each begins, and the end: kind_count * patch_count + 1. */
    uint32_t kind_count, *first_vertex, *first_index;
    gtx_patch_facts *facts;   /* a patch each */
    float sphere[4];          /* around all proxies */
    float coarsest_error;     /* of all patches at the last level */
    uint32_t boxed_count;
    gtx_lod_meshes lods;
    /* Slabs of all levels, and where those of a patch's level begin: mip_count * patch_count + 1
     * numbers. */
    gtx_slab *slabs;
    uint32_t *first_slab;
    float (*records)[GTX_RECORD_TEXELS][4];
    gtx_model_size size;
    gl_uint textures[UNIT_COUNT];
    gl_uint vertices, indices;
};

/* constant_material.c: whether all that the asset shows has one material, and which: 0..1. */
bool gtx_find_even_material(const gtx_asset *asset, float material[4]);

/* renderer.c: gives the scratch back. */
void gtx_renderer_free_scratch(gtx_renderer *renderer);

/* program.c: those of the forward pass at once, the others when first needed. Errors: SHADER. */
gtx_result gtx_programs_create(gtx_renderer *renderer, gtx_error *error);
gtx_result gtx_program_need(gtx_renderer *renderer, int program, gtx_error *error);
void gtx_programs_destroy(gtx_renderer *renderer);

/* rays_textures.c: tells the program in use where gtx_rays_bind binds. */
void gtx_rays_locate(const gtx_gl *gl, gl_uint program);

/* model.c: gives the CPU's copy of the maps and proxies back. */
void gtx_model_free_staging(gtx_model *model);
/* A hash of where the patches' rectangles lie. */
uint64_t gtx_model_layout(const gtx_asset *asset);
/* Rows of a page of cells, and where the cells of a patch's level are in it: level 1 and the
 * coarser ones lie side by side under level 0. */
uint32_t gtx_model_cell_rows(const gtx_model *model);
void gtx_model_cells_at(const gtx_model *model, const gtx_patch *patch, uint32_t level,
                        uint32_t at[2]);
/* Sums up what the choice goes by, of all patches. */
void gtx_model_sum_up(gtx_model *model);

/* patch.c: what is derived of a patch. */
typedef struct gtx_derived {
    gtx_proxies proxies[GTX_MAX_PROXY_KINDS]; /* the patch's are added to them */
    float record[GTX_RECORD_TEXELS][4];
    gtx_patch_facts facts;
    gtx_slab *slabs[GTX_MAX_MIPS];            /* where they go */
    void *cells[GTX_MAX_MIPS];                /* where the cells of each level go, in rows of so */
    size_t row_texels[GTX_MAX_MIPS];          /* many texels */
} gtx_derived;
/* Errors: MEMORY. */
gtx_result gtx_patch_derive(const gtx_asset *asset, uint32_t patch, const gtx_allocator *allocator,
                            gtx_derived *out, gtx_error *error);

static inline uint32_t gtx_model_record_rows(uint32_t patches)
{
    return (patches + GTX_RECORDS_A_ROW - 1) / GTX_RECORDS_A_ROW;
}

/* upload.c: how the texture of a unit is stored and read. */
typedef struct gtx_texture_kind {
    gl_enum target, inner, format, type, min_filter, mag_filter;
} gtx_texture_kind;
gtx_texture_kind gtx_texture_kind_of(const gtx_model *model, uint32_t unit);
/* Makes the model's buffers, which have names, as large as the proxies, and fills them unless the
 * arrays are NULL. */
void gtx_upload_proxies(const gtx_gl *gl, const gtx_model *model, const gtx_proxies *proxies);
/* Puts a patch's edited proxies in the place of its old ones. False when a hull does not fit. */
bool gtx_replace_proxies(const gtx_gl *gl, const gtx_model *model, gtx_proxies *proxies,
                         uint32_t patch);
/* Pixel unpacking as render.h promises to leave it. */
void gtx_default_unpacking(const gtx_gl *gl);
/* Errors: GL (out of memory since the last look). */
gtx_result gtx_check_gl_memory(const gtx_gl *gl, gtx_error *error);

/* view.c: what a draw takes from a gtx_view. */
typedef struct gtx_frame {
    float clip_from_world[16];
    double eye[4];            /* world; the ray through a point p has the direction p * w - xyz */
    float depth[4], light[4], detail[4], search[4]; /* as geotex_view.glsl has them */
    bool reversed, mirrored;  /* mirrored: the view turns clockwise into counter-clockwise */
} gtx_frame;

/* Errors: ARGUMENT (a matrix without an inverse, or not finite). */
gtx_result gtx_frame_from_view(const gtx_view *view, gtx_frame *out, gtx_error *error);

/* Fills the instance's data; *mirrored says that its transform turns the winding. Errors:
 * ARGUMENT (not affine, no inverse, not finite). */
gtx_result gtx_place_instance(const gtx_frame *frame, const gtx_instance *instance,
                              gtx_instance_data *out, bool *mirrored, gtx_error *error);

/* plan.c: makes room for plans of so many patches. Errors: MEMORY. */
gtx_result gtx_plan_reserve(gtx_renderer *renderer, uint32_t patches, gtx_error *error);
void gtx_plan_free(gtx_renderer *renderer);
/* The kind of proxy that all patches of an instance have, if that is seen without looking at each,
 * or 0. */
uint32_t gtx_plan_whole(const gtx_view *view, const gtx_frame *frame, const gtx_model *model,
                        const gtx_instance_data *placed);
/* Fills the renderer's plan: each patch in view, or each that is edited. */
void gtx_plan_patches(gtx_renderer *renderer, const gtx_view *view, const gtx_frame *frame,
                      const gtx_model *model, const gtx_instance_data *placed, bool edited_only);

/* tiles.c: fills the renderer's tiles from its plan. False when there is no memory for it, or it is
 * more than the context takes. */
bool gtx_tiles_fill(gtx_renderer *renderer, const gtx_view *view, const gtx_frame *frame,
                    const gtx_model *model, const gtx_instance_data *placed);
void gtx_tiles_free(gtx_renderer *renderer);

/* stream.c: the objects of casting by tiles. Where they cannot be made, nothing is cast so. */
void gtx_stream_create(gtx_renderer *renderer);
void gtx_stream_destroy(gtx_renderer *renderer);
/* Whether what a view casts is cast by tiles. */
bool gtx_stream_suits(const gtx_renderer *renderer, const gtx_view *view);
/* Draws what the tiles hold by a program in use. Leaves the tiles' vertex array. */
void gtx_stream_draw(gtx_renderer *renderer, const gtx_program *program,
                     const gtx_instance_data *placed);

/* choose.c. */
/* An upper bound of how much an instance's transform stretches, exact for an even scale. */
double gtx_stretch_of(const gtx_instance_data *placed);
/* Whether it keeps angles: it turns, mirrors, moves and scales evenly, to about a thousandth. */
bool gtx_keeps_angles(const gtx_instance_data *placed);
/* What a model's instance is drawn by: 0, or one more than the LOD mesh. Errors:
 * UNSUPPORTED (the view wants an LOD mesh and there is none). */
gtx_result gtx_choose_way(const gtx_renderer *renderer, const gtx_view *view,
                          const gtx_frame *frame, const gtx_model *model,
                          const gtx_instance_data *placed, uint8_t *way, gtx_error *error);

/* state.c: what gtx_draw touches, read and put back. */
enum { GTX_MAX_DRAW_BUFFERS = 16 };
typedef struct gtx_state {
    gl_int program, vertex_array, array_buffer, unit;
    gl_int textures[UNIT_CLEARED], arrays[UNIT_CLEARED], samplers[UNIT_CLEARED];
    gl_int depth_func, cull_mode, front_face, draw_buffers;
    gl_bool depth_test, depth_mask, cull;
    gl_int stream;            /* where the context casts by tiles */
    gl_bool blend[GTX_MAX_DRAW_BUFFERS], color_mask[GTX_MAX_DRAW_BUFFERS][4];
} gtx_state;

void gtx_state_read(const gtx_gl *gl, gtx_state *state);
void gtx_state_restore(const gtx_gl *gl, const gtx_state *state);
/* The state that render.h promises after a draw. */
void gtx_state_leave(const gtx_gl *gl, bool reversed);

#endif
