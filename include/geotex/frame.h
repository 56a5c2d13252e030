/* Frames without a graphics API: which patches are in view, at which level and by which method, as
 * buffers, textures, constants, shaders and a list of draws. render.h submits them to OpenGL. An
 * engine with a render hardware interface (RHI) of its own submits them itself:
 *
 *     gtx_model_prepare(asset, NULL, &model, &error);                any thread
 *     gtx_model_texture, gtx_model_buffer                            create, and copy
 *     gtx_model_uploaded(model);                                     frees what was copied
 *
 *     gtx_frame_begin(planner, &view, instances, count, &frame, &error);
 *     copy frame.instances                                           vertices, an instance each
 *     gtx_frame_draws(planner, submit, user);                        calls submit for each draw
 *
 * Nothing here calls a graphics API, waits, or stores the engine's handles: draws name the model.
 *
 * Shaders are GLSL (gtx_pipeline_source). After the engine's #version and `#define GTX_RHI` they
 * have one uniform block, gtx_constants, at binding 8, the textures at bindings 0..6 (gtx_slot),
 * and vertex attributes that are floats or integers. GTX_RHI is implied where VULKAN is defined, as
 * compilers to SPIR-V do. With GTX_MULTIVIEW defined, vertex shaders draw both views of
 * gtx_view.other at once, with GL_EXT_multiview. Edits tell a gtx_sink which texels and bytes to
 * replace; so do the rays in shaders of rays.h.
 *
 * Draw with depth test and depth writes on and without blending, into a target that has a depth
 * buffer. The rules of geotex.h apply here too; a planner is used by one thread at a time. */
#ifndef GEOTEX_FRAME_H
#define GEOTEX_FRAME_H

#include <geotex/view.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- models -------------------------------------------------------------------------------- */

/* Block compression of maps: a byte per texel; with ETC2 and BC_SMALL half a byte for emission and
 * for colours that are opaque everywhere, which then stay opaque through edits. Heights and
 * outlines are exact. gtx_model_prepare uses the blocks that an asset has (gtx_add_blocks), or
 * encodes them with its jobs. `gtx bench --compress` measures the loss. */
typedef enum gtx_compression {
    GTX_COMPRESS_NONE = 0,
    GTX_COMPRESS_BC = 1,              /* BC7, BC5: desktop GPUs; Vulkan's textureCompressionBC */
    GTX_COMPRESS_ETC2 = 2,            /* ETC2, EAC: mobile GPUs (OpenGL ES 3.0); Vulkan's
                                         textureCompressionETC2 */
    GTX_COMPRESS_BC_SMALL = 3         /* as BC, but BC1 for opaque colours and for emission */
} gtx_compression;

typedef struct gtx_model_desc {
    const gtx_allocator *allocator;   /* of the model; NULL = malloc */
    const gtx_jobs *jobs;             /* used during the call; may be NULL */
    uint32_t borrow;                  /* 1: maps are not copied; the asset must stay open until the
                                         model is uploaded or destroyed */
    gtx_limits limits;                /* of memory until the upload, and of cells */
    uint32_t first_provokes;          /* provoking vertex of flat attributes: 1 = the first, as in
                                         all APIs but OpenGL; 0 = the last */
    gtx_compression compress;         /* of colours, materials and emission */
    uint32_t compress_normals;        /* 1: of normals too, which deviate by some degrees */
    uint32_t light_vertices;          /* 1: LOD meshes that have normals are lit by these: half the
                                         time in software, 1.2 dB farther from a bunny's mesh */
    uint32_t reserved[1];
} gtx_model_desc;

/* Derives what the GPU needs from an asset, without calling GL: any thread. Keeps no reference to
 * the asset unless it borrows its maps. `desc` may be NULL. The model is allocated from the
 * descriptor's allocator; most of it is freed once it is uploaded, all of it by gtx_model_destroy,
 * or by gtx_model_free if render.h is not used. Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT. */
GTX_API gtx_result gtx_model_prepare(const gtx_asset *asset, const gtx_model_desc *desc,
                                     gtx_model **out, gtx_error *error);

/* Encodes the blocks that gtx_model_prepare would encode with this descriptor, and adds them to the
 * asset beside those that it has. gtx_model_prepare then uses them, with identical results, and
 * files of the asset contain them (format/gtx.md, 2.1). An edited asset has none until they are
 * added again. No other thread may use the asset during the call. Errors: ARGUMENT (also:
 * `compress` is NONE), and those of gtx_model_prepare; the asset is then unchanged. */
