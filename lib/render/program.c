/* Programs: shader files put together in order, compiled and linked; found by technique, pass and
 * material. */
#include "render/program.h"

#include "base/alloc.h"
#include "base/error.h"
#include "render/rays.h"
#include "render/renderer.h"
#include "frame/shaders.h"
#include "frame/units.h"

#include <stdio.h>
#include <string.h>

enum { MAX_PARTS = 3, MAX_TEXTS = 16, MAX_LOG = 2048, MAX_LABEL = 64 };

/* What a technique consists of: between #version and the parts come the defines of technique and
 * material and, in either stage, the files that all share. */
typedef struct technique_files {
    const char *label, *vertex, *defines, *parts[MAX_PARTS];
    const char *forward;      /* the main of the forward pass */
    /* Which material of the forward pass another one is drawn as. */
    uint8_t drawn_as[MATERIAL_COUNT];
} technique_files;

#define FRONT "#define GTX_FRONT\n"
#define GRID "#define GTX_GRID\n"
#define TRIMMED "#define GTX_TRIMMED\n"
#define LIT "#define GTX_LIT\n"
#define ALL_BUT_CONSTANT {MATERIAL_NONE, MATERIAL_COLORS, MATERIAL_MAPS, MATERIAL_MAPS}

static const technique_files techniques[TECHNIQUE_COUNT] = {
    [TECHNIQUE_CAST] = {"cast", "geotex_proxy.vert", "",
                        {"geotex_cast.glsl", "geotex_fragment.glsl"},
                        "geotex_forward.frag", ALL_BUT_CONSTANT},
    [TECHNIQUE_BOX] = {"cast in boxes", "geotex_proxy.vert", "#define GTX_SKIP\n",
                       {"geotex_cast.glsl", "geotex_skip.glsl", "geotex_fragment.glsl"},
                       "geotex_forward.frag", ALL_BUT_CONSTANT},
    [TECHNIQUE_PAPER] = {"paper", "geotex_proxy.vert", "",
                         {"geotex_paper.glsl", "geotex_fragment.glsl"},
                         "geotex_forward.frag",
                         {MATERIAL_COLORS, MATERIAL_COLORS, MATERIAL_MAPS, MATERIAL_MAPS}},
    [TECHNIQUE_TILES] = {"tiles", "geotex_tiles.vert", "#define GTX_TILES\n",
                         {"geotex_cast.glsl", "geotex_fragment.glsl", "geotex_tiles.glsl"},
                         "geotex_forward.frag", ALL_BUT_CONSTANT},
    [TECHNIQUE_LOD] = {"LOD mesh", "geotex_lod.vert", "", {"geotex_lod_fragment.glsl"},
                       "geotex_lod.frag", ALL_BUT_CONSTANT},
    [TECHNIQUE_LOD_FRONT] = {"LOD mesh front", "geotex_lod.vert", FRONT, {NULL},
                             "geotex_lod_front.frag",
                             {MATERIAL_NONE, MATERIAL_COLORS, MATERIAL_MAPS, MATERIAL_CONSTANT}},
    [TECHNIQUE_LOD_SINGLE] = {"LOD mesh single", "geotex_lod.vert", "#define GTX_SINGLE\n",
                              {"geotex_lod_fragment.glsl"}, NULL, {0}},
    [TECHNIQUE_GRID] = {"grid", "geotex_lod.vert", GRID TRIMMED, {"geotex_lod_fragment.glsl"},
                        "geotex_lod.frag", ALL_BUT_CONSTANT},
    [TECHNIQUE_GRID_FRONT] = {"grid front", "geotex_lod.vert", GRID TRIMMED FRONT, {NULL},
                              "geotex_lod_front.frag",
                              {MATERIAL_NONE, MATERIAL_COLORS, MATERIAL_MAPS, MATERIAL_CONSTANT}},
    [TECHNIQUE_GRID_WHOLE] = {"whole grid", "geotex_lod.vert", GRID,
                              {"geotex_lod_fragment.glsl"}, "geotex_lod.frag", ALL_BUT_CONSTANT},
    [TECHNIQUE_GRID_WHOLE_FRONT] = {"whole grid front", "geotex_lod.vert", GRID FRONT, {NULL},
                                    "geotex_lod_front.frag",
                                    {MATERIAL_NONE, MATERIAL_COLORS, MATERIAL_MAPS,
                                     MATERIAL_CONSTANT}},
    [TECHNIQUE_GRID_LIT] = {"lit grid", "geotex_lod.vert", GRID TRIMMED LIT, {NULL},
                            "geotex_lit.frag", {MATERIAL_NONE}},
    [TECHNIQUE_GRID_WHOLE_LIT] = {"whole lit grid", "geotex_lod.vert", GRID LIT, {NULL},
                                  "geotex_lit.frag", {MATERIAL_NONE}},
};

