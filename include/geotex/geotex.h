/* geotex: finely tessellated models as oriented height-map patches, ray-cast beside polygons.
 *
 * This header opens, inspects, validates, creates and encodes `.gtx` assets and casts rays into
 * them. It needs libc and libm, and zstd unless that is left out of the build. Drawing is in
 * render.h, editing in edit.h, cooking from meshes in cook.h.
 *
 * Rules that hold everywhere
 *   - A descriptor struct filled with zeros asks for the defaults; `reserved` fields must be zero.
 *   - Functions that can fail return a gtx_result. Most take an optional, caller-owned gtx_error as
 *     their last parameter. On failure, outputs are set to NULL or left untouched.
 *   - There is no global state. Distinct objects may be used from distinct threads at once; one
 *     object may be read (every function taking a const pointer) from many threads at once.
 *   - Nothing prints, exits or throws.
 *   - Strings are UTF-8, matrices column-major, coordinates right-handed.
 *
 * Words: a patch is an oriented box with a height map; a texel is a vertex of the height field; a
 * cell is the square between 2x2 texels. The glossary is in CONTRIBUTING.md, "Words". The format is
 * specified in format/gtx.md, and the technique ("the paper") in de Toledo, Wang, Levy, "Geometry
 * Textures and Applications", CGF 27(8), 2008. */
#ifndef GEOTEX_GEOTEX_H
#define GEOTEX_GEOTEX_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(GTX_SHARED)
#ifdef GTX_BUILDING
#define GTX_API __declspec(dllexport)
#else
#define GTX_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define GTX_API __attribute__((visibility("default")))
#else
#define GTX_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- version ---------------------------------------------------------------------------- */

#define GTX_VERSION_MAJOR 0
#define GTX_VERSION_MINOR 1
#define GTX_VERSION_PATCH 0
/* major * 10000 + minor * 100 + patch. The format has a version of its own (gtx_info). */
#define GTX_VERSION (GTX_VERSION_MAJOR * 10000 + GTX_VERSION_MINOR * 100 + GTX_VERSION_PATCH)

/* The GTX_VERSION that the library was built with. Any thread. */
GTX_API uint32_t gtx_version(void);

/* ---- results ---------------------------------------------------------------------------- */

/* Values are frozen: appended to, never renumbered. */
typedef enum gtx_result {
    GTX_OK = 0,
    GTX_CANCELLED = 1,            /* a progress callback asked to stop; also gtx_stream_deliver */
    GTX_ERROR_ARGUMENT = 10,      /* an argument is NULL or out of range */
    GTX_ERROR_NOT_ZEROED = 11,    /* a descriptor's reserved field is not zero */
    GTX_ERROR_MEMORY = 20,        /* the allocator returned NULL */
    GTX_ERROR_LIMIT = 21,         /* a stated limit (memory, texture size, patches) is exceeded */
    GTX_ERROR_READ = 30,          /* a file cannot be opened or read */
    GTX_ERROR_WRITE = 31,         /* a file cannot be written */
    GTX_ERROR_NOT_GTX = 40,       /* the bytes do not start with the .gtx identifier */
    GTX_ERROR_VERSION = 41,       /* a .gtx of a version that this build does not read */
    GTX_ERROR_TRUNCATED = 42,     /* the file ends too early */
    GTX_ERROR_CORRUPT = 43,       /* a rule of the format is broken; gtx_error.rule says which */
    GTX_ERROR_UNSUPPORTED = 45,   /* legal, but needs something this build does not have */
    GTX_ERROR_INPUT = 60,         /* a source model is malformed */
    GTX_ERROR_EMPTY = 61,         /* a source model has no usable triangle */
    GTX_ERROR_GL = 80,            /* the OpenGL context lacks something or reported an error */
    GTX_ERROR_SHADER = 81,        /* a shader did not compile or link */
    GTX_ERROR_INTERNAL = 99       /* a defect of geotex itself */
} gtx_result;

/* One English sentence for a result. Static storage, never NULL. Any thread. */
GTX_API const char *gtx_result_string(gtx_result result);

