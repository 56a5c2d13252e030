/* geotex: finely tessellated models as oriented height-map patches, cast beside polygons.
 *
 * This header opens, inspects, validates, creates and encodes `.gtx` assets and casts rays into
 * them. It needs libc and libm, and zstd unless that is left out of the build. Drawing is in
 * render.h, editing in edit.h, cooking from meshes in cook.h.
 *
 * Rules that hold everywhere
 *   - A descriptor struct filled with zeros asks for the defaults; `reserved` fields must be zero.
 *   - Functions that can fail return a gtx_result and take an optional, caller-owned gtx_error
 *     last. On failure the outputs are left NULL or untouched.
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
    GTX_CANCELLED = 1,            /* a progress callback asked to stop */
    GTX_ERROR_ARGUMENT = 10,      /* a NULL or an out-of-range argument */
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

/* Memory hooks. `alloc` returns at least `size` bytes aligned to 16, or NULL; `free` gets the size
 * back. Both may be called from any thread that calls into geotex. NULL hooks mean malloc and free.
 * Objects copy the struct: each is freed by the function named with it, through the hooks it was
 * made with. Memory that a call takes for its own use is given back before it returns. */
typedef struct gtx_allocator {
    void *(*alloc)(size_t size, void *user);
    void (*free)(void *memory, size_t size, void *user);
    void *user;
} gtx_allocator;

/* A host's threads, such as an engine's job system, for calls that can use several. `run` calls
 * job(i, data) once for every i below `count`, in any order, on any threads, in parallel or not,
 * and returns when all jobs have. A job neither waits for another nor calls `run`. Jobs may take
 * memory from the call's allocator, which must then be safe to call from several threads at once,
 * as malloc is. Results are the same, byte by byte and error by error, however jobs are run. Zeros,
 * like NULL, run the jobs one after another on the calling thread; the library has no threads of
 * its own. */
typedef struct gtx_jobs {
    void (*run)(uint32_t count, void (*job)(uint32_t index, void *data), void *data, void *user);
    void *user;
} gtx_jobs;

/* What a call may take for files that others made. 0 asks for a field's default, which grows with
 * the bytes that the call reads; UINT64_MAX lifts a limit. What would pass one ends in LIMIT before
 * it is taken. */
typedef struct gtx_limits {
    uint64_t memory;              /* bytes at once; 0 = 256 MiB and 2,000 for each byte read */
    uint64_t triangles;           /* of all models together, once polygons are cut and instances
                                     placed; 0 = 2^19 and 1.5 for each byte read */
    uint64_t texels;              /* of an asset's pages at level 0, and nodes of height grids;
                                     0 = 2^26 and 256 for each byte read */
    uint64_t pixels;              /* of one image; 0 = 2^26 and 16 for each byte read */
    uint64_t patches;             /* 0 = 2^20 */
    uint64_t cells;               /* that a ray may visit (gtx_ray_cells); 0 = 2^19 */
    uint64_t work;                /* of cooking and comparing, in steps that are counted: the same
                                     file always passes it or never; some 25 million take a second;
                                     a report's measuring may take as much again;
                                     0 = 3 x 2^26 and 32 for each byte read */
    uint32_t reserved[2];
} gtx_limits;

/* How far a long call has come. `stage` is a static string such as "bake". */
typedef struct gtx_progress {
    const char *stage;
    uint32_t stage_index, stage_count;
    float fraction;               /* of the whole call, 0..1, never falling */
} gtx_progress;

/* Called from the calling thread. Return non-zero to cancel: the call then returns
 * GTX_CANCELLED. */
typedef int (*gtx_progress_fn)(const gtx_progress *progress, void *user);

/* ---- assets ----------------------------------------------------------------------------- */

/* An asset in memory: patch records and maps, checked. Immutable after it was made. */
typedef struct gtx_asset gtx_asset;

enum { /* gtx_patch.flags */
    GTX_PATCH_TWO_SIDED = 1u << 8 /* the height field is visible from below too */
};

/* A patch: the frame of its parallelepiped and the rectangle of its maps. 128 bytes, the layout of
 * the file record (little-endian). Lengths are in object units, relative to the asset's anchor.
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
    float axis_z[3], coverage;    /* coverage: share of texels with a code, 0..1 */
    uint32_t page;
    uint16_t rect[4];             /* x, y, w, h in texels of the page at level 0 */
    uint16_t dilation;            /* rings of texels with valid normals, colours, materials and
                                     emission around the coded ones */
    uint16_t flags;
    float sphere[4];              /* centre and radius around the coded texels' surface */
    uint32_t source_triangles;    /* triangles of the chart */
    uint32_t reserved[7];
} gtx_patch;

