/* A glTF document whose numbers are known to lie inside their buffers. Internal to lib/mesh. */
#pragma once

#include "mesh/import/gltf_material.hpp"

/* libdraco exports a tinygltf of its own, and a program may have another: ours has its own name. */
#define tinygltf gtx_tinygltf
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <map>
#include <memory>

#include <fstream> /* which tinygltf forgets once it is told to stay off the file system */
#include <tiny_gltf.h>

namespace gtx {

struct GltfDocument {
    tinygltf::Model model;            /* without buffers, materials and animations */
    /* As many bytes as it promises, of those that it may share with others. */
    struct Buffer {
        std::shared_ptr<const Bytes> bytes;
        size_t size = 0;

        std::string_view view() const { return std::string_view(*bytes).substr(0, size); }
    };
    Vector<Buffer> buffers;
    Vector<Bytes> views;              /* those of each buffer view that was packed, or none */
    GltfMaterials look;
    struct ImageSource {
        std::string uri;
        int view = -1;
    };
    Vector<ImageSource> images;
};

/* The buffers of a document. */
struct GlbChunks;
Vector<GltfDocument::Buffer> read_gltf_buffers(const nlohmann::json &root, const ModelFile &file,
                                               const GlbChunks &chunks, Task &task);
/* Reads the container, the JSON and the buffers. Throws Error: INPUT, UNSUPPORTED, READ, LIMIT. */
GltfDocument read_gltf_document(const ModelFile &file, Task &task);

/* The document of a JSON text alone, without its buffers. Throws Error: likewise. */
GltfDocument read_gltf_outline(std::string_view text, Task &task);

/* The bytes of a buffer view, checked. `user` names who asks, as in "accessor 3". */
std::string_view gltf_view(const GltfDocument &doc, int view, const std::string &user);

/* An accessor's values, sparse substitution and normalisation done. */
struct GltfValues {
    int components = 0;
    size_t count = 0;
    Vector<double> values;
};
GltfValues gltf_values(const GltfDocument &doc, int accessor);

/* An index accessor's values, each below `vertices`. */
Vector<uint32_t> gltf_indices(const GltfDocument &doc, int accessor, size_t vertices);

/* Unpacks the buffer views of EXT_meshopt_compression to doc.views. Throws Error: INPUT. */
void unpack_gltf_views(GltfDocument &doc, Task &task);

/* The materials in use, numbered as a mesh has them: in the order of their use, those that nothing
 * is said of as one. */
class GltfPalette {
public:
    GltfPalette(const GltfMaterials &from, Appearance &look) : from_(from), look_(look) {}
    /* Of a primitive of a material, -1 for none, which lacks the coordinates of bits of its sets:
     * it goes without the textures that look at them. */
    uint32_t number(int material, unsigned lacking, const std::string &where);
    std::set<Warning> warnings;

private:
    const GltfMaterials &from_;
    Appearance &look_;
    std::map<std::pair<int, unsigned>, uint32_t> numbers_; /* by material and lacking sets */
    std::set<std::pair<int, unsigned>> warned_;            /* of a set that primitives lack: once */
};

/* The image's bytes, or the problem. Throws Error: LIMIT. */
EncodedImage gltf_image(const GltfDocument &doc, const GltfImage &image, const ModelFile &file,
                        Task &task);

/* The bytes of a base64 data URI. Throws Error: INPUT. */
Bytes data_uri_bytes(const std::string &uri, const std::string &user);

/* ---- the scene ---- */

struct Affine {
    Vec3d column[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, offset;

    Vec3d direction(const Vec3d &v) const
    {
        return column[0] * v.x + column[1] * v.y + column[2] * v.z;
    }
    Vec3d point(const Vec3d &v) const { return direction(v) + offset; }
    double determinant() const { return dot(column[0], cross(column[1], column[2])); }
};

/* How positions move, and how normals and tangents turn. */
struct Turn {
    Affine transform, cofactor;
    bool mirrors;

    /* Normals turn with the inverse transpose; its multiple by the determinant's size exists even
     * where the transform flattens. */
    explicit Turn(const Affine &t) : transform(t), mirrors(t.determinant() < 0)
    {
        const Vec3d *c = t.column;
        const double sign = mirrors ? -1 : 1;
        cofactor.column[0] = cross(c[1], c[2]) * sign;
        cofactor.column[1] = cross(c[2], c[0]) * sign;
        cofactor.column[2] = cross(c[0], c[1]) * sign;
    }
    Vec3f normal(const Vec3f &n) const { return Vec3f(normalize(cofactor.direction(Vec3d(n)))); }
    std::array<float, 4> tangent(const std::array<float, 4> &t) const
    {
        const Vec3f v(normalize(transform.direction(Vec3d(t[0], t[1], t[2]))));
        return {v.x, v.y, v.z, mirrors ? -t[3] : t[3]};
    }
};

/* Where each mesh stands, in the order of the tree. */
Vector<Vector<Affine>> gltf_instances(const GltfDocument &doc);

/* ---- primitives ---- */

/* Attributes by vertex; those that it lacks, or that nobody looks at, are empty. */
struct GltfPrimitive {
    Vector<Vec3d> positions;
    Vector<std::array<uint32_t, 3>> triangles;
    Vector<Vec3f> normals;
    Vector<Rgba8> colors;
    Vector<std::array<float, 2>> uv[2];
    Vector<std::array<float, 4>> tangents;
};

/* Reads one of triangles. `material`, null without, says what it looks at. `where` is for
 * messages. */
GltfPrimitive read_gltf_primitive(const GltfDocument &doc, const tinygltf::Primitive &from,
                                  const GltfMaterial *material, const std::string &where,
                                  Task &task);

/* What stands for 1 in a component of that type; 1 unless the integers are normalised. */
double gltf_full_value(int component_type, bool normalized);

/* Bytes of a component; 0 of none that there is. */
unsigned gltf_component_size(int component_type);
/* The component at `p`, as a number: integers are not normalised. */
double gltf_component(const uint8_t *p, int component_type);

} // namespace gtx