/* What went wrong. Written only on failure. */
typedef struct gtx_error {
    gtx_result result;
    uint32_t rule;                /* rule number of format/gtx.md, 0 when none applies */
    const char *rule_name;        /* its name, such as "patch-page": static; else NULL */
    uint64_t offset;              /* byte offset in the file that broke the rule, else 0 */
    const char *limit;            /* with LIMIT, the field of gtx_limits that would raise it, such
                                     as "memory": static; else NULL */
    char message[240];            /* one sentence without a final newline, always terminated */
} gtx_error;

/* ---- memory and progress ---------------------------------------------------------------- */

/* Memory hooks. `alloc` returns at least `size` bytes, aligned to 16 bytes, or NULL; `free` is
 * given the size that was allocated. Both may be called from any thread that calls into geotex.
 * NULL hooks mean malloc and free. Objects copy the struct: an object is freed through the hooks
 * that it was made with. Temporary memory is freed before a call returns. */
typedef struct gtx_allocator {
    void *(*alloc)(size_t size, void *user);
    void (*free)(void *memory, size_t size, void *user);
    void *user;
} gtx_allocator;

/* The host's job system, for calls that can use several threads. `run` calls job(i, data) once for
 * every i below `count`, in any order, on any threads, and returns when all jobs have finished.
 * Jobs never wait for each other and never call `run`. They may allocate from the call's allocator,
 * which must then be thread-safe, as malloc is. Results and errors are the same however jobs are
 * run. NULL or a zeroed struct runs the jobs one after another on the calling thread; the library
 * itself starts no threads. */
typedef struct gtx_jobs {
    void (*run)(uint32_t count, void (*job)(uint32_t index, void *data), void *data, void *user);
    void *user;
} gtx_jobs;

/* How much a call may use for untrusted files. 0 asks for a field's default; most defaults grow
 * with the number of bytes that the call reads, as "A + B per byte read". UINT64_MAX removes a
 * limit. A call fails with LIMIT before it exceeds one. */
typedef struct gtx_limits {
    uint64_t memory;              /* bytes held at any time; 0 = 256 MiB + 2,000 per byte read */
    uint64_t triangles;           /* in all models together, after polygons are triangulated and
                                     instances expanded; 0 = 2^19 + 1.5 per byte read */
    uint64_t texels;              /* in an asset's pages at level 0, or nodes in height grids;
                                     0 = 2^26 + 256 per byte read */
    uint64_t pixels;              /* in one image; 0 = 2^26 + 16 per byte read */
    uint64_t patches;             /* 0 = 2^20 */
    uint64_t cells;               /* that one ray may visit (gtx_ray_cells); 0 = 2^19 */
    uint64_t work;                /* steps of cooking or comparing; a second is about 25 million.
                                     Steps are counted, not timed: the same file always passes or
                                     always fails. Measuring for a report may take as much again.
                                     0 = 3 x 2^26 + 32 per byte read */
    uint32_t reserved[2];
} gtx_limits;

/* Progress of a long call. `stage` is a static string such as "bake". */
typedef struct gtx_progress {
    const char *stage;
    uint32_t stage_index, stage_count;
    float fraction;               /* of the whole call, 0..1, never falling */
} gtx_progress;

/* Called from the calling thread. Return non-zero to cancel: the call then returns
 * GTX_CANCELLED. */
typedef int (*gtx_progress_fn)(const gtx_progress *progress, void *user);

/* ---- assets ----------------------------------------------------------------------------- */

/* An asset in memory: patch records and maps that passed the format's rules. Immutable, but for
 * gtx_add_blocks (frame.h). */
typedef struct gtx_asset gtx_asset;

enum { /* gtx_patch.flags */
    GTX_PATCH_TWO_SIDED = 1u << 8 /* the height field is visible from below too */
};

