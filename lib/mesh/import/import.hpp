/* What the importers share: errors, numbers, polygons. Internal to lib/mesh. */
#pragma once

#include "mesh/mesh.hpp"

#include "base/error.h"
#include "base/file.h"

#include <new>
#include <stdexcept>
#include <string_view>

namespace gtx {

/* One importer a format. They promise valid vertex indices and nothing else: positions may be
 * anything, even NaN. */
Mesh import_obj(const ModelFile &file, Task &task);
Mesh import_ply(const ModelFile &file, Task &task);
Mesh import_draco(const ModelFile &file, Task &task);
Mesh import_gltf(const ModelFile &file, Task &task);
Mesh import_off(const ModelFile &file, Task &task);
Mesh import_stl(const ModelFile &file, Task &task);
/* Throws Error(EMPTY) for the first bytes of a binary STL file that counts no facet. */
void require_facets(std::string_view head);

/* Vertices and triangles are numbered in 32 bits, and the last number is taken. */
constexpr uint64_t MAX_VERTICES = 0xfffffffe;

/* Throws Error(LIMIT) for more triangles than are allowed, or than 32 bits can count. */
void require_triangles(uint64_t count, const Task &task);

/* Throws Error(result, the sentence). */
[[noreturn]] void fail(gtx_result result, const char *format, ...) GTX_PRINTF(2, 3);

/* Text out of a file, fit for a message: short and printable. */
std::string printable(std::string_view text, size_t longest = 40);

/* A decimal number in any locale, also inf and nan; what is too large is infinite. False, and `at`
 * stays, where there is none. */
bool parse_number(const char *&at, const char *end, double &value);

/* Throws Error: READ, LIMIT, MEMORY, and what `look` says of the first bytes; it calls the file
 * "the file", for a model may name any. */
Bytes read_whole_file(const std::string &path, Task &task, gtx_file_look look = nullptr,
                      void *user = nullptr);
/* The same of a file that a model names: a device or a pipe is READ. */
Bytes read_file_beside(const std::string &path, Task &task);

/* What runs out of memory, or of a container's longest length, says so. */
template <class Body> auto within_memory(Body body)
{
    try {
        return body();
    } catch (const std::bad_alloc &) {
        fail(GTX_ERROR_MEMORY, "not enough memory to read the model");
    } catch (const std::length_error &) {
        fail(GTX_ERROR_MEMORY, "not enough memory to read the model");
    }
}

/* Inflates the bytes of a file if they are gzipped; `look` then sees the first ones, with a
 * std::string, the path, as `user`. */
ModelFile unpacked_file(Bytes bytes, const std::string &path, Task &task, gtx_file_look look);

/* The path of a file that a model names: beside the model or in a folder below it. Empty where the
 * name leads anywhere else: a model from elsewhere must not make the cooker read other files. */
std::string path_beside(const ModelFile &file, const std::string &name);
/* Where the texture of a name may be, best first: beside the model, with the separators of any
 * system; where the name leads elsewhere, the file of that name in the model's own folder; then in
 * the folder of textures. */
Vector<std::string> texture_paths(const ModelFile &file, const std::string &name);
/* The first of them that is a file; else that beside the model, or empty. */
std::string texture_path(const ModelFile &file, const std::string &name);
/* The same whatever spelling names a file: without "." and doubled separators. */
std::string normal_path(const std::string &path);
std::string percent_decoded(std::string_view uri);

/* Append the paths of the files that a model refers to; "" for those it must not. */
void gltf_references(const ModelFile &file, Task &task, Vector<std::string> &paths);
void obj_references(const ModelFile &file, Task &task, Vector<std::string> &paths);

/* Cuts a polygon of n >= 3 corners into n - 2 triangles of corner numbers, wound alike. */
void triangulate(const Vector<Vec3d> &polygon, Vector<std::array<uint32_t, 3>> &out);

/* A mesh with its attributes by vertex, as most files have it; normals and colors may be empty. */
struct VertexMesh {
    Vector<Vec3d> positions;
    Vector<Vec3f> normals;
    Vector<Rgba8> colors;
    Vector<std::array<uint32_t, 3>> triangles;
};

/* The same with its attributes by corner. */
Mesh by_corner(VertexMesh &&mesh);

/* 0..1 to 0..255; NaN is 0. */
inline uint8_t to_byte(double v)
{
    return v > 0 ? uint8_t(v < 1 ? v * 255 + 0.5 : 255) : uint8_t(0);
}

} // namespace gtx
