/* Programs: shader files put together in order, compiled and linked. */
#include "render/renderer.h"

#include "base/alloc.h"
#include "base/error.h"
#include "render/shaders.h"

#include <string.h>

enum { MAX_PARTS = 6, MAX_TEXTS = 16, MAX_LOG = 2048 };

/* What a program consists of: between #version and the parts come its defines and, in either stage,
 * the files that all share. */
typedef struct recipe {
    const char *vertex, *defines, *parts[MAX_PARTS], *label;
} recipe;

#define PROXY "geotex_proxy.vert"
#define MATERIALS "#define GTX_MATERIALS\n"
#define PLAIN "#define GTX_PLAIN\n"
#define CAST "geotex_cast.glsl", "geotex_fragment.glsl"
#define PAPER "geotex_paper.glsl", "geotex_fragment.glsl"
#define POLYGONS "geotex_lod.vert"
#define CORNERS "geotex_tiles.vert"
#define TILES "#define GTX_TILES\n"
#define WALK CAST, "geotex_tiles.glsl"
#define FRONT "#define GTX_FRONT\n"
#define ALONE "#define GTX_ALONE\n"
#define COLORS "#define GTX_COLORS\n"
#define LOD "geotex_lod_fragment.glsl"
#define RAYS "geotex_rays.glsl"

static const recipe recipes[PROGRAM_COUNT] = {
    [PROGRAM_CAST] = {PROXY, PLAIN, {CAST, "geotex_forward.frag"}, "geotex cast"},
    [PROGRAM_CAST_COLOR] = {PROXY, "", {CAST, "geotex_forward.frag"}, "geotex cast, colors"},
    [PROGRAM_CAST_MATERIAL] = {PROXY, MATERIALS,
                               {"geotex_material.glsl", CAST, "geotex_forward.frag"},
                               "geotex cast, materials"},
    [PROGRAM_CAST_DEPTH] = {PROXY, "", {CAST, "geotex_depth.frag"}, "geotex cast, depth"},
    [PROGRAM_CAST_ID] = {PROXY, "", {CAST, "geotex_id.frag"}, "geotex cast, ids"},
    [PROGRAM_CAST_GBUFFER] = {PROXY, MATERIALS,
                              {"geotex_material.glsl", CAST, "geotex_gbuffer.frag"},
                              "geotex cast, g-buffer"},
    [PROGRAM_PAPER] = {PROXY, "", {PAPER, "geotex_forward.frag"}, "geotex paper"},
    [PROGRAM_PAPER_MATERIAL] = {PROXY, MATERIALS,
                                {"geotex_material.glsl", PAPER, "geotex_forward.frag"},
                                "geotex paper, materials"},
    [PROGRAM_PAPER_DEPTH] = {PROXY, "", {PAPER, "geotex_depth.frag"}, "geotex paper, depth"},
    [PROGRAM_PAPER_ID] = {PROXY, "", {PAPER, "geotex_id.frag"}, "geotex paper, ids"},
    [PROGRAM_PAPER_GBUFFER] = {PROXY, MATERIALS,
                               {"geotex_material.glsl", PAPER, "geotex_gbuffer.frag"},
                               "geotex paper, g-buffer"},
    [PROGRAM_LOD] = {POLYGONS, "", {LOD, "geotex_lod.frag"}, "geotex LOD mesh"},
    [PROGRAM_LOD_FRONT] = {POLYGONS, FRONT, {"geotex_lod_front.frag"}, "geotex LOD mesh, front"},
    [PROGRAM_LOD_MATERIAL] = {POLYGONS, MATERIALS,
                              {"geotex_material.glsl", LOD, "geotex_lod.frag"},
                              "geotex LOD mesh, materials"},
    [PROGRAM_LOD_DEPTH] = {POLYGONS, "", {LOD, "geotex_depth.frag"}, "geotex LOD mesh, depth"},
    [PROGRAM_LOD_DEPTH_ALONE] = {POLYGONS, ALONE, {LOD, "geotex_depth.frag"},
                                 "geotex LOD mesh, depth, alone"},
    [PROGRAM_LOD_ID] = {POLYGONS, "", {LOD, "geotex_id.frag"}, "geotex LOD mesh, ids"},
    [PROGRAM_LOD_GBUFFER] = {POLYGONS, MATERIALS,
                             {"geotex_material.glsl", LOD, "geotex_gbuffer.frag"},
                             "geotex LOD mesh, g-buffer"},
    [PROGRAM_LOD_MATERIAL_FRONT] = {POLYGONS, MATERIALS FRONT,
                                    {"geotex_material.glsl", "geotex_lod_front.frag"},
                                    "geotex LOD mesh, materials, front"},
    [PROGRAM_LOD_EVEN_FRONT] = {POLYGONS, MATERIALS FRONT "#define GTX_EVEN\n",
                                {"geotex_material.glsl", "geotex_lod_front.frag"},
                                "geotex LOD mesh, one material, front"},
    [PROGRAM_LOD_COLOR] = {POLYGONS, COLORS, {LOD, "geotex_lod.frag"},
                           "geotex LOD mesh, colors"},
    [PROGRAM_LOD_COLOR_FRONT] = {POLYGONS, COLORS FRONT, {"geotex_lod_front.frag"},
                                 "geotex LOD mesh, colors, front"},
    [PROGRAM_TILES] = {CORNERS, TILES PLAIN, {WALK, "geotex_forward.frag"}, "geotex tiles"},
    [PROGRAM_TILES_COLOR] = {CORNERS, TILES, {WALK, "geotex_forward.frag"},
                             "geotex tiles, colors"},
    [PROGRAM_TILES_MATERIAL] = {CORNERS, TILES MATERIALS,
                                {"geotex_material.glsl", WALK, "geotex_forward.frag"},
                                "geotex tiles, materials"},
    [PROGRAM_TILES_DEPTH] = {CORNERS, TILES, {WALK, "geotex_depth.frag"}, "geotex tiles, depth"},
    [PROGRAM_TILES_ID] = {CORNERS, TILES, {WALK, "geotex_id.frag"}, "geotex tiles, ids"},
    [PROGRAM_TILES_GBUFFER] = {CORNERS, TILES MATERIALS,
                               {"geotex_material.glsl", WALK, "geotex_gbuffer.frag"},
                               "geotex tiles, g-buffer"},
};
static const recipe own_cast = {PROXY, MATERIALS, {"geotex_material.glsl", CAST, RAYS},
                                "geotex cast, own"};
