/* What a frame consists of, whatever graphics interface shows it: what is in view, at which level
 * and by which method, as buffers, textures, constants, shaders and a list of draws. render.h
 * submits them to OpenGL. An engine with a render hardware interface of its own takes them from
 * here and submits them itself:
 *
 *     gtx_model_prepare(asset, NULL, &model, &error);                any thread
 *     gtx_model_texture, gtx_model_buffer                            create, and copy
 *     gtx_model_uploaded(model);                                     frees what was copied
 *
 *     gtx_frame_begin(planner, &view, instances, count, &frame, &error);
 *     copy frame.instances                                           vertices, an instance each
 *     gtx_frame_draws(planner, submit, user);                        calls submit for each draw
 *
 * Nothing here calls a graphics interface, waits, or keeps what the engine made: which texture is
 * which model's the engine knows by the model, or the instance, that a draw names.
 *
 * Shaders are GLSL: gtx_pipeline_source. Behind the engine's #version and `#define GTX_RHI` they
 * take one uniform block, gtx_constants, at binding 8 beside the textures at bindings 0..6
 * (gtx_slot), and of a vertex only floats and whole numbers. With VULKAN defined, as compilers to
 * SPIR-V do, that is so by itself. With GTX_MULTIVIEW vertex shaders draw the two views of
 * gtx_view.other at once, by GL_EXT_multiview. Edits tell a gtx_sink which texels and bytes to
 * replace; so do the rays in shaders of rays.h.
 *
 * Frames are drawn with depth test and depth writes on, without blending, into what has a depth
 * buffer. The rules of geotex.h hold here too; a planner is used by one thread at a time. */
#ifndef GEOTEX_FRAME_H
#define GEOTEX_FRAME_H

#include <geotex/view.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- models -------------------------------------------------------------------------------- */

/* Blocks of 4x4 texels that GPUs read as they are: a byte a texel, or half a byte, by ETC2, for
 * emission and for colours that are opaque all over; these stay so through edits. Heights and
 * outlines are exact. gtx_model_prepare takes those that an asset has (gtx_add_blocks) or encodes,
 * by its jobs; what is lost `gtx bench --compress` measures. */
typedef enum gtx_compression {
    GTX_COMPRESS_NONE = 0,
    GTX_COMPRESS_BC = 1,              /* desktops: gtx_renderer_compression; Vulkan's feature
                                         textureCompressionBC */
    GTX_COMPRESS_ETC2 = 2,            /* mobile devices: OpenGL ES 3.0; textureCompressionETC2 */
    GTX_COMPRESS_BC_SMALL = 3         /* as GTX_COMPRESS_BC, but half a byte for colours that are
                                         opaque, and emission, which lose as much as by ETC2 */
} gtx_compression;

typedef struct gtx_model_desc {
    const gtx_allocator *allocator;   /* of the model; NULL = malloc */
    const gtx_jobs *jobs;             /* used during the call; may be NULL */
    uint32_t borrow;                  /* 1: maps are not copied; the asset must stay open until the
                                         model is uploaded or destroyed */
    gtx_limits limits;                /* memory, until the upload, and cells */
    uint32_t first_provokes;          /* 1: flat values of a triangle are its first vertex's, as
                                         everywhere but in OpenGL; 0: its last one's */
    gtx_compression compress;         /* colours, materials, emission */
    uint32_t compress_normals;        /* 1: normals, too, by the same kind of blocks: they stray by
                                         some degrees where relief is as fine as texels */
    uint32_t reserved[1];
} gtx_model_desc;

/* Derives what the GPU needs, without GL: any thread. Keeps no reference to the asset unless it
 * borrows its maps. `desc` may be NULL. The model comes from the descriptor's allocator, and is
 * freed by gtx_model_destroy, most of it already by the upload. Errors: ARGUMENT, NOT_ZEROED,
 * MEMORY, LIMIT. */