/* A patch: a parallelepiped (its frame), and a rectangle of the asset's pages that holds its maps.
 * 128 bytes, laid out as in the file, in the processor's byte order. Lengths and positions are in
 * object units, positions relative to the asset's anchor.
 *
 * The texel (i, j) of a w x h rectangle with height code c lies at
 *   origin + (i + 0.5) / w * extent_x * axis_x
 *          + (j + 0.5) / h * extent_y * axis_y
 *          + (c - 1) / (2^bits - 2) * extent_z * axis_z        for c >= 1; c = 0 is empty.
 * axis_z is the direction of projection; axis_x and axis_y may tilt against it. */
typedef struct gtx_patch {
    float origin[3], extent_x;
    float axis_x[3], extent_y;
    float axis_y[3], extent_z;
    float axis_z[3], coverage;    /* coverage: share of texels that are not empty, 0..1 */
    uint32_t page;
    uint16_t rect[4];             /* x, y, w, h in texels of the page at level 0 */
    uint16_t dilation;            /* rings of texels around the non-empty ones that have valid
                                     normals, colours, materials and emission */
    uint16_t flags;               /* GTX_PATCH_... */
    float sphere[4];              /* centre and radius of a sphere around the surface */
    uint32_t source_triangles;    /* triangles of the chart */
    uint32_t reserved[7];
} gtx_patch;

typedef enum gtx_map {
    GTX_MAP_HEIGHT = 0,           /* level 0 only; uint8_t or uint16_t codes, 0 = empty */
    GTX_MAP_TRIM = 1,             /* level 0 only; uint8_t: signed distance to the patch's outline,
                                     (c - 128) / 16 texels, positive outside */
    GTX_MAP_NORMAL = 2,           /* 2 x uint8_t, hemi-octahedral in the patch's normal frame */
    GTX_MAP_COLOR = 3,            /* 4 x uint8_t: sRGB colour and linear alpha; optional */
    GTX_MAP_MATERIAL = 4,         /* 4 x uint8_t: occlusion, roughness, metallic, lit (0: unlit);
                                     optional: 255, 255, 0, 255 where absent */
    GTX_MAP_EMISSION = 5          /* 3 x uint8_t: sRGB, times emission_scale; optional */
} gtx_map;

typedef struct gtx_info {
    uint32_t version_major, version_minor;    /* of the format */
    uint32_t patch_count;
    uint32_t page_count, page_width, page_height;
    uint32_t mip_count;           /* levels of every map but height and trim, 1..8 */
    uint32_t height_bits;         /* 8 or 16 */
    uint32_t has_color, has_material, has_emission;   /* 0 or 1 */
    uint32_t lod_levels;          /* LOD meshes, 0..8 */
    float bounds_min[3], bounds_max[3];       /* relative to the anchor */
    float unit;                   /* metres per object unit */
    float emission_scale;         /* radiance of an emission texel of 255; 0 without emission */
    double anchor[3];             /* object-space position of the asset's origin */
    uint64_t source_triangles;
    uint64_t content_hash;        /* of the decoded sections: independent of compression */
    uint64_t file_size;           /* bytes; 0 for an asset that was not opened from a file */
} gtx_info;

typedef struct gtx_open_desc {
    const gtx_allocator *allocator;
    const gtx_jobs *jobs;         /* used during the call; opening then holds all compressed
                                     sections in memory at once */
    gtx_limits limits;            /* of memory, texels and patches */
    uint32_t flags;               /* GTX_OPEN_... */
    uint32_t reserved[5];
} gtx_open_desc;

enum { /* gtx_open_desc.flags */
    GTX_OPEN_SKIP_HASH = 1        /* do not check the sections' hashes, only the header's */
};

/* Opens the `size` bytes of a .gtx file, which may be freed afterwards. Every rule of format/gtx.md
 * is checked; malformed or hostile bytes give an error. `desc` may be NULL. The asset is allocated
 * from the descriptor's allocator; free it with gtx_close.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, NOT_GTX, VERSION, TRUNCATED, CORRUPT,
 * UNSUPPORTED. */
GTX_API gtx_result gtx_open_memory(const void *data, size_t size, const gtx_open_desc *desc,
                                   gtx_asset **out, gtx_error *error);

