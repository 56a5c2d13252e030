/* The shaders of meshes in pictures, put together from those of the library. */
#include "cli/view/mesh_program.hpp"

#include "host/program.h"

#include <geotex/render.h>

#include <string>

namespace gtx {

constexpr GLuint EMISSION = 4; /* after the attributes of gtx_polygon_vertex */

static const char vertex_text[] = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;
layout(location = 3) in vec4 surface;
layout(location = 4) in vec4 emission;
uniform mat4 model, view_projection;
out vec3 world_point, world_normal;
out vec4 srgb, material, glow;
void main()
{
    world_normal = transpose(inverse(mat3(model))) * normal;
    srgb = color;
    material = surface;
    glow = emission;
    vec4 point = model * vec4(position, 1.0);
    world_point = point.xyz;
    gl_Position = view_projection * point;
}
)";

static const char fragment_main[] = R"(
in vec3 world_point, world_normal;
in vec4 srgb, material, glow;
uniform vec3 light;
uniform float ambient;
uniform vec4 eye; /* w: has materials */
layout(location = 0) out vec4 color;
vec3 to_linear(vec3 c)
{
    return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));
}
void main()
{
    vec3 n = normalize(gl_FrontFacing || material.w < 0.5 ? world_normal : -world_normal);
    vec3 base = to_linear(srgb.rgb);
    float share = srgb.a > 0.0 ? ambient + (1.0 - ambient) * max(dot(n, light), 0.0) : 1.0;
    vec3 shaded = base * share;
    if (eye.w > 0.0)
        shaded = gtx_shade(gtx_material(base, to_linear(glow.rgb), material.x, material.y,
                                        material.z, srgb.a),
                           n, normalize(eye.xyz - world_point), light, ambient);
    color = vec4(gtx_to_srgb(shaded), 1.0);
}
)";

gtx_polygon_program make_mesh_program(const gtx_host_gl &gl)
{
    std::string text;
    for (const char *file :
         {"geotex_dialect.glsl", "geotex_records.glsl", "geotex_height_field.glsl",
          "geotex_view.glsl", "geotex_surface.glsl", "geotex_material.glsl"})
        text += gtx_shader_source(file);
    text += fragment_main;
    gtx_polygon_program out;
    gtx_error error;
    require_ok(gtx_host_program_create(&gl, vertex_text, text.c_str(), &out.program, &error),
               error);
    out.model = gl.GetUniformLocation(out.program, "model");
    out.view_projection = gl.GetUniformLocation(out.program, "view_projection");
    out.light = gl.GetUniformLocation(out.program, "light");
    out.ambient = gl.GetUniformLocation(out.program, "ambient");
    return out;
}

void set_mesh_shading(const gtx_host_gl &gl, const gtx_polygon_program &program, bool materials,
                      const float view[16])
{
    float eye[4] = {0, 0, 0, float(materials)};
    for (int k = 0; k < 3; ++k)
        for (int r = 0; r < 3; ++r)
            eye[k] -= view[4 * k + r] * view[12 + r];
    gl.UseProgram(program.program);
    gtx_set_vector(&gl, program.program, "eye", eye);
}

GLuint add_emissions(const gtx_host_gl &gl, const gtx_polygons &polygons,
                     const Vector<std::array<uint8_t, 4>> &emissions)
{
    GLuint buffer = 0;
    if (emissions.empty())
        return 0;
    gl.GenBuffers(1, &buffer);
    gl.BindVertexArray(polygons.vertex_array);
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(emissions.size() * 4), emissions.data(),
                  GL_STATIC_DRAW);
    gl.VertexAttribPointer(EMISSION, 4, GL_UNSIGNED_BYTE, GL_TRUE, 4, nullptr);
    gl.EnableVertexAttribArray(EMISSION);
    gl.BindVertexArray(0);
    gl.BindBuffer(GL_ARRAY_BUFFER, 0);
    if (gl.GetError() == GL_OUT_OF_MEMORY)
        throw Error(GTX_ERROR_GL, "out of GPU memory for what a mesh emits");
    return buffer;
}

} // namespace gtx