GTX_API gtx_result gtx_model_prepare(const gtx_asset *asset, const gtx_model_desc *desc,
                                     gtx_model **out, gtx_error *error);

/* Adds to the asset the blocks that gtx_model_prepare would encode with this descriptor, beside
 * those that it has: it takes them from then on, the same byte for byte, and files of the asset
 * hold them (format/gtx.md, 2.1). An edited asset has none until they are added. The asset must not
 * be in use elsewhere. Errors: ARGUMENT (compress is NONE), and those of gtx_model_prepare; then
 * nothing has changed. */
GTX_API gtx_result gtx_add_blocks(gtx_asset *asset, const gtx_model_desc *desc, gtx_error *error);

/* Bytes of the model's textures and buffers on the GPU; `color` is colour, material, emission. */
typedef struct gtx_model_size {
    uint64_t geometry, color;
} gtx_model_size;
/* Known from gtx_model_prepare on; zeros for NULL. */
GTX_API gtx_model_size gtx_model_gpu_size(const gtx_model *model);

/* The textures of a model, by their binding in shaders. */
typedef enum gtx_slot {
    GTX_SLOT_CELLS = 0,           /* gtx_cells */
    GTX_SLOT_TRIM = 1,            /* gtx_trim */
    GTX_SLOT_NORMALS = 2,         /* gtx_normals */
    GTX_SLOT_COLORS = 3,          /* gtx_colors */
    GTX_SLOT_PATCHES = 4,         /* gtx_patches */
    GTX_SLOT_MATERIALS = 5,       /* gtx_materials */
    GTX_SLOT_EMISSIONS = 6,       /* gtx_emissions */
    GTX_SLOT_COUNT = 7
} gtx_slot;

typedef enum gtx_format {
    GTX_FORMAT_R8 = 1,            /* bytes that shaders read as 0..1 */
    GTX_FORMAT_RG8 = 2,
    GTX_FORMAT_RGBA8 = 3,
    GTX_FORMAT_RGB8_SRGB = 4,     /* decoded to linear as they are read; where an interface has no
                                     three bytes a texel, RGBA8_SRGB with any fourth */
    GTX_FORMAT_RGBA8_SRGB = 5,
    GTX_FORMAT_R8_UINT = 6,       /* whole numbers */
    GTX_FORMAT_R16_UINT = 7,
    GTX_FORMAT_RGBA32_FLOAT = 8,
    GTX_FORMAT_RGBA8_UINT = 9,
    GTX_FORMAT_RGBA16_UINT = 10,
    GTX_FORMAT_BC5 = 11,          /* blocks of 4x4 texels, two channels */
    GTX_FORMAT_BC7 = 12,
    GTX_FORMAT_BC7_SRGB = 13,
    GTX_FORMAT_BC1_SRGB = 14,     /* opaque */
    GTX_FORMAT_EAC_RG11 = 15,     /* two channels */
    GTX_FORMAT_ETC2_RGBA8 = 16,   /* alpha by EAC */
    GTX_FORMAT_ETC2_RGBA8_SRGB = 17,
    GTX_FORMAT_ETC2_RGB8_SRGB = 18
} gtx_format;

enum { GTX_MAX_TEXTURE_LEVELS = 8 };

/* A texture: its levels are each half the size of the one before. */
typedef struct gtx_texture {
    gtx_format format;
    uint32_t texel_size;          /* bytes; 0: of blocks */
    uint32_t block_size;          /* bytes of a block of 4x4 texels, or 0: rows are of blocks then,
                                     those at the ends not full */
    uint32_t width, height, layers, levels;
    uint32_t is_array;            /* 1: a 2D array, even of one layer; 0: a 2D texture */
    uint32_t is_filtered;         /* 1: linear within the nearest level, clamped to the edge; 0:
                                     read by texel alone */
    /* Of each level: rows without gaps, then layers; NULL after gtx_model_uploaded. */
    const void *texels[GTX_MAX_TEXTURE_LEVELS];
} gtx_texture;

