/* Materials and images of a world beside its cell files, which split makes and cooks of leaves
 * read. */
#pragma once

#include "base/hash.h"
#include "world/surface.hpp"

namespace gtx {

/* All that is seen of it. */
void add_look(gtx_hash &hash, const Appearance &look);

/* Files of a folder: `look` with the materials, `image-N` with an image each. */
class LookWriter {
public:
    explicit LookWriter(const std::string &folder) : folder_(folder) {}
    /* Materials and images go on counting: materials name images that came since the last ones.
     * Throws Error: WRITE. */
    void add(const Appearance &look);
    void finish();

private:
    const std::string folder_;
    Vector<uint32_t> words_;
    uint32_t images_ = 0, first_ = 0;
};

/* The materials of a world, the last of them that of triangles without any, and those of the images
 * that the surface's triangles look at: as fine as 1/16 texel for each byte of a worker's memory
 * allows. Throws Error: READ, INPUT, LIMIT. */
Appearance read_look(const Plan &plan, const TileSurface &surface, Task &task);

/* The surface as the cooker takes it, with its textures. */
Mesh textured_mesh(const Plan &plan, const TileSurface &surface, Task &task);
/* What is seen of the mesh becomes the surface's vertex colours, and the mean colour of each
 * triangle its `seen`. */
void paint_surface(const Mesh &mesh, TileSurface &surface, Task &task);

} // namespace gtx
