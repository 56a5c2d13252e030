/* Programs: the shaders of pipelines, compiled and linked. */
#include "render/program.h"

#include "base/alloc.h"
#include "base/error.h"
#include "frame/units.h"
#include "render/rays.h"
#include "render/renderer.h"

#include <string.h>

enum { MAX_LOG = 2048 };

/* A compiled shader, or 0. */
static gl_uint compile(const gtx_renderer *renderer, gl_enum stage, const char *const *texts,
                      uint32_t count)
{
    const gtx_gl *gl = &renderer->gl;
    const gl_uint shader = gl->CreateShader(stage);
    gl_int compiled = GL_FALSE;
    gl->ShaderSource(shader, (gl_size)count, texts, NULL);
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
static gl_uint link_stages(const gtx_renderer *renderer, const gl_uint *stages, int count)
{
    const gtx_gl *gl = &renderer->gl;
    const gl_uint program = gl->CreateProgram();
    gl_int linked = GL_FALSE;
    for (int i = 0; i < count; ++i)
        gl->AttachShader(program, stages[i]);
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

/* The members of gtx_constants, the matrix first. */
static const struct {
    const char *name;
    size_t offset;
} constants[GTX_CONSTANT_COUNT] = {
    {"gtx_clip_from_world", offsetof(gtx_constants, clip_from_world)},
    {"gtx_depth", offsetof(gtx_constants, depth)},
    {"gtx_light", offsetof(gtx_constants, light)},
    {"gtx_detail", offsetof(gtx_constants, detail)},
    {"gtx_search", offsetof(gtx_constants, search)},
    {"gtx_maps", offsetof(gtx_constants, maps)},
    {"gtx_lod_mesh", offsetof(gtx_constants, lod_mesh)},
    {"gtx_constant_material", offsetof(gtx_constants, constant_material)},
};

void gtx_program_set(const gtx_gl *gl, const gtx_program *program, const gtx_constants *now,
                     const gtx_constants *before)
{
    if (!before)
        gl->UniformMatrix4fv(program->constants[0], 1, GL_FALSE, now->clip_from_world);
    for (int i = 1; i < GTX_CONSTANT_COUNT; ++i) {
        const size_t at = constants[i].offset;
        const float *value = (const float *)((const char *)now + at);
        if (!before || memcmp(value, (const char *)before + at, 4 * sizeof *value))
            gl->Uniform4fv(program->constants[i], 1, value);
    }
}

static void locate(const gtx_gl *gl, gtx_program *program)
{
    static const char *const samplers[UNIT_COUNT] = {
        [UNIT_CELLS] = "gtx_cells",     [UNIT_TRIM] = "gtx_trim",
        [UNIT_NORMALS] = "gtx_normals", [UNIT_COLORS] = "gtx_colors",
        [UNIT_PATCHES] = "gtx_patches", [UNIT_MATERIALS] = "gtx_materials",
        [UNIT_EMISSIONS] = "gtx_emissions",
    };
    program->place = gl->GetUniformLocation(program->object, "gtx_place");
    program->tint = gl->GetUniformLocation(program->object, "gtx_tint");
    program->instance = gl->GetUniformLocation(program->object, "gtx_instance");
    for (int i = 0; i < GTX_CONSTANT_COUNT; ++i)
        program->constants[i] = gl->GetUniformLocation(program->object, constants[i].name);
    gl->UseProgram(program->object);
    for (gl_int i = 0; i < UNIT_COUNT; ++i)
        gl->Uniform1i(gl->GetUniformLocation(program->object, samplers[i]), i);
    gl->Uniform1i(gl->GetUniformLocation(program->object, "gtx_stream"), UNIT_STREAM);
    gtx_rays_locate(gl, program->object);
    gl->UseProgram(0);
}

/* A compiled stage of a pipeline, or 0. */
static gl_uint stage_of(const gtx_renderer *renderer, uint32_t pipeline, gtx_stage stage,
                        const char *own_main)
{
    const gl_enum kind = stage == GTX_STAGE_VERTEX ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER;
    const char *texts[1 + GTX_MAX_SHADER_TEXTS] = {renderer->gl.glsl};
    const uint32_t count = gtx_pipeline_source(pipeline, stage, own_main, texts + 1);
    return count ? compile(renderer, kind, texts, 1 + count) : 0;
}

static gtx_result build(const gtx_renderer *renderer, uint32_t pipeline, const char *own_main,
                        gtx_program *out, gtx_error *error)
{
    const gtx_gl *gl = &renderer->gl;
    const gl_uint vertex = stage_of(renderer, pipeline, GTX_STAGE_VERTEX, own_main);
    const gl_uint fragment =
        vertex ? stage_of(renderer, pipeline, GTX_STAGE_FRAGMENT, own_main) : 0;
    char label[GTX_MAX_LABEL];
    out->object = fragment ? link_stages(renderer, (gl_uint[2]){vertex, fragment}, 2) : 0;
    if (vertex)
        gl->DeleteShader(vertex);
    if (fragment)
        gl->DeleteShader(fragment);
    if (!out->object)
        return gtx_fail(error, GTX_ERROR_SHADER, "a shader did not compile; the log says why");
    gtx_pipeline_label(pipeline, label);
    gtx_gl_label(gl, GL_PROGRAM, out->object, label);
    locate(gl, out);
    return GTX_OK;
}

gtx_result gtx_programs_need(gtx_renderer *renderer, gtx_technique technique, gtx_pass pass,
                             gtx_error *error)
{
    gtx_result result = GTX_OK;
    for (int i = 0; i < MATERIAL_COUNT && !result; ++i) {
        const uint32_t pipeline = gtx_pipeline_of(technique, pass, (gtx_material_kind)i);
        if (!renderer->programs[pipeline].object)
            result = build(renderer, pipeline, NULL, &renderer->programs[pipeline], error);
    }
    return result;
}

bool gtx_is_displaced_otherwise(const gtx_renderer *renderer, gtx_technique technique)
{
    return renderer->planner.on_gpu ? gtx_technique_is_grid(technique)
                                    : gtx_technique_is_blocks(technique);
}

void gtx_programs_destroy(gtx_renderer *renderer)
{
    for (uint32_t i = 0; i < GTX_PIPELINE_COUNT; ++i)
        if (renderer->programs[i].object)
            renderer->gl.DeleteProgram(renderer->programs[i].object);
}

gtx_result gtx_shading_begin(gtx_renderer *renderer, const char *text, gtx_shading **out,
                             gtx_error *error)
{
    if (!renderer || !text || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a shading needs a renderer and a main");
    *out = NULL;
    gtx_shading *shading = gtx_alloc_array(&renderer->allocator, 1, sizeof *shading);
    if (shading) {
        shading->text_size = strlen(text) + 1;
        shading->text = gtx_alloc_raw(&renderer->allocator, shading->text_size, 1);
    }
    if (!shading || !shading->text) {
        gtx_shading_destroy(renderer, shading);
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a shading");
    }
    memcpy(shading->text, text, shading->text_size);
    /* Mains that do not say so may read what tiles do not have. */
    const bool tiles = renderer->gl.TexBuffer && strstr(text, "#pragma geotex tiles");
    const bool vertices = strstr(text, "#pragma geotex vertices");
    for (int i = 0; i < OWN_TECHNIQUE_COUNT; ++i) {
        const gtx_technique technique = (gtx_technique)(TECHNIQUE_OWN_CAST + i);
        shading->has[i] = (technique != TECHNIQUE_OWN_TILES || tiles) &&
                          (!gtx_technique_is_at_vertices(technique) || vertices) &&
                          !gtx_is_displaced_otherwise(renderer, technique);
    }
    *out = shading;
    return GTX_OK;
}

gtx_result gtx_shading_compile(gtx_renderer *renderer, gtx_shading *shading, uint32_t techniques,
                               gtx_error *error)
{
    gtx_result result = GTX_OK;
    for (int i = 0; i < OWN_TECHNIQUE_COUNT && !result; ++i)
        if (techniques >> i & 1 && shading->has[i] && !shading->programs[i].object)
            result = build(renderer, gtx_pipeline_of((gtx_technique)(TECHNIQUE_OWN_CAST + i),
                                                     GTX_PASS_FORWARD, MATERIAL_MAPS),
                           shading->text, &shading->programs[i], error);
    return result;
}

static void forget_text(const gtx_renderer *renderer, gtx_shading *shading)
{
    gtx_free_array(&renderer->allocator, shading->text, shading->text_size, 1);
    shading->text = NULL;
}

gtx_result gtx_shading_create(gtx_renderer *renderer, const char *text, gtx_shading **out,
                              gtx_error *error)
{
    gtx_result result = gtx_shading_begin(renderer, text, out, error);
    if (result)
        return result;
    result = gtx_shading_compile(renderer, *out, UINT32_MAX, error);
    forget_text(renderer, *out);
    if (result) {
        gtx_shading_destroy(renderer, *out);
        *out = NULL;
    }
    return result;
}

void gtx_shading_destroy(gtx_renderer *renderer, gtx_shading *shading)
{
    if (!shading)
        return;
    for (int i = 0; i < OWN_TECHNIQUE_COUNT; ++i)
        renderer->gl.DeleteProgram(shading->programs[i].object);
    forget_text(renderer, shading);
    gtx_free_array(&renderer->allocator, shading, 1, sizeof *shading);
}

_Static_assert((int)OWN_TECHNIQUE_COUNT <= (int)GTX_SHADING_PROGRAMS,
               "render.h makes room for all");

uint32_t gtx_shading_programs(const gtx_shading *shading, uint32_t out[GTX_SHADING_PROGRAMS])
{
    uint32_t count = 0;
    for (int i = 0; i < OWN_TECHNIQUE_COUNT; ++i)
        if (shading->programs[i].object)
            out[count++] = shading->programs[i].object;
    return count;
}
