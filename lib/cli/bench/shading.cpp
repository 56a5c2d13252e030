/* Puts the comparison mesh's fragment shader together from those of the library, so that neither
 * side shades more than the other. */
#include "cli/bench/shading.hpp"

#include "cli/view/scene_renderer.hpp"
#include "host/program.h"

#include <geotex/render.h>

#include <string>

namespace gtx {

/* sRGB -> linear by a polynomial, within half a byte but near black: maps come decoded, and powers
 * would be the mesh's to pay alone. */
static const char inputs[] = R"(
in vec3 world_point, world_normal;
in vec4 srgb, material;
uniform vec3 light;
uniform float ambient;
layout(location = 0) out vec4 color;
vec3 to_linear(vec3 c)
{
    return c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878);
}
)";

static const char lambert[] = R"(
void main()
{
    vec3 n = gl_FrontFacing ? world_normal : -world_normal;
    float toward = max(dot(normalize(n), light), 0.0);
    float share = srgb.a > 0.0 ? ambient + (1.0 - ambient) * toward : 1.0;
    color = vec4(gtx_to_srgb(to_linear(srgb.rgb) * share), 1.0);
}
)";

static const char metallic_roughness[] = R"(
uniform vec4 eye;
void main()
{
    gtx_material m = gtx_material(to_linear(srgb.rgb), vec3(0.0), material.x, material.y,
                                  material.z, srgb.a);
    vec3 n = normalize(gl_FrontFacing ? world_normal : -world_normal);
    color = vec4(gtx_to_srgb(gtx_shade(m, n, normalize(eye.xyz - world_point), light, ambient)),
                 1.0);
}
)";

gtx_polygon_program make_bench_program(const gtx_host_gl &gl, bool materials)
{
    std::string text;
    for (const char *file :
         {"geotex_dialect.glsl", "geotex_records.glsl", "geotex_height_field.glsl",
          "geotex_view.glsl", "geotex_surface.glsl", "geotex_material.glsl"})
        text += gtx_shader_source(file);
    text += inputs;
    text += materials ? metallic_roughness : lambert;
    gtx_polygon_program program;
    gtx_error error;
    require_ok(gtx_polygon_program_create_with(&gl, text.c_str(), &program, &error), error);
    return program;
}

void set_bench_eye(const gtx_host_gl &gl, const gtx_polygon_program &program, const float view[16])
{
    float eye[4] = {0, 0, 0, 1};
    for (int k = 0; k < 3; ++k)
        for (int r = 0; r < 3; ++r)
            eye[k] -= view[4 * k + r] * view[12 + r];
    gl.UseProgram(program.program);
    gtx_set_vector(&gl, program.program, "eye", eye);
}

} // namespace gtx