GTX_API gtx_result gtx_add_blocks(gtx_asset *asset, const gtx_model_desc *desc, gtx_error *error);

typedef struct gtx_model_size {
    uint64_t geometry, color; /* color: of colours, materials and emission */
} gtx_model_size;
/* Bytes on the GPU, known from gtx_model_prepare on. Zeros for NULL. */
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
    GTX_FORMAT_RGB8_SRGB = 4,     /* where an API has none, RGBA8_SRGB with any alpha */
    GTX_FORMAT_RGBA8_SRGB = 5,
    GTX_FORMAT_R8_UINT = 6,       /* unsigned integers */
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

/* A texture. Each level has half the width and height of the one before. */
typedef struct gtx_texture {
    gtx_format format;
    uint32_t texel_size;          /* bytes; 0 for block-compressed formats */
    uint32_t block_size;          /* bytes of a block of 4x4 texels; 0 for other formats. Rows are
                                     then rows of blocks, partial at the right and bottom edges */
    uint32_t width, height, layers, levels;
    uint32_t is_array;            /* 1: a 2D array, even of one layer; 0: a 2D texture */
    uint32_t is_filtered;         /* 1: sampled linearly, with the nearest level, clamped to edge;
                                     0: only texel fetches */
    /* Per level: rows without padding, layer after layer; NULL after gtx_model_uploaded. */
    const void *texels[GTX_MAX_TEXTURE_LEVELS];
} gtx_texture;

/* Gives a texture, of a constant map a single texel, and returns 1; or zeros and 0 where the model
 * has none: shaders do not read it, so any may be bound. */
GTX_API uint32_t gtx_model_texture(const gtx_model *model, gtx_slot slot, gtx_texture *out);

/* Vertex and index buffers, and the layout of a vertex: attribute 0; attribute 1. The first four
 * are the model's; the others change each frame, and draws carry their data. */
typedef enum gtx_buffer {
    GTX_BUFFER_PROXY_VERTICES = 0,    /* 16 bytes: 3 floats; a uint32_t */
    GTX_BUFFER_PROXY_INDICES = 1,
    GTX_BUFFER_LOD_VERTICES = 2,      /* 4 uint16_t, as integers; a uint32_t, or of 8: the 4th */
    GTX_BUFFER_LOD_INDICES = 3,
    GTX_BUFFER_GRID_VERTICES = 4,     /* as LOD_VERTICES of 12 bytes */
    GTX_BUFFER_GRID_INDICES = 5,
    GTX_BUFFER_TILE_CORNERS = 6,      /* 4 bytes: 2 uint16_t, as integers */
    GTX_BUFFER_BLOCKS = 7             /* 8 bytes per instance: 2 uint32_t */
} gtx_buffer;

/* Gives the data of one of the model's own buffers, and its size in bytes. NULL and 0 where the
 * model has none; NULL after gtx_model_uploaded. */
GTX_API const void *gtx_model_buffer(const gtx_model *model, gtx_buffer buffer, uint64_t *size);

/* Frees the texels and buffers, once all have been copied. */
GTX_API void gtx_model_uploaded(gtx_model *model);
/* Frees a model that was not uploaded with render.h. NULL is fine. */
GTX_API void gtx_model_free(gtx_model *model);

/* ---- frames -------------------------------------------------------------------------------- */

/* Plans frames. Holds scratch memory that is reused from frame to frame. */
typedef struct gtx_planner gtx_planner;

typedef struct gtx_planner_desc {
    const gtx_allocator *allocator;   /* NULL = malloc */
    gtx_costs costs;                  /* finite, none below 0 */
    uint32_t own_main;                /* 1: forward passes use pipelines whose own_main is 1 */
    uint32_t max_tile_texels;         /* of a buffer texture; 0: nothing is cast by tiles */
    uint32_t on_gpu;                  /* 1: costs of 0 mean those of a GPU, and height fields are
                                         displaced in the vertex shader */
    uint32_t reserved[1];
} gtx_planner_desc;

/* `desc` may be NULL. Errors: ARGUMENT, NOT_ZEROED, MEMORY. */
GTX_API gtx_result gtx_planner_create(const gtx_planner_desc *desc, gtx_planner **out,
                                      gtx_error *error);
/* NULL is fine. */
GTX_API void gtx_planner_destroy(gtx_planner *planner);