/* A map that is the same everywhere has a single texel. False, and zeros, where the model has none:
 * then shaders read none, and any texture will do. */
GTX_API uint32_t gtx_model_texture(const gtx_model *model, gtx_slot slot, gtx_texture *out);

/* Buffers of a model, and the vertices that each has. */
typedef enum gtx_buffer {
    GTX_BUFFER_PROXY_VERTICES = 0,    /* 16 bytes: 3 floats; a uint32_t */
    GTX_BUFFER_PROXY_INDICES = 1,
    GTX_BUFFER_LOD_VERTICES = 2,      /* 12 bytes: 4 uint16_t, as integers; a uint32_t */
    GTX_BUFFER_LOD_INDICES = 3,
    GTX_BUFFER_GRID_VERTICES = 4,     /* as LOD_VERTICES; of the frame, and told by its draws */
    GTX_BUFFER_GRID_INDICES = 5,
    GTX_BUFFER_TILE_CORNERS = 6,      /* 4 bytes: 2 uint16_t, as integers; of the frame, too */
    GTX_BUFFER_BLOCKS = 7             /* 8 bytes an instance: 2 uint32_t; of the frame, too */
} gtx_buffer;

/* Its bytes, of the first four, and their number; NULL and 0 where the model has none, and NULL
 * after gtx_model_uploaded. */
GTX_API const void *gtx_model_buffer(const gtx_model *model, gtx_buffer buffer, uint64_t *size);

/* Says that all is copied: frees it. */
GTX_API void gtx_model_uploaded(gtx_model *model);
/* Of a model that no renderer of render.h has uploaded. NULL is fine. */
GTX_API void gtx_model_free(gtx_model *model);

/* ---- frames -------------------------------------------------------------------------------- */

/* Plans frames: scratch that lives from one to the next. */
typedef struct gtx_planner gtx_planner;

typedef struct gtx_planner_desc {
    const gtx_allocator *allocator;   /* NULL = malloc */
    gtx_costs costs;                  /* finite, none below 0 */
    uint32_t own_main;                /* 1: forward passes are by pipelines whose own_main is 1 */
    uint32_t max_tile_texels;         /* of a stream of tiles; 0: nothing is cast by tiles */
    uint32_t on_gpu;                  /* 1: costs not told are a GPU's, and it displaces blocks */
    uint32_t reserved[1];
} gtx_planner_desc;

/* `desc` may be NULL. Errors: ARGUMENT, NOT_ZEROED, MEMORY. */
GTX_API gtx_result gtx_planner_create(const gtx_planner_desc *desc, gtx_planner **out,
                                      gtx_error *error);
/* NULL is fine. */
GTX_API void gtx_planner_destroy(gtx_planner *planner);

/* What shaders read of an instance: attributes 2 to 8, four floats each, and 9. 116 bytes. */
typedef struct gtx_instance_data {
    float world[3][4];        /* rows of object -> world */
    float object[3][4];       /* rows of the inverse's linear part, and the eye in object space */
    float tint[4];
    uint32_t id;
} gtx_instance_data;

/* The uniform block of geotex_view.glsl, in std140. */
typedef struct gtx_constants {
    float clip_from_world[16];
    float depth[4], light[4], detail[4], search[4];
    float maps[4], lod_mesh[4], constant_material[4];
    float other_clip_from_world[16];  /* with GTX_MULTIVIEW, of gtx_view.other, ... */
    float other_eye[4];               /* ... and its eye less the first one's, in the world */
} gtx_constants;

enum { GTX_LAMPS = 8 };

/* A light of geotex_lighting.frag: a sun, a point or a spot. Units are the engine's: a white wall
 * that faces a sun of colour 1 is 1. */
typedef struct gtx_lamp {
    float place[4];           /* of a sun, unit, towards it, and 0; else in the world, and the range
                                 > 0 at which its light ends */
    float color[4];           /* linear; of a spot, the cosine where it ends, else -1 */
    float axis[4];            /* of a spot: unit, away from it; the cosine where it is whole */
} gtx_lamp;