typedef enum gtx_map {
    GTX_MAP_HEIGHT = 0,           /* level 0 only; uint8_t or uint16_t codes, 0 = empty */
    GTX_MAP_TRIM = 1,             /* level 0 only; uint8_t, (c - 128) / 16 texels outside the
                                     outline */
    GTX_MAP_NORMAL = 2,           /* 2 x uint8_t, hemi-octahedral in the patch's normal frame */
    GTX_MAP_COLOR = 3,            /* 4 x uint8_t, sRGB colour and linear alpha; may be absent */
    GTX_MAP_MATERIAL = 4,         /* 4 x uint8_t: occlusion, roughness, metallic, share of lighting
                                     (0: unlit); may be absent: 255, 255, 0, 255 */
    GTX_MAP_EMISSION = 5          /* 3 x uint8_t, sRGB, times emission_scale; may be absent */
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
    float emission_scale;         /* light of a full emission texel; 0 without emission */
    double anchor[3];             /* object-space position of the asset's origin */
    uint64_t source_triangles;
    uint64_t content_hash;        /* of the decoded sections: the same for any compression */
    uint64_t file_size;           /* bytes that were opened, 0 for a created asset */
} gtx_info;

typedef struct gtx_open_desc {
    const gtx_allocator *allocator;
    const gtx_jobs *jobs;         /* used during the call; opening then holds all coded sections in
                                     memory at once */
    gtx_limits limits;            /* memory, texels and patches */
    uint32_t flags;
    uint32_t reserved[5];
} gtx_open_desc;

enum { /* gtx_open_desc.flags */
    GTX_OPEN_SKIP_HASH = 1        /* trust the section hashes (the header hash is always checked) */
};

/* Reads an asset from `size` bytes, which may be freed afterwards. Every rule of format/gtx.md is
 * checked; hostile bytes end in an error, never in a fault. `desc` may be NULL. The asset comes
 * from the descriptor's allocator, and is freed by gtx_close.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, NOT_GTX, VERSION, TRUNCATED, CORRUPT,
 * UNSUPPORTED. */
GTX_API gtx_result gtx_open_memory(const void *data, size_t size, const gtx_open_desc *desc,
                                   gtx_asset **out, gtx_error *error);

/* The same from a file. Its bytes come from the allocator too, and count towards limits.memory,
 * while they are read. Errors: also READ. */
GTX_API gtx_result gtx_open_file(const char *path, const gtx_open_desc *desc, gtx_asset **out,
                                 gtx_error *error);

/* What the first bytes of a file tell. */
typedef struct gtx_prefix {
    uint64_t file_size;           /* bytes; 0 until the header is there */
    uint64_t needed;              /* so many first bytes show more than these; 0 = all are there */
    uint32_t reserved[4];
} gtx_prefix;

/* Opens the first `size` bytes of a file, as a download has them so far. *out is an asset of what
 * is there, or NULL where nothing can be shown yet; prefix->needed says what to wait for. Of less
 * than the whole file it has the patches; the LOD meshes that are there, the finest of them as
 * level 0; colours, material and emission as far as they are there; normals that follow from its
 * finest LOD mesh; all at fewer texels; and no heights, so that no ray meets it, and only
 * GTX_METHOD_AUTO and GTX_METHOD_LOD show it, and models of it take no gtx_model_update. Else it is
 * an asset as any other; that of all bytes is gtx_open_memory's. What is there is checked as if the
 * rest were right.
 * Errors: as gtx_open_memory; TRUNCATED is none. */
GTX_API gtx_result gtx_open_prefix(const void *data, size_t size, const gtx_open_desc *desc,
                                   gtx_prefix *prefix, gtx_asset **out, gtx_error *error);

/* Frees the asset. NULL is fine. */
GTX_API void gtx_close(gtx_asset *asset);

/* What the asset's header says, copied to *out. */
GTX_API void gtx_get_info(const gtx_asset *asset, gtx_info *out);