/* The per-instance vertex attributes: 2 to 8 of four floats each, and 9, an integer. 116 bytes. */
typedef struct gtx_instance_data {
    float world[3][4];        /* rows of object -> world */
    float object[3][4];       /* rows of the linear part of world -> object; in [i][3], component i
                                 of the eye in object space */
    float tint[4];
    uint32_t id;
} gtx_instance_data;

/* The uniform block of geotex_view.glsl, in std140. */
typedef struct gtx_constants {
    float clip_from_world[16];
    float depth[4], light[4], detail[4], search[4];
    float maps[4], lod_mesh[4], constant_material[4];
    float other_clip_from_world[16];  /* with GTX_MULTIVIEW: of gtx_view.other */
    float other_eye[4];               /* with GTX_MULTIVIEW: its eye minus the first one's, world */
} gtx_constants;

enum { GTX_LAMPS = 8 };

/* A light of geotex_lighting.frag: a sun (directional), a point light or a spot light. Units are
 * the engine's: a white wall that faces a sun of colour 1 has radiance 1. */
typedef struct gtx_lamp {
    float place[4];           /* a sun: unit vector towards it, and 0; else world position, and the
                                 range > 0 at which its light ends */
    float color[4];           /* linear RGB; a spot: cosine of its outer angle, else -1 */
    float axis[4];            /* a spot: unit direction of its light, cosine of its inner angle */
} gtx_lamp;

/* The uniform block `gtx_lighting` of geotex_lighting.frag, in std140: the engine's lighting. Its
 * samplers are gtx_shadow_map, a shadow sampler, and gtx_before, RGBA32F, whose row `id` starts
 * with three texels: the rows of the object -> world matrix that the instance with that id had in
 * the previous frame. A sampler that is not used may have any texture of its type. */
typedef struct gtx_lighting {
    float clip[16], clip_before[16]; /* world -> clip of this frame and the previous one, without
                                        jitter, for motion vectors */
    float shadow[16];         /* world -> texture coordinates and depth of the shadow map, 0..1 */
    float eye[4];             /* world position, for fog */
    float around[4];          /* linear ambient light; the number of lamps */
    float fog[4];             /* linear colour; density per world unit */
    float options[4];         /* 1: lamp 0, a sun, has the shadow map; width of a shadow-map texel
                                 in units of its depth; 1: gtx_before is used; 0 */
    gtx_lamp lamps[GTX_LAMPS];
} gtx_lighting;

typedef struct gtx_frame {
    const gtx_instance_data *instances;   /* the planner's, until its next frame begins */
    uint32_t instance_count;
    uint32_t nearer_is_greater;       /* depth test: 1 = greater, 0 = less */
} gtx_frame;

/* A range of indices to draw, with `base_vertex` added to each. */
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

/* What a draw by tiles needs besides: its uniform block, and at binding 9 a buffer texture (Vulkan:
 * a uniform texel buffer) of 4 uint32_t per texel, the concatenation of `parts`. */
typedef struct gtx_tile_draw {
    const gtx_tile_constants *constants;
    const void *parts[GTX_TILE_PARTS];
    uint64_t part_bytes[GTX_TILE_PARTS];
} gtx_tile_draw;

typedef enum gtx_cull { GTX_CULL_NONE = 0, GTX_CULL_BACK = 1, GTX_CULL_FRONT = 2 } gtx_cull;

typedef struct gtx_frame_draw {
    uint32_t pipeline;                /* below GTX_PIPELINE_COUNT */
    gtx_cull cull;
    uint32_t clockwise;               /* 1: front faces are clockwise, y up; 0: the others */
    const gtx_model *model;           /* whose textures and buffers to bind */
    uint32_t first_instance, instance_count; /* with GTX_BUFFER_BLOCKS: the number of blocks, all
                                                with the transform of first_instance */
    const gtx_constants *constants;
    gtx_buffer vertices, indices;
    uint64_t vertex_offset, index_offset; /* bytes: where vertex 0 and index 0 are */
    uint32_t vertex_size, index_size; /* bytes; 2 or 4, or 0: not indexed, ranges are of vertices */
    uint32_t range_count;
    const gtx_range *ranges;
    /* Of buffers that are not the model's. NULL vertex_data: that of the draw before. */
    const void *vertex_data, *index_data;
    uint64_t vertex_bytes, index_bytes;
    const gtx_tile_draw *tiles;       /* NULL if the draw is not by tiles */
} gtx_frame_draw;

