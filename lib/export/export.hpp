/* An asset -> glTF that any reader shows: an LOD mesh, the pages as its textures, and the asset
 * itself beside them (format/GTX_geometry_texture.md). */
#pragma once

#include "mesh/task.hpp"
#include "mesh/vec.hpp"

#include <array>
#include <string_view>

namespace gtx {

struct ExportOptions {
    uint32_t level = 0;            /* of the LOD mesh, 0 the finest */
    bool lods = false;             /* and all coarser ones but far ones, as MSFT_lod */
    bool collision = false;        /* triangles alone, no map and no asset */
    bool with_asset = true;
    bool meshopt = false;          /* EXT_meshopt_compression, with normals, tangents and texture
                                      coordinates of 16 bits; or: */
    bool draco = false;            /* KHR_draco_mesh_compression, with positions as the LOD mesh has
                                      them, and the rest of 12 to 16 bits */
    bool ktx2 = false;             /* KHR_texture_basisu in place of PNG */
};

struct ExportedLevel {
    uint32_t level;
    size_t triangles, vertices;
    double error;                  /* object units */
};

struct Exported {
    Bytes file;
    Vector<ExportedLevel> levels;
    size_t images = 0;
};

/* `bytes` are those that the asset was opened from. The same asset and options give the same bytes.
 * Throws Error: LIMIT, MEMORY, CANCELLED, UNSUPPORTED (the image module is not there). */
Exported export_glb(const gtx_asset *asset, std::string_view bytes, const ExportOptions &options,
                    Task &task);

/* ---- inside of the room ---- */

/* What a vertex has in the file: 12 floats. */
struct ExportVertex {
    Vec3f position, normal;        /* relative to the anchor; of the LOD mesh, smooth */
    Vec3f tangent;                 /* along the rows of the page */
    float texel[2];                /* place in the page, texel i covers i to i + 1 */
};
constexpr size_t EXPORT_VERTEX = 12 * sizeof(float);
constexpr size_t EXPORT_SHORT_VERTEX = 3 * sizeof(float) + 10 * sizeof(uint16_t); /* quantised */
/* The bitangent is this times cross(normal, tangent): up in the page, as glTF has it. */
constexpr float BITANGENT_SIGN = -1;

/* Vertices and triangles of one patch. */
struct ExportPart {
    uint32_t patch;
    uint32_t first_vertex, vertices, first_triangle, triangles;
};

/* Parts lie one after another, those of one page and one kind of sides together. */
struct ExportMesh {
    gtx_lod_mesh from;
    Vector<ExportVertex> vertices;
    Vector<std::array<uint32_t, 3>> triangles;
    Vector<ExportPart> parts;
};

/* Where its maps are looked up with texels 2^coarser wide, all of them are the patch's own. */
ExportMesh export_mesh(const gtx_asset *asset, const gtx_lod_mesh &lod, unsigned coarser,
                       Task &task);

/* For every texel of a patch's rectangle, of level `level`, the one there whose values stand for
 * it: itself, or the nearest that has some. Empty where none has. */
Vector<uint32_t> nearest_texels(const gtx_asset *asset, uint32_t patch, unsigned level);
/* The same of any rectangle: `valued` is 1 where there are values. */
Vector<uint32_t> nearest_of(const Vector<uint8_t> &valued, uint32_t width, uint32_t height);

/* Pages of three bytes a texel. */
struct PageImages {
    uint32_t width = 0, height = 0, pages = 0;
    Vector<uint8_t> texels;
    bool constant = false;         /* all that is seen is `first` */
    std::array<uint8_t, 3> first = {};

    PageImages() = default;
    PageImages(const gtx_info &info, unsigned level, std::array<uint8_t, 3> fill);
    uint8_t *texel(uint32_t page, uint32_t x, uint32_t y)
    {
        return &texels[3 * ((size_t(page) * height + y) * width + x)];
    }
};

/* Tangent-space normals for the frames of the mesh: what it shows with them is the asset's normal
 * map, of mip level `level`. */
PageImages tangent_normals(const gtx_asset *asset, const ExportMesh &mesh, unsigned level,
                           Task &task);

/* The other maps, without empty texels. No pages where the asset has no such map. */
struct SurfaceImages {
    PageImages color, material, emission; /* material: occlusion, roughness, metallic */
    bool unlit = false, partly_unlit = false;
};
SurfaceImages surface_images(const gtx_asset *asset, Task &task);

} // namespace gtx