/* The same from a file. The file's bytes are held in memory from the same allocator during the
 * call, and count towards limits.memory. Errors: also READ. */
GTX_API gtx_result gtx_open_file(const char *path, const gtx_open_desc *desc, gtx_asset **out,
                                 gtx_error *error);

/* What gtx_open_prefix learned from the first bytes of a file. */
typedef struct gtx_prefix {
    uint64_t file_size;           /* bytes; 0 until the header has arrived */
    uint64_t needed;              /* number of bytes, from the start of the file, that would show
                                     more than these do; 0 = the file is complete */
    uint32_t reserved[4];
} gtx_prefix;

/* Opens the first `size` bytes of a file, such as an unfinished download. *out is an asset of what
 * has arrived, or NULL with GTX_OK when nothing can be shown yet: wait for prefix->needed bytes.
 *
 * The asset of an incomplete file has all patches, or before these have arrived others in their
 * place, laid around triangles of the coarsest LOD mesh; the LOD meshes that have arrived, the
 * finest of them as level 0; colours, materials and emission if they have arrived; and normals
 * taken from its finest LOD mesh. Its maps have fewer texels than the file's. It has no heights:
 * rays miss it, only GTX_METHOD_AUTO and GTX_METHOD_LOD draw it, and its models cannot be edited
 * (gtx_model_edit). In all else it is an ordinary asset. A complete file gives the asset of
 * gtx_open_memory. What has arrived is checked by the format's rules.
 * Errors: as gtx_open_memory, but never TRUNCATED. */
GTX_API gtx_result gtx_open_prefix(const void *data, size_t size, const gtx_open_desc *desc,
                                   gtx_prefix *prefix, gtx_asset **out, gtx_error *error);

/* Frees the asset. NULL is fine. */
GTX_API void gtx_close(gtx_asset *asset);

/* Copies the facts of the asset's header to *out. */
GTX_API void gtx_get_info(const gtx_asset *asset, gtx_info *out);

/* gtx_info.patch_count records, owned by the asset. */
GTX_API const gtx_patch *gtx_patches(const gtx_asset *asset);

/* All pages of one level of a map, page after page, rows without padding; owned by the asset. *size
 * (may be NULL) gets the number of bytes. NULL when the asset has no such map or level. A page of
 * level k has (page_width >> k) x (page_height >> k) texels. */
GTX_API const void *gtx_map_data(const gtx_asset *asset, gtx_map map, uint32_t level, size_t *size);

/* A flag of gtx_lod_mesh: the mesh is for models of a few pixels. A triangle may be larger than its
 * patch; texture lookups are clamped to the patch's rectangle. */
#define GTX_LOD_FAR 1u

/* Another: its vertices have normals, which tell how the surface is lit before normal maps are
 * there. */
#define GTX_LOD_NORMALS 2u

/* An LOD mesh: the whole surface as triangles, for drawing it small. Triangles of several patches
 * may share a vertex, and its texel coordinates in each patch follow from that patch's frame. The
 * quantised position q of a vertex stands for the point
 *   origin + step * q                                            relative to the asset's anchor. */
typedef struct gtx_lod_mesh {
    float origin[3], step;
    float error;                  /* object units: bounds the distance of any point of the mesh from
                                     the source and of any point of the source from the mesh, except
                                     for parts of the source no longer than `error` */
    uint32_t vertex_count, triangle_count;
    uint32_t flags;               /* GTX_LOD_FAR, GTX_LOD_NORMALS */
    const uint32_t *first;        /* patch_count + 1 numbers: triangles first[p]..first[p + 1] - 1
                                     belong to patch p */
    const uint32_t *indices;      /* 3 per triangle */
    const uint16_t *positions;    /* 3 per vertex */
    const uint8_t *normals;       /* with GTX_LOD_NORMALS 2 per vertex, octahedral; else NULL */
    float normal_error;           /* of these, between vertices, to the normal maps: the root of the
                                     mean square of the distance of unit vectors (of small angles,
                                     radians) */
} gtx_lod_mesh;

/* Gives LOD mesh `level`, 0 being the finest. Its arrays are owned by the asset.
 * Errors: ARGUMENT (also when there is no such level). */
