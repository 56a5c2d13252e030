/* Programs: shader files put together in order, compiled and linked. */
#include "render/renderer.h"

#include "base/alloc.h"
#include "base/error.h"
#include "render/shaders.h"

#include <string.h>

enum { MAX_PARTS = 12, MAX_LOG = 2048 };

/* Of OpenGL and of OpenGL ES; plain and with materials. */
static const char *const heads[2][2] = {
    {"#version 330 core\n", "#version 330 core\n#define GTX_MATERIALS\n"},
    {"#version 300 es\n", "#version 300 es\n#define GTX_MATERIALS\n"}};

static const char cast[] = "geotex_cast.glsl", paper[] = "geotex_paper.glsl";
static const char forward[] = "geotex_forward.frag", depth[] = "geotex_depth.frag";
static const char id[] = "geotex_id.frag", gbuffer[] = "geotex_gbuffer.frag";

/* How a stock program finds the surface, and what it does there. */
static const struct stock {
    const char *method, *main;
    bool materials;
    const char *label;
} stock[PROGRAM_COUNT] = {
    [PROGRAM_CAST] = {cast, forward, false, "geotex cast"},
    [PROGRAM_CAST_MATERIAL] = {cast, forward, true, "geotex cast, materials"},
    [PROGRAM_CAST_DEPTH] = {cast, depth, false, "geotex cast, depth"},
    [PROGRAM_CAST_ID] = {cast, id, false, "geotex cast, ids"},
    [PROGRAM_CAST_GBUFFER] = {cast, gbuffer, true, "geotex cast, g-buffer"},
    [PROGRAM_PAPER] = {paper, forward, false, "geotex paper"},
    [PROGRAM_PAPER_MATERIAL] = {paper, forward, true, "geotex paper, materials"},
    [PROGRAM_PAPER_DEPTH] = {paper, depth, false, "geotex paper, depth"},
    [PROGRAM_PAPER_ID] = {paper, id, false, "geotex paper, ids"},
    [PROGRAM_PAPER_GBUFFER] = {paper, gbuffer, true, "geotex paper, g-buffer"},
};

const char *gtx_shader_source(const char *name)
{
    for (const gtx_shader_file *file = gtx_shader_files; name && file->name; ++file)
        if (strcmp(file->name, name) == 0)
            return file->text;
    return NULL;
}

/* The texts of a shader, in order. */
typedef struct source {
    const char *texts[MAX_PARTS];
    gl_size count;
} source;

static void add(source *s, const char *text)
{
    s->texts[s->count++] = text;
}

static source vertex_source(bool es)
{
    source s = {.count = 0};
    add(&s, heads[es][0]);
    add(&s, gtx_shader_source("geotex_dialect.glsl"));
    add(&s, gtx_shader_source("geotex_sheet.glsl"));
    add(&s, gtx_shader_source("geotex_view.glsl"));
    add(&s, gtx_shader_source("geotex_proxy.vert"));
    return s;
}

static source fragment_source(bool es, const char *method, bool materials, const char *main)
{
    source s = {.count = 0};
    add(&s, heads[es][materials]);
    add(&s, gtx_shader_source("geotex_dialect.glsl"));
    add(&s, gtx_shader_source("geotex_sheet.glsl"));
    add(&s, gtx_shader_source("geotex_view.glsl"));
    add(&s, gtx_shader_source("geotex_surface.glsl"));
    if (materials)
        add(&s, gtx_shader_source("geotex_material.glsl"));
    add(&s, gtx_shader_source(method));
    add(&s, gtx_shader_source("geotex_fragment.glsl"));
    add(&s, main);
    return s;
}

/* A compiled shader, or 0. */
static gl_uint compile(const gtx_renderer *renderer, gl_enum stage, const source *s)
{
    const gtx_gl *gl = &renderer->gl;
    const gl_uint shader = gl->CreateShader(stage);
    gl_int compiled = GL_FALSE;
    gl->ShaderSource(shader, s->count, s->texts, NULL);
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

static gtx_result build(const gtx_renderer *renderer, const source *s, const char *label,
                        gtx_program *out, gtx_error *error)
{
    const gtx_gl *gl = &renderer->gl;
    const gl_uint fragment = compile(renderer, GL_FRAGMENT_SHADER, s);
    out->object = fragment ? link_stages(renderer, renderer->vertex_shader, fragment) : 0;
    if (fragment)
        gl->DeleteShader(fragment);
    if (!out->object)
        return gtx_fail(error, GTX_ERROR_SHADER, "a shader did not compile; the log says why");
    gtx_gl_label(gl, GL_PROGRAM, out->object, label);
    locate(gl, out);
    return GTX_OK;
}

gtx_result gtx_program_need(gtx_renderer *renderer, int program, gtx_error *error)
{
    gtx_program *out = &renderer->programs[program];
    const struct stock *s = &stock[program];
    if (out->object)
        return GTX_OK;
    const source text = fragment_source(renderer->gl.es, s->method, s->materials,
                                        gtx_shader_source(s->main));
    return build(renderer, &text, s->label, out, error);
}

gtx_result gtx_programs_create(gtx_renderer *renderer, gtx_error *error)
{
    static const int first[] = {PROGRAM_CAST, PROGRAM_CAST_MATERIAL, PROGRAM_PAPER,
                                PROGRAM_PAPER_MATERIAL};
    const source text = vertex_source(renderer->gl.es);
    renderer->vertex_shader = compile(renderer, GL_VERTEX_SHADER, &text);
    if (!renderer->vertex_shader)
        return gtx_fail(error, GTX_ERROR_SHADER, "a shader did not compile; the log says why");
    gtx_result result = GTX_OK;
    for (size_t i = 0; i < sizeof first / sizeof *first && !result; ++i)
        result = gtx_program_need(renderer, first[i], error);
    return result;
}

void gtx_programs_destroy(gtx_renderer *renderer)
{
    for (int i = 0; i < PROGRAM_COUNT; ++i)
        if (renderer->programs[i].object)
            renderer->gl.DeleteProgram(renderer->programs[i].object);
    if (renderer->vertex_shader)
        renderer->gl.DeleteShader(renderer->vertex_shader);
}

gtx_result gtx_shading_create(gtx_renderer *renderer, const char *text, gtx_shading **out,
                              gtx_error *error)
{
    if (!renderer || !text || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a shading needs a renderer and a main");
    *out = NULL;
    gtx_shading *shading = gtx_alloc_array(&renderer->allocator, 1, sizeof *shading);
    if (!shading)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a shading");
    const source s = fragment_source(renderer->gl.es, cast, true, text);
    gtx_result result = build(renderer, &s, "geotex cast, own main", &shading->program, error);
    if (result)
        gtx_free_array(&renderer->allocator, shading, 1, sizeof *shading);
    else
        *out = shading;
    return result;
}

void gtx_shading_destroy(gtx_renderer *renderer, gtx_shading *shading)
{
    if (!shading)
        return;
    renderer->gl.DeleteProgram(shading->program.object);
    gtx_free_array(&renderer->allocator, shading, 1, sizeof *shading);
}

uint32_t gtx_shading_program(const gtx_shading *shading)
{
    return shading->program.object;
}
