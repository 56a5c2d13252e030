/* Cooking: triangle meshes and height grids -> `.gtx` assets. Links libgeotex-cook (C++17 inside).
 *
 * The line is the paper's (section 5): import, clean, partition, overlap, frame, bake, dilate,
 * pack, LOD mesh, measure. The same input and options give the same bytes, whatever the thread
 * count.
 *
 * Memory. The descriptors' `allocator` (NULL = malloc) gives everything that outlives a call, the
 * asset and the report, and what libgeotex takes on the way: opening, encoding, casting, writing
 * JSON. It is called from the calling thread alone. The containers of C++ that hold models, charts
 * and maps while they are made, and the decoders (OpenMesh, Draco, tinygltf, meshoptimizer, zlib,
 * OpenImageIO) take the process's own heap; where that runs out, the result is MEMORY too, but an
 * image that finds none is ignored with a warning. */
#ifndef GEOTEX_COOK_H
#define GEOTEX_COOK_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum gtx_partition {
    GTX_PARTITION_DEFAULT = 0,    /* cuts */
    GTX_PARTITION_CUTS = 1,       /* few large charts that fold nowhere, cut straight */
    GTX_PARTITION_VSA = 2,        /* variational shape approximation (paper, section 5.2) */
    GTX_PARTITION_PGP = 3         /* periodic global parameterization: squares along the principal
                                     directions of curvature (paper, section 5.1) */
} gtx_partition;

/* How the maps are extracted from the patches' triangles. GPU is the paper's way (section 5): each
 * patch is rendered along its frame's z, vertex colours unlit, normals renormalised; textures are
 * looked up, and what lies beyond a patch's border is continued, as by the CPU. On Mesa's llvmpipe
 * both agree within a code on 99.9 % of the texels that both cover. The bytes that the GPU gives
 * depend on its driver, which the report names; one of OpenGL 3.3 is asked for through EGL, without
 * a window. A context that the calling thread has current through EGL is so again afterwards. */
typedef enum gtx_extract {
    GTX_EXTRACT_DEFAULT = 0,      /* cpu */
    GTX_EXTRACT_CPU = 1,
    GTX_EXTRACT_GPU = 2
} gtx_extract;

typedef struct gtx_cook_desc {
    gtx_partition partition;
    gtx_extract extract;
    uint32_t charts;              /* wanted number of patches, up to 2^20; 0 = round(10 T^0.28) for
                                     T triangles */
    uint32_t resolution;          /* most texels along a patch side, 64..512; 0 = 128. The density
                                     goes with it: patches have 1,400 texels of surface at 128 in
                                     the mean (cuts), or the longest has this side (vsa,
                                     pgp) */
    uint32_t height_bits;         /* 8 or 16; 0 = 8 */
    uint32_t dilation;            /* texels of dilated normal and colour, up to 128; 0 =
                                     2^(mips - 1) */
    uint32_t mips;                /* levels of normal and colour, 1..8; 0 = 4 */
    int32_t zstd_level;           /* 1..19; 0 = 3 (stored, in a build without zstd); -1 = stored */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    float unit;                   /* metres per object unit; 0 = 1 */
    uint32_t z_up;                /* 1: the models' +Z becomes +Y, and their +Y -Z */
    double error;                 /* greatest RMS distance from the source to the asset, as a
                                     fraction of the source's bounding diagonal; 0 = none. The
                                     density, and bits and charts where they are 0, become what
                                     takes the fewest bytes. LIMIT where no density reaches it. For
                                     the partition cuts. */
    uint32_t measure;             /* 1: measure the error (report, `error`) */
    gtx_progress_fn progress;     /* may be NULL */
    void *progress_user;
    uint32_t lod_levels;          /* polygon levels of detail, at most 5; up to 3 more
                                     follow for models of a few pixels */
    const char *charts_ply;       /* path for the partition before splitting as a PLY, a colour a
                                     chart, inverted triangles green; or NULL */
    const char *const *more;      /* paths of further models that are cooked into the same asset */
    uint32_t more_count;
    uint32_t strict;              /* 1: a warning is an error (INPUT), and nothing is written */
    uint32_t if_changed;          /* 1: gtx_cook_file leaves an output alone that is a valid asset
                                     of the same key (below), and so its time of change */
    const gtx_allocator *allocator;   /* needed during the call; its hooks until all is freed */
    uint32_t adaptive;            /* 1: smaller squares where the surface is more curved, from half
                                     the length to twice; for the partition pgp */
    uint32_t reserved[7];
} gtx_cook_desc;