GTX_API gtx_result gtx_get_lod_mesh(const gtx_asset *asset, uint32_t level, gtx_lod_mesh *out);

/* The META section: *size bytes of JSON, not null-terminated, owned by the asset; NULL when absent.
 * Informative: nothing that is drawn depends on it. */
GTX_API const char *gtx_meta(const gtx_asset *asset, size_t *size);

/* An upper bound on the number of height-field cells that any single ray through the asset visits,
 * and so on the cost of a ray or of a pixel (see gtx_draw). Tests of boxes in hierarchies come on
 * top: at most two per block of 8 x 8 cells of the asset.
 *
 * The bound is the largest sum of width + height, in texels, over the patches that one bundle of
 * rays meets. Ordinary assets have a few thousand to 10^5, and most rays visit a small part of
 * that; where patches are stacked in one place a ray really visits that many. limits.cells is
 * compared with it wherever an asset is prepared for rays or for drawing. 0 for NULL. Allocates
 * nothing; time grows with the number of patches. */
GTX_API uint64_t gtx_ray_cells(const gtx_asset *asset);

/* ---- validation ------------------------------------------------------------------------- */

typedef struct gtx_issue {
    uint32_t rule;                /* its number in format/gtx.md */
    uint32_t is_error;            /* 0: a warning */
    uint64_t offset;              /* byte offset in the file */
    const char *name;             /* short identifier such as "patch-axis-unit" */
    const char *message;          /* one sentence; valid during the call */
} gtx_issue;

typedef void (*gtx_issue_fn)(const gtx_issue *issue, void *user);

/* Checks untrusted bytes against every rule of format/gtx.md and reports each broken rule to `fn`,
 * in the order of the specification's section 7, as far as it is safe to read on. Returns GTX_OK if
 * no error was reported (warnings do not count). `limits` and `fn` may be NULL. Uses malloc, and as
 * much memory as opening the asset.
 * Errors: as gtx_open_memory; a broken rule takes precedence over MEMORY and LIMIT. */
GTX_API gtx_result gtx_validate(const void *data, size_t size, const gtx_limits *limits,
                                gtx_issue_fn fn, void *user, gtx_error *error);

/* ---- creating and encoding -------------------------------------------------------------- */

/* The content of a new asset. All arrays are copied, and checked by the rules of format/gtx.md. The
 * patches' coverage and spheres and the bounds are not computed: they must be given, and are
 * checked too. */
typedef struct gtx_asset_desc {
    const gtx_patch *patches;
    uint32_t patch_count;
    uint32_t page_count, page_width, page_height;
    uint32_t mip_count;           /* 1..8 */
    uint32_t height_bits;         /* 8 or 16 */
    const void *height;           /* page_count * page_width * page_height codes */
    const uint8_t *trim;          /* the same number of codes */
    const uint8_t *const *normal; /* mip_count pointers, level 0 first */
    const uint8_t *const *color;  /* mip_count pointers, or NULL; likewise the next two */
    const uint8_t *const *material;
    const uint8_t *const *emission;
    float emission_scale;         /* 0 = 1 with emission */
    const gtx_lod_mesh *lod;      /* lod_levels LOD meshes, the finest first; or NULL */
    uint32_t lod_levels;          /* up to 8 */
    const char *meta;             /* JSON text, or NULL */
    size_t meta_size;
    float bounds_min[3], bounds_max[3];
    float unit;                   /* 0 = 1 */
    double anchor[3];
    uint64_t source_triangles;
    const gtx_allocator *allocator;
    uint32_t reserved[6];
} gtx_asset_desc;

/* Makes an asset, allocated from the descriptor's allocator; free it with gtx_close.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, CORRUPT (gtx_error.rule is the broken rule). */
GTX_API gtx_result gtx_create(const gtx_asset_desc *desc, gtx_asset **out, gtx_error *error);

