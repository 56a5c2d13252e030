/* Cooking: triangle meshes and height grids -> `.gtx` assets. Links libgeotex-cook (C++17 inside).
 *
 * The pipeline is the paper's (section 5): import, clean, partition, overlap, frame, bake, dilate,
 * pack, LOD meshes, measure. The same input and options give the same bytes, whatever the thread
 * count.
 *
 * Memory. The descriptors' `allocator` (NULL = malloc) gives everything that outlives a call, the
 * asset and the report, and what libgeotex needs meanwhile: opening, encoding, casting, writing
 * JSON. It is called from the calling thread alone. The C++ containers that hold models, charts and
 * maps while they are made, and the decoders (OpenMesh, Draco, tinygltf, meshoptimizer, zlib,
 * OpenImageIO), use the process's own heap. If that runs out the result is MEMORY too, except that
 * an image for which there is no memory is ignored with a warning.
 *
 * Limits. limits.memory is held against what the containers have on all threads of the call, each
 * time that one takes memory; images and Draco meshes count before they are decoded, by the size
 * that they claim. What the decoders take beside that, in proportion to the bytes that they read,
 * is not counted, nor what the allocator gives. */
#ifndef GEOTEX_COOK_H
#define GEOTEX_COOK_H

#include <geotex/geotex.h>
#include <geotex/grid.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum gtx_partition {
    GTX_PARTITION_DEFAULT = 0,    /* cuts; for sharp outlines finer layers, as AUTO has them */
    GTX_PARTITION_CUTS = 1,       /* few large charts that fold nowhere, cut straight */
    GTX_PARTITION_VSA = 2,        /* variational shape approximation (paper, section 5.2) */
    GTX_PARTITION_PGP = 3,        /* periodic global parameterization: squares along the principal
                                     directions of curvature (paper, section 5.1) */
    GTX_PARTITION_LAYERS = 4,     /* peeled along three axes, those of the object or of its large
                                     flat parts; what lies above itself is split into layers, and
                                     small pieces of a layer share a patch (Santos, de Toledo,
                                     Gattass, SPM 2008) */
    GTX_PARTITION_RELIEF = 5,     /* one height map from each side of the object's box, at most six
                                     patches: what no side sees is lost, with a warning
                                     ("unseen-surface"; Oliveira, Bishop, McAllister, 2000) */
    GTX_PARTITION_AUTO = 6        /* cuts or layers, whichever takes fewer texels at one density;
                                     but where cuts would lose more than 0.003 of an outline, and
                                     neither a resolution nor an error is asked for, layers of up
                                     to twice as fine texels, about 2.5 times as many at most.
                                     Takes the time of two partitions, or of up to six */
} gtx_partition;

/* How the maps are extracted from the patches' triangles. GPU is the paper's method (section 5):
 * each patch is rendered along its frame's z, vertex colours unlit, normals renormalised. Textures
 * are still looked up, and the surface continued past a patch's border, by the CPU. On Mesa's
 * llvmpipe both agree within one code on 99.9 % of the texels that both cover. The bytes depend on
 * the driver, which the report names; OpenGL 3.3 is asked for through EGL, without a window. An EGL
 * context that is current on the calling thread is made current again afterwards. */
typedef enum gtx_extract {
    GTX_EXTRACT_DEFAULT = 0,      /* cpu */
    GTX_EXTRACT_CPU = 1,
    GTX_EXTRACT_GPU = 2
} gtx_extract;

/* Gets the paths of the files behind the models, which exist, once they are known and before
 * anything is made of them; again with more of them, where importing read files that could not be
 * foreseen. What it returns but GTX_OK, with `error` filled, ends the call. */
typedef gtx_result (*gtx_sources_fn)(const char *const *paths, size_t count, void *user,
                                     gtx_error *error);

/* For lod_levels: an asset without LOD meshes. */
#define GTX_LOD_LEVELS_NONE 0xffffffffu

