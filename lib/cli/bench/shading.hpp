/* How `gtx bench` shades the mesh. */
#pragma once

#include "host/polygons.h"

namespace gtx {

/* A program that lights polygons as gtx_draw lights an asset, by the same functions: by metallic
 * and roughness where the asset has `materials`, else by Lambert. Throws Error: SHADER. */
gtx_polygon_program make_bench_program(const gtx_host_gl &gl, bool materials);

/* Tells it where the eye is, for a view without scale. */
void set_bench_eye(const gtx_host_gl &gl, const gtx_polygon_program &program, const float view[16]);

} // namespace gtx