typedef struct gtx_encode_desc {
    const gtx_allocator *allocator;
    const gtx_jobs *jobs;         /* used during the call; encoding then holds all sections in
                                     memory at once */
    int32_t zstd_level;           /* 1..19; 0 = 6 (stored, in a build without zstd); -1 = stored */
    uint32_t reserved[5];
} gtx_encode_desc;

/* Encodes the asset as the bytes of a `.gtx` file. *data holds *size bytes from the descriptor's
 * allocator (malloc when there is none), and must be freed with that allocator. The same asset and
 * options give the same bytes with the same version of zstd. Errors: ARGUMENT, NOT_ZEROED, MEMORY,
 * UNSUPPORTED (built without zstd). */
GTX_API gtx_result gtx_encode(const gtx_asset *asset, const gtx_encode_desc *desc, void **data,
                              size_t *size, gtx_error *error);

/* Encodes the asset, with the descriptor's allocator, and writes it to a file atomically: under a
 * temporary name in the same folder, which replaces `path` once it is on the disk. An existing
 * file's permissions are kept, symbolic links are followed, devices and pipes are written to
 * directly. Errors: as gtx_encode, and WRITE. */
GTX_API gtx_result gtx_save_file(const gtx_asset *asset, const char *path,
                                 const gtx_encode_desc *desc, gtx_error *error);

/* ---- ray query -------------------------------------------------------------------------- */

/* An asset prepared for ray casting on the CPU: a level of its height fields, bounds, and a
 * hierarchy over the patches. Keeps no reference to the asset. Immutable; any number of threads may
 * cast at once. */
typedef struct gtx_caster gtx_caster;

typedef struct gtx_caster_desc {
    const gtx_allocator *allocator;
    uint32_t level;               /* of the height fields: 0 = finest .. 7 */
    /* Object units. When > 0, each patch is cast at the coarsest of its mip_count levels that is
     * within this distance of level 0, as the renderer chooses levels; `level` must then be 0. */
    float max_error;
    gtx_limits limits;            /* of memory and cells */
    uint32_t reserved[4];
} gtx_caster_desc;

/* A ray: the points origin + t * direction with t_min <= t <= t_max, relative to the asset's
 * anchor. `direction` need not be normalised; t_max <= 0 means infinity. */
typedef struct gtx_ray {
    float origin[3], t_min;
    float direction[3], t_max;
} gtx_ray;

typedef struct gtx_hit {
    float t;                      /* parameter of the hit; infinity when nothing was hit */
    uint32_t patch;               /* index of the patch, UINT32_MAX when nothing was hit */
    float x, y;                   /* texel coordinates in the patch: texel i is at x = i */
    float normal[3];              /* unit normal from the normal map, object space */
    float facet[3];               /* unit geometric normal of the height field; towards axis_z,
                                     whichever side was hit */
    uint32_t back;                /* 1: the ray crossed the height field from below */
} gtx_hit;

enum { /* flags of gtx_raycast */
    GTX_RAY_ANY = 1,              /* any hit will do (shadows); t and normal are that hit's */
    GTX_RAY_TWO_SIDED = 2,        /* accept crossings from below in every patch */
    GTX_RAY_EXHAUSTIVE = 4        /* visit every cell of every patch: the slow reference,
                                     without a bound */
};

/* Makes a caster, allocated from the descriptor's allocator; free it with gtx_caster_destroy.
 * `desc` may be NULL. Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT. */
GTX_API gtx_result gtx_caster_create(const gtx_asset *asset, const gtx_caster_desc *desc,
                                     gtx_caster **out, gtx_error *error);
/* NULL is fine. */
GTX_API void gtx_caster_destroy(gtx_caster *caster);

/* Casts `count` rays. Allocates nothing. A ray with a NaN or a zero direction hits nothing.
 * Errors: ARGUMENT. */
GTX_API gtx_result gtx_raycast(const gtx_caster *caster, const gtx_ray *rays, gtx_hit *hits,
                               size_t count, uint32_t flags);

/* The surface below points, for things that stand, fall or drive. Casts a ray straight down,
 * against `up` (of any length but 0), from `step` >= 0 object units above each point, so that a
 * surface a little above the point is found too. hit.t is the height of the point above the
 * surface, in object units: negative if the surface is above the point, infinity if there is none.
 * Flags as for gtx_raycast. Errors: ARGUMENT. */
