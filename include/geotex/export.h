/* Assets as glTF, which any tool shows, and back. Links libgeotex-cook.
 *
 * The file is a GLB: an LOD mesh with smooth normals, tangents and one set of texture coordinates,
 * and the asset's pages as its textures: normals in tangent space, and where the asset has them
 * colours, metallic-roughness with occlusion, emission. The asset itself lies in it too, byte by
 * byte, as the extension GTX_geometry_texture (format/GTX_geometry_texture.md): readers that know
 * it cast rays, all others draw the mesh. */
#ifndef GEOTEX_EXPORT_H
#define GEOTEX_EXPORT_H

#include <geotex/cook.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum gtx_compress {
    GTX_COMPRESS_NONE = 0,
    GTX_COMPRESS_MESHOPT = 1,     /* EXT_meshopt_compression, which readers have to know, with
                                     normals, tangents and texture coordinates of 16 bits
                                     (KHR_mesh_quantization); positions stay as they are */
    GTX_COMPRESS_DRACO = 2        /* KHR_draco_mesh_compression, likewise required: the smallest;
                                     positions stay on the grid of the LOD mesh, normals and
                                     tangents have 12 bits, texture coordinates 1/16 texel */
} gtx_compress;

typedef enum gtx_textures {
    GTX_TEXTURES_PNG = 0,
    GTX_TEXTURES_KTX2 = 1         /* KHR_texture_basisu, which readers have to know: UASTC, which a
                                     GPU keeps in a byte a texel, with all mip levels */
} gtx_textures;

typedef struct gtx_export_desc {
    uint32_t level;               /* of the LOD mesh: 0 = the finest */
    uint32_t lods;                /* 1: all coarser ones too, as MSFT_lod, but far ones; the normals
                                     of each next one have half the texels a side */
    double max_error;             /* > 0: the coarsest LOD mesh that is at most so far from the
                                     source, as a fraction of the asset's diagonal; `level` is then
                                     0 */
    uint32_t collision;           /* 1: for physics: positions and triangles alone, vertices shared
                                     across patches, no maps and no asset */
    uint32_t without_asset;       /* 1: the mesh and its maps alone */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    gtx_progress_fn progress;     /* may be NULL */
    void *progress_user;
    const gtx_allocator *allocator;   /* for the bytes, the asset meanwhile, and the report */
    gtx_limits limits;            /* memory, texels, patches; the asset's bytes count as read */
    gtx_compress compress;        /* of vertices and triangles */
    gtx_textures textures;
    uint32_t reserved[4];
} gtx_export_desc;

/* Exports the asset of `size` bytes, those of a .gtx file or of a GLB that holds one. *out comes
 * from the descriptor's allocator (malloc when none), and is freed with it, as *out_size bytes. The
 * same bytes and options give the same file, whatever the thread count. The file's unit is the
 * metre. `desc`, `report` (format/export-report.schema.json; it has no sources) and `error` may be
 * NULL. Any thread.
 * Errors: CANCELLED, ARGUMENT (there is no such level, or it is a far one), NOT_ZEROED, MEMORY,
 * LIMIT (also: no LOD mesh is as near as `max_error`; more than 4 GiB), EMPTY (the asset has no LOD
 * mesh), UNSUPPORTED (PNG needs the image module), and those of gtx_open_memory. */
GTX_API gtx_result gtx_export_memory(const void *data, size_t size, const gtx_export_desc *desc,
                                     void **out, size_t *out_size, gtx_report *report,
                                     gtx_error *error);

/* The same from file to file, written as gtx_save_file does. Errors: also READ, WRITE; ARGUMENT if
 * both are one file. */
GTX_API gtx_result gtx_export_file(const char *input, const char *output,
                                   const gtx_export_desc *desc, gtx_report *report,
                                   gtx_error *error);

/* Cooks the meshes of a glTF scene one by one: each that suits geometry textures becomes an asset
 * of its own in `folder`, which is made where it is not there; and the scene there, under its own
 * name as a GLB, places the assets by GTX_geometry_texture where its nodes showed the meshes. Nodes
 * keep their numbers, names and places. Meshes stay as they are that the warnings "few-triangles",
 * "empty-texels", "outline-loss" and "unseen-surface" tell of, those with skins, morph targets,
 * points, lines or blending, and those that cannot be cooked; the report
 * (format/scene-report.schema.json) says why. Files are written whole, the scene last. `more`,
 * `charts_ply`, `z_up`, `unit`, `kept`, `closed`, `strict` and `if_changed` of the descriptor must
 * be 0. `desc`, `report` and `error` may be NULL. Any thread. Errors: as gtx_cook_file. */
GTX_API gtx_result gtx_cook_scene(const char *input, const char *folder, const gtx_cook_desc *desc,
                                  gtx_report *report, gtx_error *error);

/* Finds the asset in the bytes of a GLB: *asset points into `data`. A .gtx file is its own asset.
 * Whether it is a sound one gtx_open_memory says. Any thread.
 * Errors: ARGUMENT, INPUT, LIMIT, MEMORY, EMPTY (the GLB holds none), NOT_GTX (the bytes are
 * neither), UNSUPPORTED (it holds several). */
GTX_API gtx_result gtx_find_asset(const void *data, size_t size, const void **asset,
                                  size_t *asset_size, gtx_error *error);

/* gtx_open_file, for a .gtx file and for a GLB that holds an asset. Errors: of both. */
GTX_API gtx_result gtx_open_exported(const char *path, const gtx_open_desc *desc, gtx_asset **out,
                                     gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