/* The uniform block `gtx_lighting` of geotex_lighting.frag, in std140: what an engine has around.
 * Its samplers are gtx_shadow_map, which compares, and gtx_before, RGBA32F: in row `id` the first
 * three texels are rows of object -> world of the instance of that id in the frame before. Samplers
 * that are not used may have any texture of the kind. */
typedef struct gtx_lighting {
    float clip[16], clip_before[16]; /* world -> clip of this frame and the one before, without
                                        jitter: what motion is told by */
    float shadow[16];         /* world -> 0..1 of the shadow map, and its depth */
    float eye[4];             /* in the world: where fog begins */
    float around[4];          /* linear light from everywhere; the number of lights */
    float fog[4];             /* linear colour; density a world unit */
    float options[4];         /* 1: light 0, a sun, has a shadow map; the width of its texels as a
                                 depth in it; 1: gtx_before is used; 0 */
    gtx_lamp lamps[GTX_LAMPS];
} gtx_lighting;

typedef struct gtx_frame {
    const gtx_instance_data *instances;   /* of the planner, until its next frame begins */
    uint32_t instance_count;
    uint32_t nearer_is_greater;       /* depth test: 1 = greater, 0 = less */
} gtx_frame;

/* Indices that are one draw: of each, `base_vertex` is added to it. */
typedef struct gtx_range {
    uint32_t first, count;
    uint32_t base_vertex, vertex_count;   /* indices are below vertex_count, unless that is 0 */
} gtx_range;

enum { GTX_TILE_ROWS = 9, GTX_TILE_PARTS = 4 };

/* The uniform block of geotex_tiles.vert, at binding 10, in std140. */
typedef struct gtx_tile_constants {
    float place[GTX_TILE_ROWS][4];
    float tint[4];
    uint32_t id, pad[3];
} gtx_tile_constants;

/* What a draw by tiles has besides: its block, and the parts of a stream that lie one behind the
 * other at binding 9, a buffer texture (with Vulkan a uniform texel buffer) of texels of 4
 * uint32_t. */
typedef struct gtx_tile_draw {
    const gtx_tile_constants *constants;
    const void *parts[GTX_TILE_PARTS];
    uint64_t part_bytes[GTX_TILE_PARTS];
} gtx_tile_draw;

typedef enum gtx_cull { GTX_CULL_NONE = 0, GTX_CULL_BACK = 1, GTX_CULL_FRONT = 2 } gtx_cull;

typedef struct gtx_frame_draw {
    uint32_t pipeline;                /* below GTX_PIPELINE_COUNT */
    gtx_cull cull;
    uint32_t clockwise;               /* 1: what is clockwise in the picture, y up, is a front */
    const gtx_model *model;           /* whose textures, buffers */
    uint32_t first_instance, instance_count; /* of blocks: how many, placed as first_instance */
    const gtx_constants *constants;
    gtx_buffer vertices, indices;
    uint64_t vertex_offset, index_offset; /* bytes: where vertex 0 and index 0 are */
    uint32_t index_size;              /* 2 or 4 bytes; 0: there are none, and ranges are of
                                         vertices */
    uint32_t range_count;
    const gtx_range *ranges;
    /* Of grids and tiles. Vertices are NULL where they are those of the draw before. */
    const void *vertex_data, *index_data;
    uint64_t vertex_bytes, index_bytes;
    const gtx_tile_draw *tiles;       /* NULL where it is none by tiles */
} gtx_frame_draw;

/* All that it points to is gone when it returns. */
typedef void gtx_submit(const gtx_frame_draw *draw, void *user);

/* Checks what is asked for, places the instances and chooses what each is drawn by. `view` and
 * `instances` must stay until gtx_frame_draws has returned; view->shading is NULL. Errors:
 * ARGUMENT, NOT_ZEROED, MEMORY, UNSUPPORTED (GTX_METHOD_LOD with an asset that has no LOD mesh). */
