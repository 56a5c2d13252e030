/* A lower bound for every method: the pixels that a picture covers, shaded once. */
#pragma once

#include "cli/bench/picture.hpp"
#include "host/polygons.h"

namespace gtx {

/* Draws flat rectangles over the covered pixels with the library's own fragment main of LOD meshes
 * from the front: one lookup of the normal, one of each other map that the asset has, from textures
 * of a texel a pixel. Nothing is transformed, searched or overdrawn. */
class Floor {
public:
    /* Throws Error: SHADER. */
    Floor(const gtx_host_gl &gl, const gtx_info &info);
    Floor(const Floor &) = delete;
    ~Floor();

    /* What draw covers from now on. Throws Error: GL. */
    void cover(const Picture &picture, uint32_t width, uint32_t height);
    void draw(const gtx_view &view);

private:
    struct Map {
        const char *sampler;
        GLuint texture;
    };
    void add_map(const char *sampler, GLint format, GLenum type, uint32_t channels);

    const gtx_host_gl &gl_;
    GLuint program_ = 0;
    gtx_polygons rectangles_ = {};
    Vector<Map> maps_;
    bool has_color_, has_material_;
};

} // namespace gtx
