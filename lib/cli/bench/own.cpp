/* The runs of `gtx bench` with an engine's own fragment main, which shades like the stock one. */
#include "cli/bench/scene.hpp"

namespace gtx {

static const char own_main[] =
    "#pragma geotex tiles\n"
    "#pragma geotex vertices\n"
    "uniform vec4 own_light;\n" /* towards it, and the share without it */
    "vec3 shown(vec3 albedo, vec3 n, vec3 eye, float deviation)\n"
    "{\n"
    "    float light = gtx_diffuse(n, eye, own_light.xyz, deviation);\n"
    "    return gtx_to_srgb(albedo * (own_light.w + (1.0 - own_light.w) * light));\n"
    "}\n"
    "#ifdef GTX_OWN_VERTICES\n"
    "vec4 gtx_at_vertex(vec3 point, vec3 normal, vec3 eye, vec4 albedo, float deviation)\n"
    "{\n"
    "    return vec4(shown(albedo.rgb, normal, eye, deviation), 1.0);\n"
    "}\n"
    "#else\n"
    "layout(location = 0) out vec4 color;\n"
    "void main()\n"
    "{\n"
    "    gtx_surface s;\n"
    "    if (!gtx_find(s))\n"
    "        discard;\n"
    "    color = vec4(shown(gtx_albedo(s).rgb, gtx_world_normal(s), -gtx_world_ray(s),\n"
    "                       s.deviation), 1.0);\n"
    "    gtx_write_depth(s);\n"
    "}\n"
    "#endif\n";

void BenchScene::shade_own(gtx_view &view)
{
    gtx_error error;
    if (!own_)
        require_ok(gtx_shading_create(renderer_, own_main, &own_, &error), error);
    GLuint programs[GTX_SHADING_PROGRAMS];
    const uint32_t count = gtx_shading_programs(own_, programs);
    const GLfloat light[4] = {view.light_direction[0], view.light_direction[1],
                              view.light_direction[2], view.ambient};
    for (uint32_t i = 0; i < count; ++i) {
        gl.UseProgram(programs[i]);
        gl.Uniform4fv(gl.GetUniformLocation(programs[i], "own_light"), 1, light);
    }
    view.shading = own_;
    view.flags |= GTX_VIEW_SHADING_BY_TILES | GTX_VIEW_SHADING_SOLID;
}

} // namespace gtx
