/* A glTF scene taken apart: its meshes one by one, and the scene with some of them replaced by
 * assets (format/GTX_geometry_texture.md). */
#pragma once

#include "mesh/mesh.hpp"

#include <memory>

namespace gtx {

struct SceneMesh {
    std::string name;              /* as the document has it; may be empty */
    uint64_t triangles = 0;        /* as its accessors say */
    size_t nodes = 0;              /* that show it */
    std::string unsuitable;        /* why no asset can stand for it; empty: one may */
};

/* An asset in the place of a mesh. */
struct ScenePlacement {
    size_t mesh;
    std::string uri;               /* relative to the document */
    double anchor[3];
};

class GltfScene {
public:
    /* Reads the buffers, and the images that lie in files of their own.
     * Throws Error: INPUT, UNSUPPORTED (also: no glTF), READ, LIMIT, MEMORY. */
    GltfScene(const ModelFile &file, Task &task);
    ~GltfScene();

    const Vector<SceneMesh> &meshes() const { return meshes_; }
    /* Paths of the files that were read besides the document. */
    const Vector<std::string> &sources() const { return sources_; }

    /* A GLB of one mesh in its own space, with what it needs and no more. */
    Bytes single(size_t mesh, Task &task) const;
    /* A GLB of the scene. Nodes keep their numbers, names and places; one that showed a replaced
     * mesh shows the asset, through a child at the asset's anchor. What only the replaced meshes
     * needed is left out, unless the document uses an extension that may refer to it. */
    Bytes placed(const Vector<ScenePlacement> &placements, Task &task) const;

private:
    struct Inside;
    std::unique_ptr<Inside> inside_;
    Vector<SceneMesh> meshes_;
    Vector<std::string> sources_;
};

} // namespace gtx