GTX_API gtx_result gtx_drop(const gtx_caster *caster, const float up[3], float step,
                            const float (*points)[3], gtx_hit *hits, size_t count,
                            uint32_t flags);

/* The colour map at hits: linear RGBA in 0..1, interpolated bilinearly at level 0. White where
 * nothing was hit, or if the asset has no colours. `asset` must be the one that the caster was made
 * from. Errors: ARGUMENT. */
GTX_API gtx_result gtx_hit_colors(const gtx_asset *asset, const gtx_hit *hits,
                                  float (*colors)[4], size_t count);

/* ---- scenes: rays among instances ------------------------------------------------------------ */

/* Instances of casters in a world, with a hierarchy over them. The casters must outlive the scene.
 * Immutable; any number of threads may use it at once. */
typedef struct gtx_scene gtx_scene;

/* `transform` is column-major, affine and invertible, and maps the asset's coordinates (relative to
 * its anchor) to the world. */
typedef struct gtx_scene_instance {
    const gtx_caster *caster;
    float transform[16];
} gtx_scene_instance;

/* Makes a scene, allocated from `allocator` (NULL = malloc); free it with gtx_scene_destroy.
 * Errors: ARGUMENT (also for an instance without a caster or with an unsuitable transform),
 * MEMORY. */
GTX_API gtx_result gtx_scene_create(const gtx_scene_instance *instances, uint32_t count,
                                    const gtx_allocator *allocator, gtx_scene **out,
                                    gtx_error *error);
/* NULL is fine. */
GTX_API void gtx_scene_destroy(gtx_scene *scene);

/* gtx_raycast with rays, normals and facets in world space. which[i] gets the index of the instance
 * that ray i hit, or UINT32_MAX; `which` may be NULL. Errors: ARGUMENT. */
GTX_API gtx_result gtx_scene_raycast(const gtx_scene *scene, const gtx_ray *rays, gtx_hit *hits,
                                     uint32_t *which, size_t count, uint32_t flags);

/* A point to light: world position, unit normal on its visible side, and `turn`, 0..1, which
 * rotates the pattern of its rays. A random turn per point trades banding for noise. */
typedef struct gtx_lit_point {
    float position[3], normal[3];
    float turn;
} gtx_lit_point;

/* A distant disc such as the sun, or the sky. */
typedef struct gtx_light_desc {
    float direction[3];           /* world space, towards the disc; zero: the sky, a
                                     cosine-weighted hemisphere above each point */
    float spread;                 /* tangent of the disc's angular radius; 0: hard shadows */
    float reach;                  /* length of the rays, world units: nothing farther away
                                     occludes; 0 = infinity */
    uint32_t rays;                /* per point; 0 = 1 */
    float offset;                 /* distance from the point at which rays start, world units; 0 =
                                     gtx_scene_offset */
    uint32_t reserved[5];
} gtx_light_desc;

/* Gives the share of the light, 0..1, that reaches each point: for a disc a hard or soft shadow,
 * yet to be multiplied by the cosine of the angle of incidence; for the sky, ambient occlusion.
 * Rays to a disc that go below the point's tangent plane count as occluded. The result is
 * deterministic; shaders use the same ray patterns (geotex_rays.glsl). Errors: ARGUMENT,
 * NOT_ZEROED. */
GTX_API gtx_result gtx_scene_light(const gtx_scene *scene, const gtx_light_desc *light,
                                   const gtx_lit_point *points, float *shares, size_t count);

/* The default gtx_light_desc.offset, in world units: two height steps of the patch with the
 * coarsest steps, or 1/32 texel if that is more. Heights are rounded by up to half a step, and
 * cells cut a little into curved surfaces; with this offset no ray that leaves a convex surface
 * hits it again, however grazing. */
GTX_API float gtx_scene_offset(const gtx_scene *scene);

#ifdef __cplusplus
}
#endif
#endif