/* For texel_density: as many texels as relief needs, whatever textures show. */
#define GTX_TEXEL_DENSITY_RELIEF (-1.0f)

/* Blocks that a cook adds to an asset, so that models need not encode them: those that
 * gtx_add_blocks (frame.h) adds for the gtx_compression k, 1 << k each. */
enum {
    GTX_TEXTURES_NORMALS = 1,     /* with the others: normals, too */
    GTX_TEXTURES_BC = 2,
    GTX_TEXTURES_ETC2 = 4,
    GTX_TEXTURES_BC_SMALL = 8
};

typedef struct gtx_cook_desc {
    gtx_partition partition;
    gtx_extract extract;
    uint32_t charts;              /* wanted number of patches, up to 2^20; 0 = round(10 T^0.28) for
                                     T triangles */
    uint32_t resolution;          /* most texels along a patch side, 64..512, but for what textures
                                     ask for (texel_density); 0 = 128. It sets the density too: at
                                     128 patches have 1,400 texels of surface on average (cuts);
                                     the longest patch has this side (vsa, pgp, relief) */
    uint32_t height_bits;         /* 8 or 16; 0 = 8 */
    uint32_t dilation;            /* rings of dilated texels in all maps but height and trim, up to
                                     128; 0 = 2^(mips - 1) */
    uint32_t mips;                /* mip levels of these maps, 1..8; 0 = 4 */
    int32_t zstd_level;           /* 1..19; 0 = 3 (stored, in a build without zstd); -1 = stored */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    float unit;                   /* metres per object unit; 0 = 1 */
    uint32_t z_up;                /* 1: the models' +Z becomes +Y, and their +Y -Z */
    double error;                 /* greatest RMS distance from the source to the asset, as a
                                     fraction of the source's bounding diagonal; 0 = none. The
                                     density, and height_bits and charts if they are 0, are chosen
                                     for the fewest bytes. LIMIT if no density reaches it. For the
                                     partitions cuts, layers and auto */
    uint32_t measure;             /* 1: measure the error, for the report */
    gtx_progress_fn progress;     /* may be NULL */
    void *progress_user;
    uint32_t lod_levels;          /* LOD meshes, 1..5; 0 = 5; up to 3 far ones follow. Or
                                     GTX_LOD_LEVELS_NONE */
    const char *charts_ply;       /* where to write the partition before splitting, as a PLY with a
                                     colour per chart, inverted triangles green; or NULL */
    const char *const *more;      /* paths of further models to cook into the same asset */
    uint32_t more_count;
    uint32_t strict;              /* 1: a warning is an error (INPUT), and nothing is written; notes
                                     are none */
    uint32_t if_changed;          /* 1: gtx_cook_file does not touch an output that is a valid asset
                                     with the same key (below) */
    const gtx_allocator *allocator;   /* needed during the call; its hooks until all is freed */
    uint32_t adaptive;            /* 1: squares of half to twice the side, smaller where the surface
                                     is more curved; for the partition pgp */
    gtx_limits limits;            /* all of them; bytes read are those of the models and of the
                                     files that these refer to */
    gtx_sources_fn sources_fn;    /* may be NULL */
    void *sources_user;
    const double *kept;           /* vertices of the models that LOD meshes but far ones keep where
                                     they are, three numbers each, as they lie in the asset: for a
                                     model that is part of a larger one; or NULL */
    uint64_t kept_count;
    float texel_density;          /* texels along a side, at least, for a pixel of the source's
                                     textures, up to 4; no side gets more than 512. 0: as many as
                                     their detail needs, up to 4 times as fine as relief needs, but
                                     in all not more than 524,288, and one for each byte read,
                                     beyond relief's. Or GTX_TEXEL_DENSITY_RELIEF */
    const char *const *allow;     /* names of warnings that are no errors with `strict`; or NULL */
    uint32_t allow_count;         /* up to 64 */
    const char *cache;            /* a folder of assets by their keys, or NULL: what it has is not
                                     cooked, and what is cooked is kept. Threads and machines may
                                     share it */
    const char *texture_dir;      /* a folder for textures that are not beside a model, looked for
                                     there by their file names alone; or NULL */
    const char *base_color;       /* path of the image for materials that have none or an unreadable
                                     one, in OBJ and glTF with texture coordinates; or NULL. If it
                                     cannot be read: READ. Compare with the same two */
    uint32_t closed;              /* 1: the models are part of a closed surface, counterclockwise
                                     seen from outside: their borders are where it is cut, and their
                                     patches are seen from the front alone */
    uint32_t texture_formats;     /* GTX_TEXTURES_...: blocks for GPUs, kept beside the texels */
    uint32_t reserved[2];
} gtx_cook_desc;

