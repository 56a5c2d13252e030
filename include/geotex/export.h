/* Assets as glTF files for other tools, and back. Links libgeotex-cook.
 *
 * The file is a GLB: an LOD mesh with smooth normals, tangents and one set of texture coordinates,
 * textured with the asset's pages: normals in tangent space and, if the asset has them, colours,
 * occlusion-roughness-metallic and emission. The asset itself is embedded too, byte for byte, as
 * the extension GTX_geometry_texture (format/GTX_geometry_texture.md): readers that know the
 * extension can cast rays, all others draw the mesh. */
#ifndef GEOTEX_EXPORT_H
#define GEOTEX_EXPORT_H

#include <geotex/cook.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum gtx_export_compression {
    GTX_EXPORT_UNCOMPRESSED = 0,
    GTX_EXPORT_MESHOPT = 1,       /* requires EXT_meshopt_compression and KHR_mesh_quantization of
                                     readers; normals, tangents and texture coordinates have 16
                                     bits, positions are exact */
    GTX_EXPORT_DRACO = 2          /* the smallest; requires KHR_draco_mesh_compression. Positions
                                     stay on the grid of the LOD mesh, normals and tangents have 12
                                     bits, texture coordinates a resolution of 1/16 texel */
} gtx_export_compression;

typedef enum gtx_export_textures {
    GTX_EXPORT_PNG = 0,
    GTX_EXPORT_KTX2 = 1           /* requires KHR_texture_basisu: UASTC, which stays compressed on
                                     the GPU at one byte per texel, with all mip levels */
} gtx_export_textures;

typedef struct gtx_export_desc {
    uint32_t level;               /* the LOD mesh to export; 0 = the finest */
    uint32_t lods;                /* 1: all coarser ones too, except far ones, as MSFT_lod; the
                                     normal map of each has half the width of the one before */
    double max_error;             /* > 0: instead of `level` (which must be 0), the coarsest LOD
                                     mesh within this distance of the source, as a fraction of the
                                     asset's bounding-box diagonal */
    uint32_t collision;           /* 1: for physics: positions and triangles only, with vertices
                                     shared across patches; no maps and no asset */
    uint32_t without_asset;       /* 1: do not embed the asset */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    gtx_progress_fn progress;     /* may be NULL */
    void *progress_user;
    const gtx_allocator *allocator;   /* for the file, the opened asset and the report */
    gtx_limits limits;            /* of memory, texels and patches; the asset's bytes count as
                                     read */
    gtx_export_compression compress;  /* of vertices and triangles */
    gtx_export_textures textures;
    uint32_t reserved[4];
} gtx_export_desc;

/* Exports an asset: the `size` bytes of a .gtx file, or of a GLB that embeds one. *out gets
 * *out_size bytes from the descriptor's allocator (malloc when there is none), and must be freed
 * with that allocator. The same bytes and options give the same file, whatever the thread count.
 * The file's unit is the metre. `desc`, `report` (format/export-report.schema.json; it has no
 * sources) and `error` may be NULL. Any thread.
 * Errors: CANCELLED, ARGUMENT (also: no such level, or a far one), NOT_ZEROED, MEMORY, LIMIT (also:
 * no LOD mesh is within max_error; the file would exceed 4 GiB), EMPTY (the asset has no LOD mesh),
 * UNSUPPORTED (PNG needs the image module), and those of gtx_open_memory. */
GTX_API gtx_result gtx_export_memory(const void *data, size_t size, const gtx_export_desc *desc,
                                     void **out, size_t *out_size, gtx_report *report,
                                     gtx_error *error);

/* The same from file to file, written as gtx_save_file does. Errors: also READ and WRITE; ARGUMENT
 * if both are the same file. */
GTX_API gtx_result gtx_export_file(const char *input, const char *output,
                                   const gtx_export_desc *desc, gtx_report *report,
                                   gtx_error *error);

/* Cooks the meshes of a glTF scene one by one. Each mesh that is suited becomes an asset of its own
 * in `folder`, which is created if it does not exist. The scene itself is written there too, under
 * its own name, as a GLB that refers to the assets by GTX_geometry_texture where its nodes had the
 * meshes. Nodes keep their indices, names and transforms.
 *
 * Kept as meshes are those that give one of the warnings "few-triangles", "empty-texels",
 * "outline-loss" and "unseen-surface", those with skins, morph targets, points, lines or alpha
 * blending, and those that cannot be cooked; the report (format/scene-report.schema.json) says why.
 * Files are written atomically, the scene last. `more`, `charts_ply`, `z_up`, `unit`, `kept`,
 * `closed`, `strict` and `if_changed` of the descriptor must be 0. `desc`, `report` and `error` may
 * be NULL. Any thread. Errors: as gtx_cook_file. */
GTX_API gtx_result gtx_cook_scene(const char *input, const char *folder, const gtx_cook_desc *desc,
                                  gtx_report *report, gtx_error *error);

/* Finds the bytes of the asset that a GLB embeds: *asset points into `data`. Given a .gtx file,
 * finds the whole of it. The asset itself is not checked; gtx_open_memory does that. Any thread.
 * Errors: ARGUMENT, INPUT, LIMIT, MEMORY, EMPTY (the GLB embeds none), NOT_GTX (the bytes are
 * neither GLB nor .gtx), UNSUPPORTED (it embeds several). */
GTX_API gtx_result gtx_find_asset(const void *data, size_t size, const void **asset,
                                  size_t *asset_size, gtx_error *error);

/* gtx_open_file for a .gtx file or for a GLB that embeds an asset. Errors: as gtx_find_asset and
 * gtx_open_file. */
GTX_API gtx_result gtx_open_exported(const char *path, const gtx_open_desc *desc, gtx_asset **out,
                                     gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
