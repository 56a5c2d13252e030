/* Programs: shader files put together in order, compiled and linked. */
#include "render/renderer.h"

#include "base/error.h"
#include "render/shaders.h"

#include <string.h>

enum { MAX_PARTS = 8, MAX_LOG = 2048 };

/* Of OpenGL and of OpenGL ES; plain and with materials. */
static const char *const heads[2][2] = {
    {"#version 330 core\n", "#version 330 core\n#define GTX_MATERIALS\n"},
    {"#version 300 es\n", "#version 300 es\n#define GTX_MATERIALS\n"}};

static const char *const vertex_parts[] = {"geotex_dialect.glsl", "geotex_sheet.glsl",
                                           "geotex_view.glsl", "geotex_proxy.vert", NULL};

static const char *const fragment_parts[PROGRAM_COUNT][MAX_PARTS] = {
    [PROGRAM_CAST] = {"geotex_dialect.glsl", "geotex_sheet.glsl", "geotex_view.glsl",
                      "geotex_surface.glsl", "geotex_cast.glsl", "geotex_forward.frag", NULL},
    [PROGRAM_CAST_MATERIAL] = {"geotex_dialect.glsl", "geotex_sheet.glsl", "geotex_view.glsl",
                               "geotex_surface.glsl", "geotex_material.glsl", "geotex_cast.glsl",
                               "geotex_forward.frag", NULL},
    [PROGRAM_PAPER] = {"geotex_dialect.glsl", "geotex_sheet.glsl", "geotex_view.glsl",
                       "geotex_surface.glsl", "geotex_paper.glsl", "geotex_forward.frag", NULL},
    [PROGRAM_PAPER_MATERIAL] = {"geotex_dialect.glsl", "geotex_sheet.glsl", "geotex_view.glsl",
                                "geotex_surface.glsl", "geotex_material.glsl",
                                "geotex_paper.glsl", "geotex_forward.frag", NULL},
};

const char *gtx_shader_source(const char *name)
{
    for (const gtx_shader_file *file = gtx_shader_files; name && file->name; ++file)
        if (strcmp(file->name, name) == 0)
            return file->text;
    return NULL;
}

/* A compiled shader, or 0. */
static gl_uint compile(const gtx_renderer *renderer, gl_enum stage, const char *head,
                       const char *const *parts)
{
    const gtx_gl *gl = &renderer->gl;
    const char *texts[MAX_PARTS + 1] = {head};
    gl_size count = 1;
    for (; parts[count - 1]; ++count)
        texts[count] = gtx_shader_source(parts[count - 1]);
    const gl_uint shader = gl->CreateShader(stage);
    gl_int compiled = GL_FALSE;
    gl->ShaderSource(shader, count, texts, NULL);
    gl->CompileShader(shader);
    gl->GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled)
        return shader;
    char log[MAX_LOG] = "";
    gl->GetShaderInfoLog(shader, sizeof log, NULL, log);
    if (renderer->log)
        renderer->log(log, renderer->log_user);
    gl->DeleteShader(shader);
    return 0;
}

/* A linked program, or 0. */
static gl_uint link_stages(const gtx_renderer *renderer, gl_uint vertex, gl_uint fragment)
{
    const gtx_gl *gl = &renderer->gl;
    const gl_uint program = gl->CreateProgram();
    gl_int linked = GL_FALSE;
    gl->AttachShader(program, vertex);
    gl->AttachShader(program, fragment);
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked)
        return program;
    char log[MAX_LOG] = "";
    gl->GetProgramInfoLog(program, sizeof log, NULL, log);
    if (renderer->log)
        renderer->log(log, renderer->log_user);
    gl->DeleteProgram(program);
    return 0;
}

static void locate(const gtx_gl *gl, gtx_program *program)
{
    static const char *const samplers[UNIT_COUNT] = {
        [UNIT_CELLS] = "gtx_cells",     [UNIT_TRIM] = "gtx_trim",
        [UNIT_NORMALS] = "gtx_normals", [UNIT_COLORS] = "gtx_colors",
        [UNIT_PATCHES] = "gtx_patches", [UNIT_MATERIALS] = "gtx_materials",
        [UNIT_EMISSIONS] = "gtx_emissions",
    };
    program->clip_from_world = gl->GetUniformLocation(program->object, "gtx_clip_from_world");
    program->depth = gl->GetUniformLocation(program->object, "gtx_depth");
    program->light = gl->GetUniformLocation(program->object, "gtx_light");
    program->detail = gl->GetUniformLocation(program->object, "gtx_detail");
    program->maps = gl->GetUniformLocation(program->object, "gtx_maps");
    gl->UseProgram(program->object);
    for (gl_int i = 0; i < UNIT_COUNT; ++i)
        gl->Uniform1i(gl->GetUniformLocation(program->object, samplers[i]), i);
    gl->UseProgram(0);
}

gtx_result gtx_programs_create(gtx_renderer *renderer, gtx_error *error)
{
    static const char *const labels[PROGRAM_COUNT] = {
        [PROGRAM_CAST] = "geotex cast",
        [PROGRAM_CAST_MATERIAL] = "geotex cast, materials",
        [PROGRAM_PAPER] = "geotex paper",
        [PROGRAM_PAPER_MATERIAL] = "geotex paper, materials"};
    const gtx_gl *gl = &renderer->gl;
    bool failed = false;
    const gl_uint vertex = compile(renderer, GL_VERTEX_SHADER, heads[gl->es][0], vertex_parts);
    for (int i = 0; i < PROGRAM_COUNT && vertex && !failed; ++i) {
        const bool shades = i == PROGRAM_CAST_MATERIAL || i == PROGRAM_PAPER_MATERIAL;
        const gl_uint fragment =
            compile(renderer, GL_FRAGMENT_SHADER, heads[gl->es][shades], fragment_parts[i]);
        renderer->programs[i].object = fragment ? link_stages(renderer, vertex, fragment) : 0;
        failed = !renderer->programs[i].object;
        if (!failed)
            gtx_gl_label(gl, GL_PROGRAM, renderer->programs[i].object, labels[i]);
        if (fragment)
            gl->DeleteShader(fragment);
        if (!failed)
            locate(gl, &renderer->programs[i]);
    }
    if (vertex)
        gl->DeleteShader(vertex);
    if (!vertex || failed)
        return gtx_fail(error, GTX_ERROR_SHADER, "a shader did not compile; the log says why");
    return GTX_OK;
}

void gtx_programs_destroy(gtx_renderer *renderer)
{
    for (int i = 0; i < PROGRAM_COUNT; ++i)
        if (renderer->programs[i].object)
            renderer->gl.DeleteProgram(renderer->programs[i].object);
}
