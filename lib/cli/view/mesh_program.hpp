/* How meshes are lit in pictures: by their materials, where they have some. */
#pragma once

#include "cli/view/polygons.hpp"

namespace gtx {

/* A program for gtx_polygons_draw that lights polygons as gtx_draw lights an asset, by the same
 * functions: by metallic and roughness, with what they emit, or by Lambert. Throws Error:
 * SHADER. */
gtx_polygon_program make_mesh_program(const gtx_host_gl &gl);

/* For what is drawn next: whether it has materials, and where the eye is, of a view without
 * scale. */
void set_mesh_shading(const gtx_host_gl &gl, const gtx_polygon_program &program, bool materials,
                      const float view[16]);

/* Gives uploaded polygons what they emit, from a buffer that the caller deletes; 0 where nothing
 * does. Throws Error: GL. */
GLuint add_emissions(const gtx_host_gl &gl, const gtx_polygons &polygons,
                     const Vector<std::array<uint8_t, 4>> &emissions);

} // namespace gtx