static const struct {
    const char *label, *defines, *file;
} materials[MATERIAL_COUNT] = {
    [MATERIAL_NONE] = {"", "#define GTX_PLAIN\n", NULL},
    [MATERIAL_COLORS] = {", colors", "", NULL},
    [MATERIAL_MAPS] = {", materials", "#define GTX_MATERIALS\n", "geotex_material.glsl"},
    [MATERIAL_CONSTANT] = {", one material", "#define GTX_MATERIALS\n#define GTX_CONSTANT\n",
                           "geotex_material.glsl"},
};

/* Passes with a main for all techniques, which reads what one material has. */
static const struct {
    const char *label, *main;
    gtx_material_kind material;
} passes[GTX_PASS_COUNT] = {
    [GTX_PASS_DEPTH] = {", depth", "geotex_depth.frag", MATERIAL_COLORS},
    [GTX_PASS_ID] = {", ids", "geotex_id.frag", MATERIAL_COLORS},
    [GTX_PASS_GBUFFER] = {", g-buffer", "geotex_gbuffer.frag", MATERIAL_MAPS},
};

/* What a program is built of. */
typedef struct recipe {
    const technique_files *technique;
    gtx_material_kind material;
    const char *rays, *main, *label; /* texts; rays may be NULL */
} recipe;

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

/* What both stages begin with. */
static source begin(bool es, const recipe *r)
{
    static const char *const shared[] = {"geotex_dialect.glsl", "geotex_records.glsl",
                                         "geotex_height_field.glsl", "geotex_view.glsl"};
    source s = {.count = 0};
    add(&s, es ? "#version 300 es\n" : "#version 330 core\n");
    add(&s, r->technique->defines);
    add(&s, materials[r->material].defines);
    for (size_t i = 0; i < sizeof shared / sizeof *shared; ++i)
        add(&s, gtx_shader_source(shared[i]));
    return s;
}

static source vertex_source(bool es, const recipe *r)
{
    source s = begin(es, r);
    add(&s, gtx_shader_source(r->technique->vertex));
    return s;
}

static source fragment_source(bool es, const recipe *r)
{
    source s = begin(es, r);
    add(&s, gtx_shader_source("geotex_surface.glsl"));
    if (materials[r->material].file)
        add(&s, gtx_shader_source(materials[r->material].file));
    for (int i = 0; i < MAX_PARTS && r->technique->parts[i]; ++i)
        add(&s, gtx_shader_source(r->technique->parts[i]));
    if (r->rays)
        add(&s, r->rays);
    add(&s, r->main);
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
    program->constant_material =
        gl->GetUniformLocation(program->object, "gtx_constant_material");
    program->lod = gl->GetUniformLocation(program->object, "gtx_lod_mesh");
    gl->UseProgram(program->object);
    for (gl_int i = 0; i < UNIT_COUNT; ++i)
        gl->Uniform1i(gl->GetUniformLocation(program->object, samplers[i]), i);
    gl->Uniform1i(gl->GetUniformLocation(program->object, "gtx_stream"), UNIT_STREAM);
    gtx_rays_locate(gl, program->object);
    gl->UseProgram(0);
}

static gtx_result build(const gtx_renderer *renderer, const recipe *r, gtx_program *out,
                        gtx_error *error)
{
    const gtx_gl *gl = &renderer->gl;
    const source above = vertex_source(gl->es, r), below = fragment_source(gl->es, r);
    const gl_uint vertex = compile(renderer, GL_VERTEX_SHADER, &above);
    const gl_uint fragment = vertex ? compile(renderer, GL_FRAGMENT_SHADER, &below) : 0;
    char label[MAX_LABEL];
    out->object = fragment ? link_stages(renderer, (gl_uint[2]){vertex, fragment}, 2) : 0;
    if (vertex)
        gl->DeleteShader(vertex);
    if (fragment)
        gl->DeleteShader(fragment);
    if (!out->object)
        return gtx_fail(error, GTX_ERROR_SHADER, "a shader did not compile; the log says why");
    snprintf(label, sizeof label, "geotex %s%s", r->technique->label, r->label);
    gtx_gl_label(gl, GL_PROGRAM, out->object, label);
    locate(gl, out);
    return GTX_OK;
}

