/* The runs of `gtx bench` with an engine's own fragment main, which shades like the stock one. */
#include "cli/bench/scene.hpp"

namespace gtx {

static const char own_main[] =
    "#pragma geotex tiles\n"
    "layout(location = 0) out vec4 color;\n"
    "uniform vec4 own_light;\n" /* towards it, and the share without it */
    "void main()\n"
    "{\n"
    "    gtx_surface s;\n"
    "    if (!gtx_find(s))\n"
    "        discard;\n"
    "    vec3 n = gtx_world_normal(s), albedo = gtx_albedo(s).rgb;\n"
    "    float light = gtx_diffuse(n, -gtx_world_ray(s), own_light.xyz, s.deviation);\n"
    "    float share = own_light.w + (1.0 - own_light.w) * light;\n"
    "    color = vec4(gtx_to_srgb(albedo * share), 1.0);\n"
    "    gtx_write_depth(s);\n"
    "}\n";

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
