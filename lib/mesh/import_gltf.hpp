/* A glTF document whose numbers are known to lie inside their buffers. Internal to lib/mesh. */
#pragma once

#include "mesh/import.hpp"

/* libdraco exports a tinygltf of its own, and a program may have another: ours has its own name. */
#define tinygltf gtx_tinygltf
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <fstream> /* which tinygltf forgets once it is told to stay off the file system */
#include <tiny_gltf.h>

namespace gtx {

struct GltfDocument {
    tinygltf::Model model;            /* without buffers, images and animations */
    std::vector<std::string> buffers; /* the bytes of each */
    /* Most triangles that may come out. A few bytes of JSON can ask for a mesh a million times, so
     * the limit grows with the size of the file; real scenes stay far below it. */
    uint64_t triangle_limit = 0;
};

/* Reads the container, the JSON and the buffers. Throws Error: INPUT, UNSUPPORTED, READ, LIMIT. */
GltfDocument read_gltf_document(const ModelFile &file, Task &task);

/* The bytes of a buffer view, checked. `user` names who asks, as in "accessor 3". */
std::string_view gltf_view(const GltfDocument &doc, int view, const std::string &user);

/* An accessor's values, sparse substitution and normalisation done. */
struct GltfValues {
    int components = 0;
    size_t count = 0;
    std::vector<double> values;
};
GltfValues gltf_values(const GltfDocument &doc, int accessor);

/* An index accessor's values, each below `vertices`. */
std::vector<uint32_t> gltf_indices(const GltfDocument &doc, int accessor, size_t vertices);

/* What stands for 1 in a component of that type; 1 unless the integers are normalised. */
double gltf_full_value(int component_type, bool normalized);

} // namespace gtx
