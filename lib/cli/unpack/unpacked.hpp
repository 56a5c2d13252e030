/* An asset as a folder of images, a file an LOD mesh, and one JSON file: what unpack
 * writes and pack reads. */
#pragma once

#include "mesh/task.hpp"

#include <geotex/geotex.h>

#include <array>
#include <string>

namespace gtx {

/* How a map lies in images: one a page and level. */
struct UnpackedMap {
    gtx_map map;
    const char *name;
    uint32_t texel_size;         /* bytes in the asset; heights of 16 bits have twice as many */
    uint32_t channels;           /* of the image */
    bool has_levels;
};
constexpr UnpackedMap UNPACKED_MAPS[] = {{GTX_MAP_HEIGHT, "height", 1, 1, false},
                                         {GTX_MAP_TRIM, "trim", 1, 1, false},
                                         {GTX_MAP_NORMAL, "normal", 2, 3, true},
                                         {GTX_MAP_COLOR, "color", 4, 4, true},
                                         {GTX_MAP_MATERIAL, "material", 4, 4, true},
                                         {GTX_MAP_EMISSION, "emission", 3, 3, true}};

constexpr const char *UNPACKED_JSON = "asset.json";
constexpr char UNPACKED_FORMAT[] = "geotex unpacked asset 1";

/* "height-0.png" for page 0, "normal-0-2.png" for level 2 of page 0. */
std::string unpacked_name(const UnpackedMap &map, uint32_t page, uint32_t level);
std::string in_folder(const std::string &folder, const std::string &name);
/* What lies in a folder, in any order; nothing where there is none. The iterators of the standard
 * library end the program where there is no memory. */
Vector<std::string> names_in(const std::string &folder);
/* Removes a folder of files. Takes no memory but what the system does. */
void remove_folder(const std::string &folder) noexcept;

/* In all of these `about` names the file at hand when an Error is thrown. */

/* Writes the images and the JSON into an existing folder. `zstd` is the level whose encoding gives
 * the asset's file again, 0 = stored, or -1 when none does. */
void write_unpacked(const gtx_asset *asset, int zstd, const std::string &folder,
                    std::string &about);

/* The arrays of an LOD mesh. */
struct UnpackedLod {
    Vector<uint32_t> numbers;      /* first, then indices */
    Vector<uint16_t> positions;
    Vector<uint8_t> normals;       /* 2 a vertex, or none */
};
std::string unpacked_lod_name(uint32_t level); /* "lod-0.bin" */
void write_unpacked_lod(const gtx_lod_mesh &level, uint32_t patches, const std::string &path);
/* Fills in the arrays; the other fields of `level` are there. */
void read_unpacked_lod(const std::string &path, uint32_t patches, gtx_lod_mesh &level,
                       UnpackedLod &out);

/* The content of a folder, owned. */
struct Unpacked {
    gtx_asset_desc desc = {};    /* its pointers lead into what follows */
    int zstd = 0;
    Vector<gtx_patch> patches;
    Vector<std::array<uint64_t, 12>> hashes;     /* of the patches' maps when they were unpacked, or
                                                    none: see rebuild.hpp */
    std::string meta;
    Vector<Vector<uint8_t>> levels[6];           /* by UNPACKED_MAPS: pages one after another */
    Vector<const uint8_t *> pointers[6];
    Vector<gtx_lod_mesh> lod;
    Vector<UnpackedLod> lod_arrays;
    bool has_old_normals = false;                /* LOD meshes' are of maps edited since */
    Vector<Warning> warnings;
};

/* Fills `out`, which must stay where it is. */
void read_unpacked(const std::string &folder, Limits &limits, Unpacked &out, std::string &about);

/* Leaves out the normals of LOD meshes. False where there are none. */
bool drop_lod_normals(Unpacked &unpacked);
/* Makes them anew of the maps; all of it makes a valid asset. */
void fit_lod_normals(Unpacked &unpacked);

/* Computes coverage, spheres and bounds anew from the heights, and leaves out the LOD mesh, which
 * does not follow them. */
void derive_again(Unpacked &unpacked);

} // namespace gtx