static const recipe own_lod = {POLYGONS, MATERIALS "#define GTX_LOD\n",
                               {"geotex_material.glsl", LOD, RAYS}, "geotex LOD mesh, own"};

const char *gtx_shader_source(const char *name)
{
    for (const gtx_shader_file *file = gtx_shader_files; name && file->name; ++file)
        if (strcmp(file->name, name) == 0)
            return file->text;
    return NULL;
}

/* The texts of a shader, in order. */
typedef struct source {
    const char *texts[MAX_TEXTS];
    gl_size count;
} source;

static void add(source *s, const char *text)
{
    s->texts[s->count++] = text;
}

static source begin(bool es, const recipe *r)
{
    source s = {.count = 0};
    add(&s, es ? "#version 300 es\n" : "#version 330 core\n");
    add(&s, r->defines);
    add(&s, gtx_shader_source("geotex_dialect.glsl"));
    add(&s, gtx_shader_source("geotex_height_field.glsl"));
    add(&s, gtx_shader_source("geotex_view.glsl"));
    return s;
}

static source vertex_source(bool es, const recipe *r)
{
    source s = begin(es, r);
    add(&s, gtx_shader_source(r->vertex));
    return s;
}

/* `text` ends the shader if it is not NULL. */
static source fragment_source(bool es, const recipe *r, const char *text)
{
    source s = begin(es, r);
    add(&s, gtx_shader_source("geotex_surface.glsl"));
    for (int i = 0; i < MAX_PARTS && r->parts[i]; ++i)
        add(&s, gtx_shader_source(r->parts[i]));
    if (text)
        add(&s, text);
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
    program->clip_from_world = gl->GetUniformLocation(program->object, "gtx_clip_from_world");
    program->depth = gl->GetUniformLocation(program->object, "gtx_depth");
    program->light = gl->GetUniformLocation(program->object, "gtx_light");
    program->detail = gl->GetUniformLocation(program->object, "gtx_detail");
    program->search = gl->GetUniformLocation(program->object, "gtx_search");
    program->maps = gl->GetUniformLocation(program->object, "gtx_maps");
    program->even = gl->GetUniformLocation(program->object, "gtx_even");
    program->lod = gl->GetUniformLocation(program->object, "gtx_lod_mesh");
    gl->UseProgram(program->object);
    for (gl_int i = 0; i < UNIT_COUNT; ++i)
        gl->Uniform1i(gl->GetUniformLocation(program->object, samplers[i]), i);
    gl->Uniform1i(gl->GetUniformLocation(program->object, "gtx_stream"), UNIT_STREAM);
    gtx_rays_locate(gl, program->object);
    gl->UseProgram(0);
}