GTX_API gtx_result gtx_frame_begin(gtx_planner *planner, const gtx_view *view,
                                   const gtx_instance *instances, uint32_t count,
                                   gtx_frame *out, gtx_error *error);
/* The draws of the frame begun last, in the order that they are to be submitted. Without memory for
 * displaced grids it casts. */
GTX_API void gtx_frame_draws(gtx_planner *planner, gtx_submit *submit, void *user);

/* ---- edits --------------------------------------------------------------------------------- */

/* Texels of one layer of a texture. */
typedef struct gtx_texture_piece {
    uint32_t binding;                 /* a gtx_slot; of rays.h GTX_RAYS_BINDING and on */
    uint32_t level, layer, x, y, width, height; /* of blocks, whole ones, or up to the end */
    const void *data;
    uint64_t row_bytes;               /* from a row of texels, or of blocks, to the next */
} gtx_texture_piece;

/* What takes what is to be replaced on the GPU: in what is there, and is read until then. All that
 * it is told is gone when it returns. */
typedef struct gtx_sink {
    void (*texels)(const gtx_texture_piece *texels, void *user);
    /* Of GTX_BUFFER_PROXY_VERTICES and GTX_BUFFER_PROXY_INDICES. */
    void (*bytes)(gtx_buffer buffer, uint64_t at, const void *data, uint64_t size, void *user);
    /* A texture takes the place of the one of a single texel that was there. */
    void (*renew)(gtx_slot slot, const gtx_texture *texture, void *user);
    void *user;
} gtx_sink;

/* Takes one patch from an edited asset: its maps at all levels, and the record, bounds and proxies
 * derived from them. `edited` has the pages, maps and rectangles of the asset that the model was
 * made from, and is not kept. Call it for each edited patch; the model is consistent again after
 * the last. Works in memory of the model's allocator. gtx_model_update and gtx_vk_update call it.
 * Errors: ARGUMENT (also where the model has not been uploaded), MEMORY:
 * nothing has changed. */
GTX_API gtx_result gtx_model_edit(gtx_model *model, const gtx_asset *edited, uint32_t patch,
                                  const gtx_sink *sink, gtx_error *error);

/* ---- pipelines ----------------------------------------------------------------------------- */

enum { GTX_PIPELINE_COUNT = 368, GTX_MAX_SHADER_TEXTS = 16 };

typedef struct gtx_pipeline {
    gtx_pass pass;
    gtx_buffer vertices;              /* whose layout attributes 0 and 1 have */
    uint32_t own_main;                /* 1: of an engine's own main */
    uint32_t writes_depth;            /* 1: from its fragments; 0: the depth test can come first */
} gtx_pipeline;

/* False, and zeros, where there is none of that number. Any thread. */
GTX_API uint32_t gtx_pipeline_get(uint32_t pipeline, gtx_pipeline *out);

typedef enum gtx_stage { GTX_STAGE_VERTEX = 0, GTX_STAGE_FRAGMENT = 1 } gtx_stage;

/* The texts of a stage's shader, which follow one another behind #version, and their number; 0
 * where there is no such pipeline. `own_main` is the text of an engine's own fragment main, or
 * NULL: it comes behind geotex_fragment.glsl, or behind geotex_lod_fragment.glsl with GTX_LOD
 * defined, and compilers count its lines from 1, as those of string 1. The others have static
 * storage. Any thread. */
GTX_API uint32_t gtx_pipeline_source(uint32_t pipeline, gtx_stage stage, const char *own_main,
                                     const char *texts[GTX_MAX_SHADER_TEXTS]);

/* The text of an installed shader file such as "geotex_cast.glsl", for engines that write their own
 * mains; its first lines say which files come before it. NULL if there is none of that name. Static
 * storage. Any thread. */
GTX_API const char *gtx_shader_source(const char *name);

#ifdef __cplusplus
}
#endif
#endif
