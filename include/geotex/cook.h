/* Cooking: triangle meshes and height grids -> `.gtx` assets. Links libgeotex-cook (C++17 inside).
 *
 * The pipeline is the paper's (section 5): import, clean, partition, overlap, frame, bake, dilate,
 * pack, LOD meshes, measure. The same input and options give the same bytes, whatever the thread
 * count.
 *
 * Memory. Everything that outlives a call (the asset, the report) and everything that libgeotex
 * allocates during it comes from the descriptors' `allocator` (NULL = malloc), which is called from
 * the calling thread only. The C++ containers that hold models, charts and maps during a cook, and
 * the decoders (OpenMesh, Draco, tinygltf, meshoptimizer, zlib, libpng, libjpeg, OpenImageIO), use
 * the process's heap. If that runs out the result is MEMORY too, except that an image for which
 * there is no memory is ignored with a warning.
 *
 * Limits. limits.memory bounds what these containers hold on all threads of the call; images and
 * Draco meshes are counted before they are decoded, by the size that their headers declare. Not
 * counted are the decoders' other needs, which grow with the bytes that they read, and what comes
 * from `allocator`. */
#ifndef GEOTEX_COOK_H
#define GEOTEX_COOK_H

#include <geotex/geotex.h>
#include <geotex/grid.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum gtx_partition {
    GTX_PARTITION_DEFAULT = 0,    /* cuts; where these would lose too much of an outline, the finer
                                     layers of AUTO */
    GTX_PARTITION_CUTS = 1,       /* few large charts without folds, cut along straight lines */
    GTX_PARTITION_VSA = 2,        /* variational shape approximation (paper, section 5.2) */
    GTX_PARTITION_PGP = 3,        /* periodic global parameterization: squares along the principal
                                     directions of curvature (paper, section 5.1) */
    GTX_PARTITION_LAYERS = 4,     /* projected along three axes, those of the object or of its large
                                     flat parts; surface that overlaps itself along an axis is split
                                     into layers, and small pieces of a layer share a patch (Santos,
                                     de Toledo, Gattass, SPM 2008) */
    GTX_PARTITION_RELIEF = 5,     /* one height map for each side of the object's bounding box, at
                                     most six patches; surface that no side sees is lost, with the
                                     warning "unseen-surface" (Oliveira, Bishop, McAllister,
                                     SIGGRAPH 2000) */
    GTX_PARTITION_AUTO = 6        /* cuts or layers, whichever takes fewer texels at equal density;
                                     but where cuts would lose more than 0.003 of an outline, and
                                     neither a resolution nor an error is asked for, layers of up to
                                     twice the density, and about 2.5 times the texels at most.
                                     Takes the time of two to six partitions */
} gtx_partition;

/* How the maps are extracted from the patches' triangles. GPU is the paper's method (section 5):
 * each patch is rendered along its frame's z, with unlit vertex colours and renormalised normals.
 * The CPU still samples textures, and extrapolates the surface past a patch's border. On Mesa's
 * llvmpipe both agree within one height code on 99.9 % of the texels that both cover. With GPU the
 * bytes depend on the driver, which the report names. The OpenGL 3.3 context is created with EGL,
 * without a window; an EGL context that is current on the calling thread is made current again
 * afterwards. */
typedef enum gtx_extract {
    GTX_EXTRACT_DEFAULT = 0,      /* cpu */
    GTX_EXTRACT_CPU = 1,
    GTX_EXTRACT_GPU = 2
} gtx_extract;

/* Told the paths of the files that the models consist of, all of which exist, before they are
 * cooked; told again, with more paths, if importing read files that could not be foreseen. To stop
 * the call, return a result other than GTX_OK and fill `error`. */
typedef gtx_result (*gtx_sources_fn)(const char *const *paths, size_t count, void *user,
                                     gtx_error *error);

/* A value of lod_levels: no LOD meshes. */
#define GTX_LOD_LEVELS_NONE 0xffffffffu

/* A value of texel_density: as many texels as the relief needs, whatever the textures show. */
#define GTX_TEXEL_DENSITY_RELIEF (-1.0f)