static gtx_result build(const gtx_renderer *renderer, const recipe *r, const char *text,
                        gtx_program *out, gtx_error *error)
{
    const gtx_gl *gl = &renderer->gl;
    const source above = vertex_source(gl->es, r), below = fragment_source(gl->es, r, text);
    const gl_uint vertex = compile(renderer, GL_VERTEX_SHADER, &above);
    const gl_uint fragment = vertex ? compile(renderer, GL_FRAGMENT_SHADER, &below) : 0;
    out->object = fragment ? link_stages(renderer, (gl_uint[2]){vertex, fragment}, 2) : 0;
    if (vertex)
        gl->DeleteShader(vertex);
    if (fragment)
        gl->DeleteShader(fragment);
    if (!out->object)
        return gtx_fail(error, GTX_ERROR_SHADER, "a shader did not compile; the log says why");
    gtx_gl_label(gl, GL_PROGRAM, out->object, r->label);
    locate(gl, out);
    return GTX_OK;
}

gtx_result gtx_program_need(gtx_renderer *renderer, int program, gtx_error *error)
{
    gtx_program *out = &renderer->programs[program];
    return out->object ? GTX_OK : build(renderer, &recipes[program], NULL, out, error);
}

gtx_result gtx_programs_create(gtx_renderer *renderer, gtx_error *error)
{
    static const int first[] = {PROGRAM_CAST, PROGRAM_CAST_MATERIAL, PROGRAM_PAPER,
                                PROGRAM_PAPER_MATERIAL, PROGRAM_LOD, PROGRAM_LOD_MATERIAL,
                                PROGRAM_LOD_FRONT, PROGRAM_LOD_COLOR,
                                PROGRAM_LOD_COLOR_FRONT, PROGRAM_LOD_MATERIAL_FRONT,
                                PROGRAM_LOD_EVEN_FRONT, PROGRAM_CAST_COLOR};
    gtx_result result = GTX_OK;
    static const int tiles[] = {PROGRAM_TILES, PROGRAM_TILES_MATERIAL, PROGRAM_TILES_COLOR};
    for (size_t i = 0; i < sizeof first / sizeof *first && !result; ++i)
        result = gtx_program_need(renderer, first[i], error);
    for (int i = 0; i < 3 && !result && renderer->gl.TexBuffer; ++i)
        result = gtx_program_need(renderer, tiles[i], error);
    return result;
}

void gtx_programs_destroy(gtx_renderer *renderer)
{
    for (int i = 0; i < PROGRAM_COUNT; ++i)
        if (renderer->programs[i].object)
            renderer->gl.DeleteProgram(renderer->programs[i].object);
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
    gtx_result result = build(renderer, &own_cast, text, &shading->cast, error);
    if (!result)
        result = build(renderer, &own_lod, text, &shading->lod, error);
    if (result)
        gtx_shading_destroy(renderer, shading);
    else
        *out = shading;
    return result;
}

void gtx_shading_destroy(gtx_renderer *renderer, gtx_shading *shading)
{
    if (!shading)
        return;
    renderer->gl.DeleteProgram(shading->cast.object);
    renderer->gl.DeleteProgram(shading->lod.object);
    gtx_free_array(&renderer->allocator, shading, 1, sizeof *shading);
}

uint32_t gtx_shading_program(const gtx_shading *shading, gtx_method method)
{
    return method == GTX_METHOD_LOD ? shading->lod.object : shading->cast.object;
}
