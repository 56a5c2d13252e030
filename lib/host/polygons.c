/* A small lit polygon renderer. */
#include "host/polygons.h"

#include "base/error.h"
#include "host/camera.h"
#include "host/program.h"

#include <stddef.h>

static const char vertex_text[] =
    "layout(location = 0) in vec3 position;\n"
    "layout(location = 1) in vec3 normal;\n"
    "layout(location = 2) in vec4 color;\n"
    "layout(location = 3) in vec4 surface;\n"
    "uniform mat4 model, view_projection;\n"
    "out vec3 world_point, world_normal;\n"
    "out vec4 srgb, material;\n"
    "void main()\n"
    "{\n"
    "    world_normal = transpose(inverse(mat3(model))) * normal;\n"
    "    srgb = color;\n"
    "    material = surface;\n"
    "    vec4 point = model * vec4(position, 1.0);\n"
    "    world_point = point.xyz;\n"
    "    gl_Position = view_projection * point;\n"
    "}\n";

static const char fragment_text[] =
    "uniform vec3 light;\n"
    "uniform float ambient;\n"
    "in vec3 world_normal;\n"
    "in vec4 srgb;\n"
    "layout(location = 0) out vec4 color;\n"
    "vec3 to_linear(vec3 c)\n"
    "{\n"
    "    return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));\n"
    "}\n"
    "vec3 to_srgb(vec3 c)\n"
    "{\n"
    "    return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));\n"
    "}\n"
    "void main()\n"
    "{\n"
    "    float lambert = max(dot(normalize(world_normal), light), 0.0);\n"
    "    float share = srgb.a > 0.0 ? ambient + (1.0 - ambient) * lambert : 1.0;\n"
    "    color = vec4(to_srgb(to_linear(srgb.rgb) * share), 1.0);\n"
    "}\n";

gtx_result gtx_polygons_create(const gtx_host_gl *gl, const gtx_polygon_data *data,
                               gtx_polygons *out, gtx_error *error)
{
    const GLsizei stride = sizeof(gtx_polygon_vertex);
    gtx_polygons p = {.index_count = (GLsizei)data->index_count, .mode = GL_TRIANGLES};
    gl->GenVertexArrays(1, &p.vertex_array);
    gl->GenBuffers(1, &p.vertices);
    gl->GenBuffers(1, &p.indices);
    gl->BindVertexArray(p.vertex_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, p.vertices);
    gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)data->vertex_count * stride, data->vertices,
                   GL_STATIC_DRAW);
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, p.indices);
    gl->BufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)data->index_count * 4, data->indices,
                   GL_STATIC_DRAW);
    gl->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride,
                            (const void *)offsetof(gtx_polygon_vertex, position));
    gl->VertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, stride,
                            (const void *)offsetof(gtx_polygon_vertex, normal));
    gl->VertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
                            (const void *)offsetof(gtx_polygon_vertex, color));
    gl->VertexAttribPointer(3, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
                            (const void *)offsetof(gtx_polygon_vertex, material));
    for (GLuint i = 0; i < 4; ++i)
        gl->EnableVertexAttribArray(i);
    gl->BindVertexArray(0);
    gl->BindBuffer(GL_ARRAY_BUFFER, 0);
    if (gl->GetError() == GL_OUT_OF_MEMORY) {
        gtx_polygons_destroy(gl, &p);
        return gtx_fail(error, GTX_ERROR_GL, "out of GPU memory for %u triangles",
                        data->index_count / 3);
    }
    *out = p;
    return GTX_OK;
}

void gtx_polygons_destroy(const gtx_host_gl *gl, gtx_polygons *polygons)
{
    gl->DeleteVertexArrays(1, &polygons->vertex_array);
    gl->DeleteBuffers(1, &polygons->vertices);
    gl->DeleteBuffers(1, &polygons->indices);
    *polygons = (gtx_polygons){0};
}

gtx_result gtx_polygon_program_create(const gtx_host_gl *gl, gtx_polygon_program *out,
                                      gtx_error *error)
{
    return gtx_polygon_program_create_with(gl, fragment_text, out, error);
}

gtx_result gtx_polygon_program_create_with(const gtx_host_gl *gl, const char *fragment,
                                           gtx_polygon_program *out, gtx_error *error)
{
    GLuint program;
    gtx_result result = gtx_host_program_create(gl, vertex_text, fragment, &program, error);
    if (result)
        return result;
    out->program = program;
    out->model = gl->GetUniformLocation(program, "model");
    out->view_projection = gl->GetUniformLocation(program, "view_projection");
    out->light = gl->GetUniformLocation(program, "light");
    out->ambient = gl->GetUniformLocation(program, "ambient");
    return GTX_OK;
}

void gtx_polygon_program_destroy(const gtx_host_gl *gl, gtx_polygon_program *program)
{
    gl->DeleteProgram(program->program);
    *program = (gtx_polygon_program){0};
}

void gtx_polygons_draw(const gtx_host_gl *gl, const gtx_polygon_program *program,
                       const gtx_polygons *polygons, const float *model, const gtx_view *view)
{
    static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    float view_projection[16];
    gtx_matrix_multiply(view->projection, view->view, view_projection);
    gl->UseProgram(program->program);
    gl->UniformMatrix4fv(program->model, 1, GL_FALSE, model ? model : identity);
    gl->UniformMatrix4fv(program->view_projection, 1, GL_FALSE, view_projection);
    gl->Uniform3fv(program->light, 1, view->light_direction);
    gl->Uniform1f(program->ambient, view->ambient);
    gl->BindVertexArray(polygons->vertex_array);
    gl->DrawElements(polygons->mode, polygons->index_count, GL_UNSIGNED_INT, NULL);
    gl->BindVertexArray(0);
    gl->UseProgram(0);
}