/* Flags of texture_formats: block-compressed copies of the maps that a cook adds to the asset, so
 * that they need not be encoded at load time. 1 << k stands for the gtx_compression k of
 * gtx_add_blocks (frame.h). */
enum {
    GTX_TEXTURES_NORMALS = 1,     /* normals too, in each of the formats chosen */
    GTX_TEXTURES_BC = 2,
    GTX_TEXTURES_ETC2 = 4,
    GTX_TEXTURES_BC_SMALL = 8
};

typedef struct gtx_cook_desc {
    gtx_partition partition;
    gtx_extract extract;
    uint32_t charts;              /* number of patches to aim at, up to 2^20; 0 = round(10 T^0.28)
                                     for T triangles */
    uint32_t resolution;          /* most texels along a side of a patch, 64..512, except where
                                     textures ask for more (texel_density); 0 = 128. Sets the
                                     density too: at 128, patches have 1,400 texels of surface on
                                     average (cuts), or the longest patch has this side (vsa, pgp,
                                     relief) */
    uint32_t height_bits;         /* 8 or 16; 0 = 8 */
    uint32_t dilation;            /* rings of dilated texels in all maps but heights and trim, up to
                                     128; 0 = 2^(mips - 1) */
    uint32_t mips;                /* mip levels of the same maps, 1..8; 0 = 4 */
    int32_t zstd_level;           /* 1..19; 0 = 6 (stored, in a build without zstd); -1 = stored */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    float unit;                   /* metres per object unit; 0 = 1 */
    uint32_t z_up;                /* 1: the models' +Z becomes +Y, and their +Y becomes -Z */
    double error;                 /* upper bound on the RMS distance from the source to the asset,
                                     as a fraction of the source's bounding-box diagonal; 0 = none.
                                     The density (and height_bits and charts, if 0) is chosen for
                                     the fewest bytes. LIMIT if no density reaches it. For the
                                     partitions cuts, layers and auto */
    uint32_t measure;             /* 1: measure the error for the report */
    gtx_progress_fn progress;     /* may be NULL */
    void *progress_user;
    uint32_t lod_levels;          /* most LOD meshes, 1..5; 0 = 5; up to 3 far ones follow. Or
                                     GTX_LOD_LEVELS_NONE */
    const char *charts_ply;       /* path to write the partition before splitting to, as a PLY with
                                     a colour per chart and inverted triangles in green; or NULL */
    const char *const *more;      /* paths of further models to cook into the same asset */
    uint32_t more_count;
    uint32_t strict;              /* 1: a warning is an error (INPUT), and nothing is written; a
                                     note is not */
    uint32_t if_changed;          /* 1: gtx_cook_file does not touch an output that is a valid asset
                                     with the same key (see below) */
    const gtx_allocator *allocator;   /* read during the call; its hooks until all is freed */
    uint32_t adaptive;            /* 1: squares of half to twice the side, smaller where curvature
                                     is higher; for the partition pgp */
    gtx_limits limits;            /* all of them; the bytes read are those of the models and of the
                                     files that they refer to */
    gtx_sources_fn sources_fn;    /* may be NULL */
    void *sources_user;
    const double *kept;           /* for a model that is part of a larger one: positions, in the
                                     asset's coordinates, of vertices that LOD meshes (except far
                                     ones) must not move, three numbers each; or NULL */
    uint64_t kept_count;
    float texel_density;          /* least number of texels, along a side, per pixel of the source's
                                     textures, up to 4; no patch side gets more than 512. 0: what
                                     their detail needs, up to 4 times the density that the relief
                                     needs, and in total at most 524,288 texels + 1 per byte read
                                     more than the relief needs. Or GTX_TEXEL_DENSITY_RELIEF */
    const char *const *allow;     /* names of warnings that `strict` tolerates; or NULL */
    uint32_t allow_count;         /* up to 64 */
    const char *cache;            /* a folder of assets named by their keys, or NULL: an asset that
                                     is there is not cooked again, and a cooked one is stored. May
                                     be shared by threads and machines */
    const char *texture_dir;      /* a folder in which to look, by file name, for textures that are
                                     not where the model says; or NULL */
    const char *base_color;       /* path of the image for materials of OBJ and glTF that have none
                                     or an unreadable one, and have texture coordinates; or NULL. If
                                     it cannot be read: READ. gtx_compare_files needs the same
                                     texture_dir and base_color */
    uint32_t closed;              /* 1: the models are parts of a closed surface, counter-clockwise
                                     seen from outside: their borders are cuts through it, and their
                                     patches are visible from the front only */
    uint32_t texture_formats;     /* GTX_TEXTURES_...: block-compressed maps, stored beside the
                                     uncompressed ones */
    uint32_t reserved[2];
} gtx_cook_desc;