/* An asset keeps the key that it was cooked under. The key covers
 *   - the content of every file behind the models: themselves, and the buffers, material libraries
 *     and images that they refer to, one that is missing included; not their paths or times;
 *   - the options that change what comes out: partition, extract (and the driver, where it is GPU),
 *     charts, resolution, height_bits, dilation, mips, lod_levels, zstd_level, unit, error, z_up
 *     and adaptive; not threads, measure, progress, strict or allocator;
 *   - geotex's version and the revision of its cooker,
 * but not the library that decodes images. Where `strict` is asked for, an asset that was cooked
 * with warnings is cooked again; where `charts_ply` is, or importing read what could not be
 * foreseen, any is. */

/* What a call did, as JSON; freed with gtx_report_free. Written only on success. All that it points
 * to lies in one block of the call's allocator, whose hooks it keeps. */
typedef struct gtx_report {
    char *json;                   /* terminated */
    size_t size;
    char summary[160];            /* one line: patches, texels, bytes, seconds */
    uint32_t unchanged;           /* 1: if_changed, and the output was left alone */
    char **sources;               /* paths of the files behind the models, the first model first */
    size_t source_count;
    char **warnings;              /* one sentence each */
    size_t warning_count;
    gtx_allocator allocator;      /* gave `block`, and takes it back */
    void *block;
    size_t block_size;
} gtx_report;

/* Reads the model at `input` (glTF, GLB, Draco, OBJ, PLY, OFF, STL, each also gzipped), cooks it
 * and writes the asset to `output`: whole, through a temporary name and a rename, or not at all.
 * `desc`, `report` (format/cook-report.schema.json) and `error` may be NULL. Errors: CANCELLED,
 * ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, READ, WRITE, INPUT, EMPTY, UNSUPPORTED, INTERNAL; GL and
 * SHADER where the GPU is to extract and no driver can. Any thread. */
GTX_API gtx_result gtx_cook_file(const char *input, const char *output, const gtx_cook_desc *desc,
                                 gtx_report *report, gtx_error *error);

/* The same of the `size` bytes of a model file, into memory: gtx_close frees the asset, which is of
 * the descriptor's allocator, and gtx_encode makes a file of it. `name` is a path that need not
 * exist: its extension says what the bytes are where they do not, and files that the model refers
 * to are looked for beside it. */
GTX_API gtx_result gtx_cook_memory(const void *data, size_t size, const char *name,
                                   const gtx_cook_desc *desc, gtx_asset **out, gtx_report *report,
                                   gtx_error *error);

/* An LOD mesh for an asset that has no source mesh: one whose maps were edited or filtered, or that
 * was made of height grids. */
typedef struct gtx_lod_desc {
    uint32_t levels;              /* at most, 1..5; 0 = 5; and those for models of a few pixels */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    gtx_progress_fn progress;     /* may be NULL */
    void *progress_user;
    const gtx_allocator *allocator;   /* of the asset that comes out */
    uint32_t reserved[6];
} gtx_lod_desc;

/* Makes a copy of `asset` whose LOD mesh is simplified from what its maps show, in place of any
 * that it had; gtx_close frees it. Height fields that overlap are cut where each is as deep inside
 * its outline as the other and welded along that line, so that neighbours share their border
 * vertices. The finest level aims at a ninth of the asset's source_triangles (of two triangles a
 * texel where that is 0); an `error` is a distance from the maps' own surface. The same asset and
 * options give the same bytes. `desc` may be NULL. Any thread.
 * Errors: CANCELLED, ARGUMENT, NOT_ZEROED, MEMORY, INTERNAL. */
GTX_API gtx_result gtx_cook_lod_meshes(const gtx_asset *asset, const gtx_lod_desc *desc,
                                       gtx_asset **out, gtx_error *error);

/* ---- height grids ------------------------------------------------------------------------- */

/* Values at the nodes of a lattice: a horizon, or terrain. Node (i, j) lies at
 *   origin + R(rotation) (i * spacing[0], j * spacing[1])
 * seen from above: x to the east, y to the north. */
typedef struct gtx_height_grid {
    uint32_t nx, ny;              /* nodes along x and y */
    const float *values;          /* nx * ny, row by row from the origin; NaN where there is none */
    const float *property;        /* likewise, what to colour by; NULL: by the values */
    double origin[2], spacing[2]; /* object units; spacing > 0 */
    double rotation;              /* degrees, counter-clockwise */
    gtx_allocator allocator;      /* gave `values`, where gtx_height_grid_read did */
    uint32_t reserved[4];
} gtx_height_grid;

typedef struct gtx_height_grid_desc {
    double missing;               /* with has_missing: this value says that there is none */
    uint32_t has_missing;
    uint32_t reserved[5];
    double range[2];              /* what the least and the greatest code of an image stand for, the
                                     missing one left out; both 0: codes are the values */
    const gtx_allocator *allocator;
} gtx_height_grid_desc;

