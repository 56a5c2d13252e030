/* The triangle mesh that flows through the cooker, and how to get one. */
#pragma once

#include "mesh/material/appearance.hpp"
#include "mesh/task.hpp"
#include "mesh/vec.hpp"

#include "base/file.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>

namespace gtx {

enum TriangleFlag : uint8_t {
    TRIANGLE_TWO_SIDED = 1 /* of an open component, or declared double-sided by its material */
};

/* Attributes belong to corners: corner 3 * t + k is vertex triangles[t][k] as triangle t sees it.
 * As imported, positions may repeat, and anything may be wrong. As cleaned: positions are finite,
 * welded and all used; every edge has one or two triangles, consistently wound; every vertex has
 * one fan of triangles; no triangle is degenerate or there twice; every corner has a unit normal;
 * flags say which triangles are two-sided. */
struct Mesh {
    Vector<Vec3d> positions;
    Vector<std::array<uint32_t, 3>> triangles;
    Vector<Vec3f> normals;      /* per corner, or empty */
    Vector<Rgba8> colors;       /* per corner, or empty */
    Vector<uint8_t> flags;      /* per triangle, TriangleFlag, or empty */
    Appearance appearance;      /* materials and textures, where the source has them */

    size_t triangle_count() const { return triangles.size(); }
    const Vec3d &position(size_t t, int k) const { return positions[triangles[t][k]]; }
    /* Twice the area times the unit normal. */
    Vec3d area_vector(size_t t) const
    {
        return cross(position(t, 1) - position(t, 0), position(t, 2) - position(t, 0));
    }
};

/* What cleaning took away, by reason ("duplicate", "degenerate", "non-finite", ...). */
struct CleanReport {
    std::map<std::string, uint64_t> dropped; /* triangles */
    uint64_t nonmanifold_edges = 0;          /* edges with more than two triangles, split */
    uint64_t flipped = 0;                    /* triangles whose winding was turned */
    uint64_t components = 0, boundary_edges = 0;
    bool closed = false;                     /* no boundary edge at all */
};

/* Where a model's textures may be besides its own folder. */
struct TextureFiles {
    std::string folder;     /* looked in by file name for those that are not beside it; or empty */
    std::string base_color; /* the image for materials without one; or empty */
};

/* A model in memory. `path` names the format where the bytes do not, and is what the files that the
 * model refers to are relative to. */
struct ModelFile {
    std::string path;
    Bytes bytes;      /* inflated when they were gzipped */
    Vector<std::string> *sources;      /* gets the path of every further file read; may be null */
    TextureFiles textures = {};
};

/* Throw Error: READ, INPUT, LIMIT, MEMORY, CANCELLED. */
ModelFile read_model(const std::string &path, Task &task);
/* Any other file, perhaps gzipped too; `look` sees the first bytes of what is packed, and `user` is
 * the path, a std::string. */
ModelFile read_packed_file(const std::string &path, Task &task, gtx_file_look look);
ModelFile model_in_memory(std::string_view bytes, const std::string &path, Task &task);

/* What a path says of the format: its extension in lower case, ".gz" left out. */
std::string model_extension(const std::string &path);
/* Whether that is a format of models. */
bool is_model_name(const std::string &path);

/* Paths of the files that a model refers to, whether they exist or not: buffers, images, material
 * libraries. Found without decoding the model; nothing is said of one that is malformed. */
Vector<std::string> referenced_files(const ModelFile &file, Task &task);

/* Reads a model by its content (falling back to its extension): OBJ, PLY, OFF, STL, Draco, glTF and
 * GLB. Node transforms are applied. What is ignored is named in task.warnings.
 * Throws Error: READ, INPUT, UNSUPPORTED, EMPTY (no triangle), LIMIT, MEMORY, CANCELLED. */
Mesh import_model(const ModelFile &file, Task &task);

/* The same of a file. `sources`, when given, gets the path of every file that was read (the model
 * first). */
Mesh import_mesh(const std::string &path, Task &task, Vector<std::string> *sources = nullptr);

/* Welds, repairs and orients; the result keeps the promises above. Parts of a `closed` surface have
 * no border. Throws Error: EMPTY, CANCELLED. */
Mesh clean_mesh(Mesh mesh, Task &task, CleanReport &report, bool closed = false);

/* Three neighbours a triangle: neighbour[t][k] shares the edge from corner k to corner k + 1 the
 * other way round, or is NO_TRIANGLE: at a border, and where several triangles do. */
constexpr uint32_t NO_TRIANGLE = 0xffffffffu;
Vector<std::array<uint32_t, 3>> triangle_neighbours(
    size_t vertices, const Vector<std::array<uint32_t, 3>> &triangles);
inline Vector<std::array<uint32_t, 3>> triangle_neighbours(const Mesh &mesh)
{
    return triangle_neighbours(mesh.positions.size(), mesh.triangles);
}

} // namespace gtx