/* An asset stores the key that it was cooked under. The key covers
 *   - the content of every file that the models consist of: themselves, and the buffers, material
 *     libraries and images that they refer to, missing ones included; not their paths or times;
 *   - the options that change the asset: partition, extract (and the driver, where it is GPU),
 *     charts, resolution, height_bits, dilation, mips, lod_levels, zstd_level, unit, error, z_up,
 *     adaptive, kept, closed, texel_density, texture_formats, base_color; not threads, measure,
 *     progress, strict, allow, limits or allocator;
 *   - geotex's version and the revision of its cooker,
 * but not the libraries that decode images and compress sections. With `strict`, an asset whose
 * cook had warnings that are not allowed is cooked again whatever its key; with `charts_ply`, or if
 * importing read files that could not be foreseen, every asset is.
 *
 * A cache holds assets as whole files, named by these keys and copied to the output. A truncated or
 * damaged entry is detected by the format's hashes, cooked again and replaced. The hashes detect
 * accidents, not attacks: whoever may write to a cache is trusted. */

/* What a call did. Written only on success; free it with gtx_report_free. Everything that it points
 * to lies in one block from the call's allocator, whose hooks it keeps. */
typedef struct gtx_report {
    char *json;                   /* the report, null-terminated */
    size_t size;                  /* its length in bytes */
    char summary[160];            /* one line: patches, texels, bytes, seconds */
    uint32_t unchanged;           /* 1: if_changed was set, and the output was left alone */
    uint32_t cached;              /* 1: the asset was taken from the cache */
    char **sources;               /* paths of the files that the models consist of, the first model
                                     first */
    size_t source_count;
    char **warnings;              /* warning_count sentences, for people; the last note_count of
                                     them are notes: about what is normal in many models, such as an
                                     open border, or was repaired without loss */
    size_t warning_count, note_count;
    const char **warning_names;   /* for programs: the kind of each warning, such as "open-edges";
                                     static. format/cook-report.schema.json lists them */
    gtx_allocator allocator;      /* gave `block`, and takes it back */
    void *block;
    size_t block_size;
} gtx_report;

/* Reads the model at `input` (glTF, GLB, Draco, OBJ, PLY, OFF or STL, or one of these gzipped),
 * cooks it and writes the asset to `output`, as gtx_save_file does. Neither `output` nor charts_ply
 * may be a file that the models are read from, under any of its names (ARGUMENT).
 * `desc`, `report` (format/cook-report.schema.json) and `error` may be NULL. Any thread.
 * Errors: CANCELLED, ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, READ, WRITE, INPUT, EMPTY, UNSUPPORTED,
 * INTERNAL; with GTX_EXTRACT_GPU also GL and SHADER. */
GTX_API gtx_result gtx_cook_file(const char *input, const char *output, const gtx_cook_desc *desc,
                                 gtx_report *report, gtx_error *error);

/* Cooks the `size` bytes of a model file into an asset in memory, allocated from the descriptor's
 * allocator; free it with gtx_close. `name` is a path that need not exist: its extension tells the
 * format if the bytes do not, and files that the model refers to are looked for beside it. Any
 * thread. Errors: as gtx_cook_file. */
GTX_API gtx_result gtx_cook_memory(const void *data, size_t size, const char *name,
                                   const gtx_cook_desc *desc, gtx_asset **out, gtx_report *report,
                                   gtx_error *error);

