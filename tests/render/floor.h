/* A floor whose shadows are rays in shaders, for the tests of them. */
#ifndef GTX_TESTS_FLOOR_H
#define GTX_TESTS_FLOOR_H

#include "host/program.h"
#include "stage.h"

/* A program of the engine's own: a floor that the sun does not reach everywhere. */
static inline GLuint make_floor(stage *s)
{
    static const char floor_main[] =
        "in vec2 at;\n"
        "layout(location = 0) out vec4 color;\n"
        "void main() {\n"
        "    vec3 point = vec3(at * 6.0 - 3.0, -1.5);\n"
        "    color = vec4(vec3(gtx_sunlight(point, vec3(0.0, 0.0, 1.0), vec3(0.6, 0.0, 0.8),\n"
        "                                   0.0, 1, 0.0)), 1.0);\n"
        "}\n";
    static char text[32768];
    gtx_error error = {0};
    GLuint program;
    snprintf(text, sizeof text, "%s%s%s%s%s", gtx_shader_source("geotex_dialect.glsl"),
             gtx_shader_source("geotex_records.glsl"),
             gtx_shader_source("geotex_height_field.glsl"), gtx_shader_source("geotex_rays.glsl"),
             floor_main);
    must(gtx_host_program_create(&s->gl, gtx_screen_vertex, text, &program, &error), &error);
    return program;
}

/* Into s->color. */
static inline void draw_floor(stage *s, const gtx_rays *rays, GLuint program)
{
    gtx_rays_bind(s->renderer, rays, program);
    gtx_framebuffer_bind(&s->gl, &s->framebuffer);
    s->gl.Disable(GL_DEPTH_TEST);
    s->gl.UseProgram(program);
    gtx_screen_draw(&s->gl);
    assert_int_equal(s->gl.GetError(), GL_NO_ERROR);
    gtx_framebuffer_read_color(&s->gl, &s->framebuffer, s->color);
}

#endif