/* Called for each draw. What `draw` points to is valid during the call only. */
typedef void gtx_submit(const gtx_frame_draw *draw, void *user);

/* Checks the view, places the instances and chooses how each is drawn. `view` and `instances` must
 * stay valid until gtx_frame_draws has returned; view->shading must be NULL. Errors: ARGUMENT,
 * NOT_ZEROED, MEMORY, UNSUPPORTED (GTX_METHOD_LOD with an asset that has no LOD mesh). */
GTX_API gtx_result gtx_frame_begin(gtx_planner *planner, const gtx_view *view,
                                   const gtx_instance *instances, uint32_t count,
                                   gtx_frame *out, gtx_error *error);
/* Calls `submit` for the draws of the frame begun last, in the order in which to submit them. If
 * there is no memory for displaced grids, patches are cast instead. */
GTX_API void gtx_frame_draws(gtx_planner *planner, gtx_submit *submit, void *user);

/* ---- edits --------------------------------------------------------------------------------- */

/* A rectangle of texels of one layer of a texture. */
typedef struct gtx_texture_piece {
    uint32_t binding;                 /* a gtx_slot, or one from GTX_RAYS_BINDING on (rays.h) */
    uint32_t level, layer, x, y, width, height; /* whole blocks of a block-compressed texture, or
                                                   up to its edge */
    const void *data;
    uint64_t row_bytes;               /* from one row of texels, or of blocks, to the next */
} gtx_texture_piece;

/* Receives updates of textures and buffers, in the order in which to apply them. Frames in flight
 * may still read the old content. Pointers are valid during the call only. */
typedef struct gtx_sink {
    void (*texels)(const gtx_texture_piece *texels, void *user);
    /* Of GTX_BUFFER_PROXY_VERTICES and GTX_BUFFER_PROXY_INDICES. */
    void (*bytes)(gtx_buffer buffer, uint64_t at, const void *data, uint64_t size, void *user);
    /* Replaces the whole texture, which had a single texel. */
    void (*renew)(gtx_slot slot, const gtx_texture *texture, void *user);
    void *user;
} gtx_sink;

/* Updates one patch from an edited asset: its maps at all levels, and the record, bounds and
 * proxies derived from them. `edited` must have the pages, maps and rectangles of the asset that
 * the model was made from; no reference to it is kept. Call it for each edited patch; the model is
 * consistent again after the last. Allocates from the model's allocator. gtx_model_update and
 * gtx_vk_update call it.
 * Errors: ARGUMENT (also if the model has not been uploaded), MEMORY; the model is then
 * unchanged. */
GTX_API gtx_result gtx_model_edit(gtx_model *model, const gtx_asset *edited, uint32_t patch,
                                  const gtx_sink *sink, gtx_error *error);

/* ---- pipelines ----------------------------------------------------------------------------- */

enum { GTX_PIPELINE_COUNT = 448, GTX_MAX_SHADER_TEXTS = 16 };

typedef struct gtx_pipeline {
    gtx_pass pass;
    gtx_buffer vertices;              /* gives the layout of attributes 0 and 1 */
    uint32_t own_main;                /* 1: the fragment main is the engine's own */
    uint32_t writes_depth;            /* 1: fragments write depth; 0: early depth tests work */
} gtx_pipeline;

/* Gives a pipeline and returns 1; returns 0 and gives zeros if there is none of that number. Any
 * thread. */
GTX_API uint32_t gtx_pipeline_get(uint32_t pipeline, gtx_pipeline *out);

typedef enum gtx_stage { GTX_STAGE_VERTEX = 0, GTX_STAGE_FRAGMENT = 1 } gtx_stage;

/* Gives the source strings of a stage's shader, to be compiled in order after #version, and returns
 * their number; 0 if there is no such pipeline. `own_main` is an engine's fragment main or NULL:
 * it comes after geotex_fragment.glsl, or geotex_lod_fragment.glsl with GTX_LOD defined; compilers'
 * messages number its lines from 1, as string 1. All other strings are static. Any thread. */
GTX_API uint32_t gtx_pipeline_source(uint32_t pipeline, gtx_stage stage, const char *own_main,
                                     const char *texts[GTX_MAX_SHADER_TEXTS]);

/* The source of an installed shader file such as "geotex_cast.glsl", for engines that write their
 * own mains; its first lines say which files come before it. Static; NULL if there is no file of
 * that name. Any thread. */
GTX_API const char *gtx_shader_source(const char *name);

#ifdef __cplusplus
}
#endif
#endif