/* gtx_info.patch_count records, owned by the asset. */
GTX_API const gtx_patch *gtx_patches(const gtx_asset *asset);

/* All pages of one level of a map, page after page, rows tight, owned by the asset; *size (may be
 * NULL) gets the bytes. NULL when the asset has no such map or level. Level k is
 * (page_width >> k) x (page_height >> k). */
GTX_API const void *gtx_map_data(const gtx_asset *asset, gtx_map map, uint32_t level, size_t *size);

/* Of gtx_lod_mesh.flags, for models of a few pixels: a triangle may be larger than its patch; its
 * lookups are clamped to the patch's rectangle. */
#define GTX_LOD_FAR 1u

/* An LOD mesh: the whole surface as triangles, for drawing it small. A vertex is a position and
 * nothing else: triangles of several patches may share it, and its texel coordinates in each patch
 * follow from that patch's frame. Position q of a vertex stands for the point
 *   origin + step * q                                            relative to the asset's anchor. */
typedef struct gtx_lod_mesh {
    float origin[3], step;
    float error;                  /* object units: no point is farther from the source, none of the
                                     source from it, but for parts that are no longer */
    uint32_t vertex_count, triangle_count;
    uint32_t flags;               /* GTX_LOD_FAR */
    const uint32_t *first;        /* patch_count + 1: triangles first[p]..first[p + 1] - 1 belong
                                     to patch p */
    const uint32_t *indices;      /* 3 per triangle */
    const uint16_t *positions;    /* 3 per vertex */
} gtx_lod_mesh;

/* Gives LOD mesh `level`, 0 being the finest; its arrays are owned by the asset.
 * Errors: ARGUMENT (there is no such level). */
GTX_API gtx_result gtx_get_lod_mesh(const gtx_asset *asset, uint32_t level, gtx_lod_mesh *out);

/* The META section: JSON text of *size bytes, not terminated; NULL when absent. Informative. */
GTX_API const char *gtx_meta(const gtx_asset *asset, size_t *size);

/* No ray through the asset visits more cells of height fields than this, wherever it comes from and
 * goes: it bounds what rays, and pixels that are drawn (gtx_draw says how), cost. Tests of boxes in
 * hierarchies come on top, at most two for each block of 8 x 8 cells of the asset. It is the sum of
 * width and height over the patches that a ray may meet, found for bundles of rays and so from
 * above: ordinary assets have a few thousand up to 10^5, of which most rays visit a small part;
 * where patches are stacked in one place it is what a ray takes. limits.cells holds it wherever an
 * asset is prepared for rays or drawing. 0 for NULL. Takes time in proportion to the patches, and
 * no memory. */
GTX_API uint64_t gtx_ray_cells(const gtx_asset *asset);

/* ---- validation ------------------------------------------------------------------------- */

typedef struct gtx_issue {
    uint32_t rule;                /* number in format/gtx.md */
    uint32_t is_error;            /* 0: a warning */
    uint64_t offset;              /* byte offset in the file */
    const char *name;             /* short identifier such as "patch-axis-unit" */
    const char *message;          /* one sentence; valid during the call */
} gtx_issue;

typedef void (*gtx_issue_fn)(const gtx_issue *issue, void *user);

/* Checks untrusted bytes against every rule of format/gtx.md and reports each broken one, in the
 * order of its section 7, for as long as it is safe to read on.
 * GTX_OK when no error was reported (warnings do not count). `limits` and `fn` may be NULL. Takes
 * from malloc what opening would.
 * Errors: as gtx_open_memory; a broken rule comes before MEMORY and LIMIT. */
GTX_API gtx_result gtx_validate(const void *data, size_t size, const gtx_limits *limits,
                                gtx_issue_fn fn, void *user, gtx_error *error);

/* ---- creating and encoding -------------------------------------------------------------- */

/* The content of an asset. All arrays are copied and checked by the rules of format/gtx.md;
 * coverage, spheres and bounds must be given (the rules check them). */