/* An asset keeps the key that it was cooked under. The key covers
 *   - the content of every file behind the models: themselves, and the buffers, material libraries
 *     and images that they refer to, missing ones included; not their paths or times;
 *   - the options that change the asset: partition, extract (and the driver, where it is GPU),
 *     charts, resolution, height_bits, dilation, mips, lod_levels, zstd_level, unit, error, z_up,
 *     adaptive, kept, closed, texel_density, texture_formats, base_color; not threads, measure,
 *     progress, strict, allow, limits or allocator;
 *   - geotex's version and the revision of its cooker,
 * but not the libraries that decode images and compress sections. With `strict`, an asset whose
 * cook had warnings that are not allowed is cooked again; with `charts_ply`, or if importing read
 * files that could not be foreseen, any is.
 *
 * A cache takes what is in it by these keys, as whole files, copied to the output: a truncated or
 * damaged entry, which any hash of the format tells, is cooked again and replaced. Keys detect
 * accidents, not attacks: who may write to a cache is trusted. */

/* What a call did, as JSON; written only on success, freed by gtx_report_free. All that it points
 * to lies in one block from the call's allocator, whose hooks it keeps. */
typedef struct gtx_report {
    char *json;                   /* terminated */
    size_t size;
    char summary[160];            /* one line: patches, texels, bytes, seconds */
    uint32_t unchanged;           /* 1: if_changed, and the output was left alone */
    uint32_t cached;              /* 1: the cache had the asset */
    char **sources;               /* paths of the files behind the models, the first model first */
    size_t source_count;
    char **warnings;              /* one sentence each, for people; the last note_count are notes:
                                     of what is as it should be in many models, such as an open
                                     border, or is mended without a loss */
    size_t warning_count, note_count;
    const char **warning_names;   /* as many: what kind each is, such as "open-edges", for programs;
                                     static. All are in format/cook-report.schema.json */
    gtx_allocator allocator;      /* gave `block`, and takes it back */
    void *block;
    size_t block_size;
} gtx_report;

/* Reads the model at `input` (glTF, GLB, Draco, OBJ, PLY, OFF, STL, each also gzipped), cooks it
 * and writes the asset to `output`, as gtx_save_file does. Neither it nor charts_ply may be a file
 * that the models are read from, under whatever name (ARGUMENT).
 * `desc`, `report` (format/cook-report.schema.json) and `error` may be NULL. Any thread.
 * Errors: CANCELLED, ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, READ, WRITE, INPUT, EMPTY, UNSUPPORTED,
 * INTERNAL; GL and SHADER if the GPU is to extract and no driver can. */
GTX_API gtx_result gtx_cook_file(const char *input, const char *output, const gtx_cook_desc *desc,
                                 gtx_report *report, gtx_error *error);

/* The same for the `size` bytes of a model file, into memory: the asset comes from the descriptor's
 * allocator, gtx_close frees it, and gtx_encode makes a file of it. `name` is a path that need not
 * exist: its extension tells the format if the bytes do not, and files that the model refers to are
 * looked for beside it. Any thread. Errors: as gtx_cook_file. */