/* For an asset without a source mesh: one whose maps were edited or filtered, or that was made of
 * height grids. */
typedef struct gtx_lod_desc {
    uint32_t levels;              /* most LOD meshes, 1..5; 0 = 5; up to 3 far ones follow */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    gtx_progress_fn progress;     /* may be NULL */
    void *progress_user;
    const gtx_allocator *allocator;   /* for the new asset */
    gtx_limits limits;            /* of memory; the asset's maps count as bytes read */
    uint32_t reserved[6];
} gtx_lod_desc;

/* Copies `asset` and gives the copy LOD meshes that are simplified from the surface of its maps, in
 * place of any that it had; free it with gtx_close. Overlapping height fields are cut where both
 * are equally deep inside their outlines, and welded, so that neighbours share their border
 * vertices. The finest LOD mesh aims at a ninth of the asset's source_triangles (if that is 0, of
 * two triangles per texel); a mesh's `error` is its distance from the surface of the maps. The same
 * asset and options give the same bytes. `desc` may be NULL. Any thread.
 * Errors: CANCELLED, ARGUMENT, NOT_ZEROED, MEMORY, LIMIT (a patch lies more than 10^9 times its
 * size away from the anchor), INTERNAL. */
GTX_API gtx_result gtx_cook_lod_meshes(const gtx_asset *asset, const gtx_lod_desc *desc,
                                       gtx_asset **out, gtx_error *error);

/* ---- comparing ----------------------------------------------------------------------------- */

typedef struct gtx_compare_desc {
    uint32_t size;                /* pixels along a side of a view, up to 4096; 0 = 1024 */
    uint32_t levels;              /* number of levels of the height fields to measure, up to 8; 0 =
                                     the asset's mip_count */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    gtx_progress_fn progress;
    void *progress_user;
    uint32_t z_up;                /* as for the cook, like the next two */
    const char *const *more;
    uint32_t more_count;
    const gtx_allocator *allocator;
    gtx_limits limits;            /* as for the cook; the asset's bytes count as read too */
    uint32_t random_views;        /* in addition to the 26 fixed ones, up to 4096 */
    uint32_t seed;                /* of the random views */
    const char *texture_dir, *base_color; /* as for the cook */
    uint32_t any_model;           /* 1: do not refuse a model other than the asset's source, which
                                     is recognised by a hash of its content and its textures' */
    uint32_t figures_only;        /* 1: measure no more than gtx_compare_result holds; the report
                                     has level 0 alone, and no details */
    uint32_t local_metres;        /* 1: grids in degrees become metres, true at the latitude of
                                     the first one's middle (gtx_height_grid_to_metres) */
    uint32_t depths;              /* 1: values of grids are depths, positive downwards */
    uint32_t reserved[2];
} gtx_compare_desc;

/* Figures that a build may put limits on; format/measures.md defines each. */
typedef struct gtx_compare_result {
    uint64_t hole_pixels, wall_pixels, turned_pixels, surface_pixels;
    double silhouette_iou, silhouette_iou_min;
    double forward_rms;           /* distance from the source to the asset, and from the asset to
                                     the source, as fractions of the source's bounding-box
                                     diagonal */
    double reverse_max;
    /* Gaps between patches where they meet, in height steps of the coarser one. */
    double seam_p99_steps, seam_max_steps;
} gtx_compare_result;

/* Measures an asset against `model`, the mesh file that it was cooked from, or a height grid
 * (gtx_height_grid_read) as a surface of two triangles a cell. `desc`, `result`, `report`
 * (format/compare-report.schema.json) and `error` may be NULL. Any thread.
 * Errors: as gtx_cook_file and gtx_open_file; INPUT if the asset was cooked from another model. */
GTX_API gtx_result gtx_compare_files(const char *asset, const char *model,
                                     const gtx_compare_desc *desc, gtx_compare_result *result,
                                     gtx_report *report, gtx_error *error);

/* Frees what a report owns, and zeroes it. NULL and a zeroed report are fine. */
GTX_API void gtx_report_free(gtx_report *report);

#ifdef __cplusplus
}
#endif
#endif