static gtx_material_kind drawn_as(gtx_technique technique, gtx_pass pass,
                                  gtx_material_kind material)
{
    return pass == GTX_PASS_FORWARD ? techniques[technique].drawn_as[material]
                                    : passes[pass].material;
}

const gtx_program *gtx_program_of(const gtx_renderer *renderer, gtx_technique technique,
                                  gtx_pass pass, gtx_material_kind material)
{
    return &renderer->programs[technique][pass][drawn_as(technique, pass, material)];
}

gtx_result gtx_programs_need(gtx_renderer *renderer, gtx_technique technique, gtx_pass pass,
                             gtx_error *error)
{
    const bool forward = pass == GTX_PASS_FORWARD;
    gtx_result result = GTX_OK;
    for (int i = 0; i < MATERIAL_COUNT && !result; ++i) {
        const gtx_material_kind material = drawn_as(technique, pass, (gtx_material_kind)i);
        gtx_program *out = &renderer->programs[technique][pass][material];
        const recipe r = {
            &techniques[technique], material, NULL,
            gtx_shader_source(forward ? techniques[technique].forward : passes[pass].main),
            forward ? materials[material].label : passes[pass].label};
        if (!out->object)
            result = build(renderer, &r, out, error);
    }
    return result;
}

gtx_result gtx_programs_create(gtx_renderer *renderer, gtx_error *error)
{
    gtx_result result = GTX_OK;
    for (int i = 0; i < TECHNIQUE_COUNT && !result; ++i)
        if (techniques[i].forward && (i != TECHNIQUE_TILES || renderer->gl.TexBuffer))
            result = gtx_programs_need(renderer, (gtx_technique)i, GTX_PASS_FORWARD, error);
    return result;
}

void gtx_programs_destroy(gtx_renderer *renderer)
{
    gtx_program *all = renderer->programs[0][0];
    for (size_t i = 0; i < sizeof renderer->programs / sizeof *all; ++i)
        if (all[i].object)
            renderer->gl.DeleteProgram(all[i].object);
}

/* Polygons, for mains that tell them apart. */
static const technique_files own_lod = {.label = "LOD mesh", .vertex = "geotex_lod.vert",
                                  .defines = "#define GTX_LOD\n",
                                  .parts = {"geotex_lod_fragment.glsl"}};
static const technique_files own_grid = {.label = "grid", .vertex = "geotex_lod.vert",
                                   .defines = "#define GTX_LOD\n" GRID TRIMMED,
                                   .parts = {"geotex_lod_fragment.glsl"}};

gtx_result gtx_shading_create(gtx_renderer *renderer, const char *text, gtx_shading **out,
                              gtx_error *error)
{
    if (!renderer || !text || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a shading needs a renderer and a main");
    *out = NULL;
    gtx_shading *shading = gtx_alloc_array(&renderer->allocator, 1, sizeof *shading);
    if (!shading)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a shading");
    const char *rays = gtx_shader_source("geotex_rays.glsl");
    const recipe cast = {&techniques[TECHNIQUE_CAST], MATERIAL_MAPS, rays, text, ", own"};
    const recipe lod = {&own_lod, MATERIAL_MAPS, rays, text, ", own"};
    const recipe grid = {&own_grid, MATERIAL_MAPS, rays, text, ", own"};
    gtx_result result = build(renderer, &cast, &shading->cast, error);
    if (!result)
        result = build(renderer, &lod, &shading->lod, error);
    if (!result)
        result = build(renderer, &grid, &shading->grid, error);
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
    renderer->gl.DeleteProgram(shading->grid.object);
    gtx_free_array(&renderer->allocator, shading, 1, sizeof *shading);
}

uint32_t gtx_shading_program(const gtx_shading *shading, gtx_method method)
{
    return method == GTX_METHOD_LOD    ? shading->lod.object
           : method == GTX_METHOD_GRID ? shading->grid.object
                                       : shading->cast.object;
}