GTX_API gtx_result gtx_cook_memory(const void *data, size_t size, const char *name,
                                   const gtx_cook_desc *desc, gtx_asset **out, gtx_report *report,
                                   gtx_error *error);

/* LOD meshes for an asset that has no source mesh: one whose maps were edited or filtered, or that
 * was made of height grids. */
typedef struct gtx_lod_desc {
    uint32_t levels;              /* at most, 1..5; 0 = 5; up to 3 far ones follow */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    gtx_progress_fn progress;     /* may be NULL */
    void *progress_user;
    const gtx_allocator *allocator;   /* for the new asset */
    gtx_limits limits;            /* memory; the asset's maps count as read */
    uint32_t reserved[6];
} gtx_lod_desc;

/* Makes a copy of `asset`, which gtx_close frees, with LOD meshes simplified from what its maps
 * show in place of any that it had. Overlapping height fields are cut along the line where both are
 * equally deep inside their outlines, and welded there, so that neighbours share their border
 * vertices. The finest LOD mesh aims at a ninth of the asset's source_triangles (if that is 0, of
 * two triangles per texel); each `error` is a distance from the maps' own surface. The same asset
 * and options give the same bytes. `desc` may be NULL. Any thread.
 * Errors: CANCELLED, ARGUMENT, NOT_ZEROED, MEMORY, LIMIT (a patch lies more than 10^9 times its
 * size away from the anchor), INTERNAL. */
GTX_API gtx_result gtx_cook_lod_meshes(const gtx_asset *asset, const gtx_lod_desc *desc,
                                       gtx_asset **out, gtx_error *error);

/* ---- comparing ----------------------------------------------------------------------------- */

typedef struct gtx_compare_desc {
    uint32_t size;                /* pixels along a side of a view, up to 4096; 0 = 1024 */
    uint32_t levels;              /* levels of the height fields to measure, up to 8; 0 = the mip
                                     count */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    gtx_progress_fn progress;
    void *progress_user;
    uint32_t z_up;                /* as it was cooked; so are the next two */
    const char *const *more;
    uint32_t more_count;
    const gtx_allocator *allocator;
    gtx_limits limits;            /* as for gtx_cook_desc; the asset counts as read too */
    uint32_t random_views;        /* beside the 26 fixed ones, up to 4096: those of `seed` */
    uint32_t seed;
    const char *texture_dir, *base_color; /* as for gtx_cook_desc */
    uint32_t any_model;           /* 1: also a model that is not the one that the asset names as its
                                     source, by a hash of its content and its textures' */
    uint32_t reserved[5];
} gtx_compare_desc;

/* The figures that a build may put limits on; format/measures.md has the rules of each. */
typedef struct gtx_compare_result {
    uint64_t hole_pixels, wall_pixels, surface_pixels;
    double silhouette_iou, silhouette_iou_min;
    double forward_rms;           /* fractions of the source's bounding diagonal */
    double reverse_max;
    /* Gaps between patches where they meet, in height steps of the coarser one. */
    double seam_p99_steps, seam_max_steps;
} gtx_compare_result;

/* Measures an asset against `model`, the mesh file that it was cooked from. `desc`, `result`,
 * `report` (format/compare-report.schema.json) and `error` may be NULL. Any thread.
 * Errors: as gtx_cook_file and gtx_open_file; INPUT if the asset was cooked from another model. */
GTX_API gtx_result gtx_compare_files(const char *asset, const char *model,
                                     const gtx_compare_desc *desc, gtx_compare_result *result,
                                     gtx_report *report, gtx_error *error);

/* Frees what a report owns, with the allocator of the call that wrote it, and zeroes it. NULL and a
 * report of zeros are fine. */
GTX_API void gtx_report_free(gtx_report *report);

#ifdef __cplusplus
}
#endif
#endif
