/* Materials and images of a world, in files beside its cell files: split writes them, cooking a
 * leaf reads them. */
#pragma once

#include "base/hash.h"
#include "world/surface.hpp"

namespace gtx {

/* Adds materials and images to a hash. */
void hash_appearance(gtx_hash &hash, const Appearance &look);

/* Files of a folder: `look` with the materials, `image-N` with an image each. */
class MaterialWriter {
public:
    explicit MaterialWriter(const std::string &folder) : folder_(folder) {}
    /* Appends. Materials refer to the images that came since the last materials. Throws Error:
     * WRITE. */
    void add(const Appearance &look);
    void finish();

private:
    const std::string folder_;
    Vector<uint32_t> words_;
    uint32_t images_ = 0, first_ = 0;
};

/* The materials of a world, the last of them for triangles without any, and the images that the
 * surface's triangles use, at the finest levels that together have at most 1/16 texel per byte of a
 * worker's memory. Throws Error: READ, INPUT, LIMIT. */
Appearance read_appearance(const Plan &plan, const TileSurface &surface, Task &task);

/* The surface as the cooker takes it, with its textures. */
Mesh textured_mesh(const Plan &plan, const TileSurface &surface, Task &task);
/* What is seen of the mesh becomes the surface's vertex colours, and the mean colour of each
 * triangle its `seen`. */
void paint_surface(const Mesh &mesh, TileSurface &surface, Task &task);

} // namespace gtx