typedef struct gtx_asset_desc {
    const gtx_patch *patches;
    uint32_t patch_count;
    uint32_t page_count, page_width, page_height;
    uint32_t mip_count;           /* 1..8 */
    uint32_t height_bits;         /* 8 or 16 */
    const void *height;           /* page_count * page_width * page_height codes */
    const uint8_t *trim;          /* the same count */
    const uint8_t *const *normal; /* mip_count pointers, level 0 first */
    const uint8_t *const *color;  /* mip_count pointers, or NULL; so are the next two */
    const uint8_t *const *material;
    const uint8_t *const *emission;
    float emission_scale;         /* 0 = 1 if there is emission */
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

/* Makes an asset from the descriptor's allocator, which gtx_close frees.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, CORRUPT (with the broken rule). */
GTX_API gtx_result gtx_create(const gtx_asset_desc *desc, gtx_asset **out, gtx_error *error);

typedef struct gtx_encode_desc {
    const gtx_allocator *allocator;
    const gtx_jobs *jobs;         /* used during the call; encoding then holds all sections in
                                     memory at once */
    int32_t zstd_level;           /* 1..19; 0 = 3 (stored, in a build without zstd); -1 = stored */
    uint32_t reserved[5];
} gtx_encode_desc;

/* Encodes the asset as the bytes of a `.gtx` file. *data comes from the descriptor's allocator
 * (malloc when none), and is freed with it, as *size bytes. The same asset and options give the
 * same bytes (for one zstd version). Errors: ARGUMENT, NOT_ZEROED, MEMORY, UNSUPPORTED (built
 * without zstd). */
GTX_API gtx_result gtx_encode(const gtx_asset *asset, const gtx_encode_desc *desc, void **data,
                              size_t *size, gtx_error *error);

/* Encodes, with the descriptor's allocator, and writes a file: whole, under a temporary name of its
 * own in the same folder, or not at all. It takes the place of what was there once it is on the
 * disk, and keeps its permissions; a symbolic link stays one, and devices and pipes are written to.
 * Errors: also WRITE. */
GTX_API gtx_result gtx_save_file(const gtx_asset *asset, const char *path,
                                 const gtx_encode_desc *desc, gtx_error *error);

/* ---- ray query -------------------------------------------------------------------------- */

/* What casting rays on the CPU derives from an asset: levels, bounds and a hierarchy over the
 * patches. Keeps no reference to the asset. Immutable; any number of threads may cast at once. */
typedef struct gtx_caster gtx_caster;

typedef struct gtx_caster_desc {
    const gtx_allocator *allocator;
    uint32_t level;               /* level of the height fields to cast, 0 = finest .. 7 */
    /* Object units; when > 0, each patch is cast at the coarsest of its mip_count levels that is
     * within this distance of level 0, as the renderer chooses levels; `level` must then be 0. */
    float max_error;
    gtx_limits limits;            /* memory and cells */
    uint32_t reserved[4];
} gtx_caster_desc;

/* Coordinates are relative to the asset's anchor. `direction` need not be normalised; t is in
 * units of its length. Hits with t_min <= t <= t_max are found; t_max <= 0 means infinity. */
typedef struct gtx_ray {
    float origin[3], t_min;
    float direction[3], t_max;
} gtx_ray;

typedef struct gtx_hit {
    float t;                      /* along the ray; infinity when nothing was hit */
    uint32_t patch;               /* index of the patch, UINT32_MAX when nothing was hit */
    float x, y;                   /* texel coordinates in the patch: texel i is at x = i */
    float normal[3];              /* unit normal from the normal map, object space */
    float facet[3];               /* unit geometric normal of the height field, on the side of
                                     axis_z */
    uint32_t back;                /* 1: the ray crossed the height field from below */
} gtx_hit;

enum { /* flags of gtx_raycast */
    GTX_RAY_ANY = 1,              /* any hit will do (shadows); t and normal are that hit's */
    GTX_RAY_TWO_SIDED = 2,        /* accept crossings from below in every patch */
    GTX_RAY_EXHAUSTIVE = 4        /* visit every cell of every patch: the slow reference,
                                     without a bound */
};

/* Makes a caster from the descriptor's allocator; gtx_caster_destroy frees it. `desc` may be NULL.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT. */
GTX_API gtx_result gtx_caster_create(const gtx_asset *asset, const gtx_caster_desc *desc,
                                     gtx_caster **out, gtx_error *error);
/* NULL is fine. */
GTX_API void gtx_caster_destroy(gtx_caster *caster);

/* Casts `count` rays; takes no memory. A ray with a NaN, or with a zero direction, hits nothing.
 * Errors: ARGUMENT. */
GTX_API gtx_result gtx_raycast(const gtx_caster *caster, const gtx_ray *rays, gtx_hit *hits,
                               size_t count, uint32_t flags);

/* The surface under points, for things that stand, fall or drive: casts a ray straight down,
 * against `up` (of any length but 0), starting `step` >= 0 object units above each point, so that a
 * surface a little above the point counts too. hit.t is the height of the point above the surface,
 * in object units: negative when the surface is above it, infinite when there is none. Flags as for
 * gtx_raycast. Errors: ARGUMENT. */
GTX_API gtx_result gtx_drop(const gtx_caster *caster, const float up[3], float step,
                            const float (*points)[3], gtx_hit *hits, size_t count,
                            uint32_t flags);

/* The colour map at hits: linear red, green, blue and alpha, each 0..1, interpolated between the
 * texels of level 0; white where nothing was hit, or if the asset has no colours. `asset` is the
 * one that the caster was made from. Errors: ARGUMENT. */
GTX_API gtx_result gtx_hit_colors(const gtx_asset *asset, const gtx_hit *hits,
                                  float (*colors)[4], size_t count);

/* ---- scenes: rays among instances ------------------------------------------------------------ */

/* Casters placed in a world, with a hierarchy over them. Keeps references to the casters, which
 * must outlive it. Immutable; any number of threads may use it at once. */
typedef struct gtx_scene gtx_scene;

/* `transform` is column-major and affine, and takes the asset's coordinates (relative to its
 * anchor) to the world; its linear part must be invertible. */
typedef struct gtx_scene_instance {
    const gtx_caster *caster;
    float transform[16];
} gtx_scene_instance;

/* Makes a scene from `allocator` (NULL = malloc); gtx_scene_destroy frees it.
 * Errors: ARGUMENT (an instance without a caster, or a transform that is not as said above),
 * MEMORY. */
GTX_API gtx_result gtx_scene_create(const gtx_scene_instance *instances, uint32_t count,
                                    const gtx_allocator *allocator, gtx_scene **out,
                                    gtx_error *error);
/* NULL is fine. */
GTX_API void gtx_scene_destroy(gtx_scene *scene);

/* gtx_raycast in the world: rays, normals and facets are in world space. `which` gets the index of
 * the instance that was hit, UINT32_MAX for none; it may be NULL. Errors: ARGUMENT. */
GTX_API gtx_result gtx_scene_raycast(const gtx_scene *scene, const gtx_ray *rays, gtx_hit *hits,
                                     uint32_t *which, size_t count, uint32_t flags);

/* A point to be lit: world position, unit normal towards the visible side, and `turn`, 0..1, which
 * rotates the pattern of its rays. Random turns trade banding for grain. */
typedef struct gtx_lit_point {
    float position[3], normal[3];
    float turn;
} gtx_lit_point;

/* A distant disc of light, or the sky. */
typedef struct gtx_light_desc {
    float direction[3];           /* world, towards the light; zero: the sky, the hemisphere above
                                     each point, weighted by the cosine */
    float spread;                 /* tangent of half the disc's angle; 0: hard shadows */
    float reach;                  /* length of the rays, world units: what is farther away does not
                                     occlude; 0 = infinite */
    uint32_t rays;                /* for each point; 0 = 1 */
    float offset;                 /* distance from the surface at which rays start; 0 =
                                     gtx_scene_offset */
    uint32_t reserved[5];
} gtx_light_desc;

/* The share of the light, 0..1, that reaches each point past all patches of all instances: for a
 * disc, a hard or soft shadow, still to be multiplied by the cosine; for the sky, ambient
 * occlusion. A disc's rays below the horizon of the normal count as dark. The same arguments give
 * the same shares; shaders use the same patterns (geotex_rays.glsl). Errors: ARGUMENT,
 * NOT_ZEROED. */
GTX_API gtx_result gtx_scene_light(const gtx_scene *scene, const gtx_light_desc *light,
                                   const gtx_lit_point *points, float *shares, size_t count);

/* The default distance from the surface at which rays start, in world units: two height steps of
 * the patch with the coarsest ones, or a 32nd of a texel if that is more. Heights are rounded by up
 * to half a step, and cells cut a little into round shapes: started from there, no ray that leaves
 * a convex surface meets it again, however grazing. The offset hides nothing else. */
GTX_API float gtx_scene_offset(const gtx_scene *scene);

#ifdef __cplusplus
}
#endif
#endif