/* Reads a grid: IRAP classic and binary (".irap", ".gri"), ZMAP+ text, each also gzipped, which say
 * where they lie; or any image of 8 or 16 bits or of floats, whose top row is the northernmost,
 * with origin 0 and spacing 1, for the caller to change. A format's own way to say that there is
 * no value is known (9999900, 1e30; -32767 and below in 16 bits with a sign). The values are of the
 * descriptor's allocator, and freed by gtx_height_grid_free. `desc` may be NULL.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT (2^28 nodes), READ, INPUT, UNSUPPORTED. */
GTX_API gtx_result gtx_height_grid_read(const char *path, const gtx_height_grid_desc *desc,
                                        gtx_height_grid *out, gtx_error *error);
/* Frees the values of a grid that was read, and zeroes it. NULL and zeros are fine. */
GTX_API void gtx_height_grid_free(gtx_height_grid *grid);

typedef enum gtx_colors {
    GTX_COLORS_VIRIDIS = 0,
    GTX_COLORS_RAINBOW = 1,       /* blue, cyan, green, yellow, red */
    GTX_COLORS_NONE = 2           /* an asset without colour; not for gtx_color */
} gtx_colors;

/* The sRGB colour of a value of 0..1, clamped, as the maps have it: for a legend. */
GTX_API void gtx_color(gtx_colors colors, double value, uint8_t rgb[3]);

typedef struct gtx_horizons_desc {
    gtx_colors colors;
    uint32_t depths;              /* 1: values count downwards */
    double vertical;              /* exaggeration, > 0; 0 = 1 */
    double color_range[2];        /* values at the ends of the colours; both 0 = the least and the
                                     greatest that there are */
    uint32_t one_surface;         /* 1: the grids are parts of one lattice, such as neighbouring
                                     tiles of terrain, and become one surface without a seam */
    uint32_t tile;                /* most texels along a patch, 16..512; 0 = 128 */
    uint32_t height_bits;         /* 8 or 16; 0 = 8 */
    uint32_t mips;                /* 1..8; 0 = 4 */
    uint32_t lod_levels;          /* polygon levels of detail, 0..5, made of the maps */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    float unit;                   /* metres per object unit; 0 = 1 */
    gtx_progress_fn progress;     /* may be NULL */
    void *progress_user;
    const gtx_allocator *allocator;   /* of the asset */
    uint32_t reserved[6];
} gtx_horizons_desc;

typedef struct gtx_horizons_result {
    uint64_t nodes, triangles;    /* nodes with a value; two triangles where four make a square */
    uint32_t patches;
    double height_rms, height_max;    /* how far heights are from the values, object units */
    double color_range[2];        /* values at the ends of the colours */
} gtx_horizons_result;

/* Makes one asset of grids, tile by tile, without a mesh between (paper, section 6.2). East is +X,
 * up +Y, north -Z; the asset's anchor is in the middle of the grids. Every tile has a step of
 * heights of its own, and neighbours the same heights where they meet, so that no border shows.
 * Nodes without a value are empty texels; both sides are seen. Grids have the same numbers of
 * nodes, unless they are parts of one surface. Where a property is NaN the surface is grey. The
 * same grids and options give the same bytes. `desc`, `result` and `error` may be NULL; gtx_close
 * frees the asset.
 * Errors: CANCELLED, ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, INPUT, EMPTY (a grid without four
 * neighbouring values). Any thread. */
GTX_API gtx_result gtx_horizons(const gtx_height_grid *grids, uint32_t count,
                                const gtx_horizons_desc *desc, gtx_asset **out,
                                gtx_horizons_result *result, gtx_error *error);

/* The measures of an asset against its source model, as JSON
 * (format/compare-report.schema.json). */
typedef struct gtx_compare_desc {
    uint32_t size;                /* pixels along a side of the 26 views, up to 4096; 0 = 1024 */
    uint32_t levels;              /* levels of detail to evaluate, up to 8; 0 = the mip count */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    gtx_progress_fn progress;
    void *progress_user;
    uint32_t z_up;                /* as it was cooked; likewise the next two */
    const char *const *more;
    uint32_t more_count;
    const gtx_allocator *allocator;
    uint32_t reserved[8];
} gtx_compare_desc;

/* The figures a build may put a limit on. */
typedef struct gtx_compare_result {
    uint64_t hole_pixels, surface_pixels;
    double silhouette_iou, silhouette_iou_min;
    double forward_rms;           /* fraction of the source's bounding diagonal */
    /* How far apart patches are where they meet, in height steps of the coarser one. */
    double seam_p99_steps, seam_max_steps;
} gtx_compare_result;

/* `model` is the mesh file the asset was cooked from. `report` and `error` may be NULL.
 * Errors: as gtx_cook_file, and those of gtx_open_file. */
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
