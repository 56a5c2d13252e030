/* Pipelines: which shader files, in which order, each is made of. */
#include "frame/pipelines.h"

#include "frame/shaders.h"

#include <stdio.h>
#include <string.h>

enum { MAX_PARTS = 4 };

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
#define SINGLE "#define GTX_SINGLE\n"
#define NORMALS "#define GTX_VERTEX_NORMALS\n"
#define OWN_VERTICES LIT "#define GTX_OWN_VERTICES\n"
#define BLOCKS GRID "#define GTX_BLOCKS\n"
#define ALL_MAPS {MATERIAL_MAPS, MATERIAL_MAPS, MATERIAL_MAPS, MATERIAL_MAPS}
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
    [TECHNIQUE_LOD_SINGLE] = {"LOD mesh single", "geotex_lod.vert", SINGLE,
                              {"geotex_lod_fragment.glsl"}, NULL, {0}},
    [TECHNIQUE_LOD_LIT] = {"lit LOD mesh", "geotex_lod.vert", LIT, {NULL},
                           "geotex_lod_lit.frag", {MATERIAL_NONE}},
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
                            "geotex_lit.frag",
                            {MATERIAL_NONE, MATERIAL_COLORS, MATERIAL_MAPS, MATERIAL_CONSTANT}},
    [TECHNIQUE_GRID_WHOLE_LIT] = {"whole lit grid", "geotex_lod.vert", GRID LIT, {NULL},
                                  "geotex_lit.frag",
                                  {MATERIAL_NONE, MATERIAL_COLORS, MATERIAL_MAPS,
                                   MATERIAL_CONSTANT}},
    [TECHNIQUE_BLOCKS] = {"blocks", "geotex_lod.vert", BLOCKS TRIMMED,
                          {"geotex_lod_fragment.glsl"}, "geotex_lod.frag", ALL_BUT_CONSTANT},
    [TECHNIQUE_BLOCKS_FRONT] = {"blocks front", "geotex_lod.vert", BLOCKS TRIMMED FRONT, {NULL},
                                "geotex_lod_front.frag",
                                {MATERIAL_NONE, MATERIAL_COLORS, MATERIAL_MAPS,
                                 MATERIAL_CONSTANT}},
    [TECHNIQUE_BLOCKS_WHOLE] = {"whole blocks", "geotex_lod.vert", BLOCKS,
                                {"geotex_lod_fragment.glsl"}, "geotex_lod.frag",
                                ALL_BUT_CONSTANT},
    [TECHNIQUE_BLOCKS_WHOLE_FRONT] = {"whole blocks front", "geotex_lod.vert", BLOCKS FRONT,
                                      {NULL}, "geotex_lod_front.frag",
                                      {MATERIAL_NONE, MATERIAL_COLORS, MATERIAL_MAPS,
                                       MATERIAL_CONSTANT}},
    [TECHNIQUE_OWN_CAST] = {"cast, own", "geotex_proxy.vert", "",
                            {"geotex_cast.glsl", "geotex_fragment.glsl", "geotex_rays.glsl"},
                            NULL, ALL_MAPS},
    /* Polygons, for mains that tell them apart. */
    [TECHNIQUE_OWN_LOD] = {"LOD mesh, own", "geotex_lod.vert", "#define GTX_LOD\n",
                           {"geotex_lod_fragment.glsl", "geotex_rays.glsl"}, NULL, ALL_MAPS},
    [TECHNIQUE_OWN_LOD_NORMALS] = {"LOD mesh with normals, own", "geotex_lod.vert",
                                   "#define GTX_LOD\n" NORMALS,
                                   {"geotex_lod_fragment.glsl", "geotex_rays.glsl"}, NULL,
                                   ALL_MAPS},
    [TECHNIQUE_OWN_LOD_LIT] = {"lit LOD mesh, own", "geotex_lod.vert",
                               OWN_VERTICES SINGLE, {NULL}, "geotex_lod_lit.frag", ALL_MAPS},
    [TECHNIQUE_OWN_GRID] = {"grid, own", "geotex_lod.vert", "#define GTX_LOD\n" GRID TRIMMED,
                            {"geotex_lod_fragment.glsl", "geotex_rays.glsl"}, NULL, ALL_MAPS},
    [TECHNIQUE_OWN_GRID_NORMALS] = {"whole grid with normals, own", "geotex_lod.vert",
                                    "#define GTX_LOD\n" GRID NORMALS,
                                    {"geotex_lod_fragment.glsl", "geotex_rays.glsl"}, NULL,
                                    ALL_MAPS},
    [TECHNIQUE_OWN_GRID_LIT] = {"lit grid, own", "geotex_lod.vert", GRID TRIMMED OWN_VERTICES,
                                {NULL}, "geotex_lit.frag", ALL_MAPS},
    [TECHNIQUE_OWN_GRID_WHOLE_LIT] = {"whole lit grid, own", "geotex_lod.vert",
                                      GRID OWN_VERTICES, {NULL}, "geotex_lit.frag", ALL_MAPS},
    [TECHNIQUE_OWN_BLOCKS] = {"blocks, own", "geotex_lod.vert",
                              "#define GTX_LOD\n" BLOCKS TRIMMED,
                              {"geotex_lod_fragment.glsl", "geotex_rays.glsl"}, NULL, ALL_MAPS},
    [TECHNIQUE_OWN_TILES] = {"tiles, own", "geotex_tiles.vert", "#define GTX_TILES\n",
                             {"geotex_cast.glsl", "geotex_fragment.glsl", "geotex_tiles.glsl",
                              "geotex_rays.glsl"},
                             NULL, ALL_MAPS},
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

const char *gtx_shader_source(const char *name)
{
    for (const gtx_shader_file *file = gtx_shader_files; name && file->name; ++file)
        if (strcmp(file->name, name) == 0)
            return file->text;
    return NULL;
}

/* What a number stands for. */
typedef struct recipe {
    gtx_technique technique;
    gtx_pass pass;
    gtx_material_kind material;
} recipe;

static recipe recipe_of(uint32_t pipeline)
{
    const uint32_t of_technique = pipeline / MATERIAL_COUNT;
    return (recipe){(gtx_technique)(of_technique / GTX_PASS_COUNT),
                    (gtx_pass)(of_technique % GTX_PASS_COUNT),
                    (gtx_material_kind)(pipeline % MATERIAL_COUNT)};
}

static bool is_own(gtx_technique technique)
{
    return technique >= TECHNIQUE_OWN_CAST;
}

_Static_assert(TECHNIQUE_COUNT * GTX_PASS_COUNT * MATERIAL_COUNT == GTX_PIPELINE_COUNT,
               "frame.h says how many pipelines there may be");

uint32_t gtx_pipeline_of(gtx_technique technique, gtx_pass pass, gtx_material_kind material)
{
    const uint32_t drawn_as = pass == GTX_PASS_FORWARD ? techniques[technique].drawn_as[material]
                                                       : (uint32_t)passes[pass].material;
    return ((uint32_t)technique * GTX_PASS_COUNT + (uint32_t)pass) * MATERIAL_COUNT + drawn_as;
}

gtx_technique gtx_pipeline_technique(uint32_t pipeline)
{
    return recipe_of(pipeline).technique;
}

bool gtx_technique_is_grid(gtx_technique technique)
{
    return (technique >= TECHNIQUE_GRID && technique <= TECHNIQUE_GRID_WHOLE_LIT) ||
           (technique >= TECHNIQUE_OWN_GRID && technique <= TECHNIQUE_OWN_GRID_WHOLE_LIT);
}

bool gtx_technique_is_blocks(gtx_technique technique)
{
    return (technique >= TECHNIQUE_BLOCKS && technique <= TECHNIQUE_BLOCKS_WHOLE_FRONT) ||
           technique == TECHNIQUE_OWN_BLOCKS;
}

bool gtx_technique_is_at_vertices(gtx_technique technique)
{
    return is_own(technique) && techniques[technique].forward;
}

bool gtx_technique_is_forward(gtx_technique technique)
{
    return techniques[technique].forward && !is_own(technique);
}

/* Whether there is a pipeline of that number. */
static bool is_made(uint32_t pipeline)
{
    const recipe r = recipe_of(pipeline);
    if (pipeline >= GTX_PIPELINE_COUNT ||
        gtx_pipeline_of(r.technique, r.pass, r.material) != pipeline)
        return false;
    if (is_own(r.technique) || r.pass == GTX_PASS_FORWARD)
        return r.pass == GTX_PASS_FORWARD &&
               (is_own(r.technique) || techniques[r.technique].forward);
    return techniques[r.technique].parts[0]; /* others are forward alone */
}

static bool is_lod(gtx_technique technique)
{
    return (technique >= TECHNIQUE_LOD && technique <= TECHNIQUE_LOD_LIT) ||
           (technique >= TECHNIQUE_OWN_LOD && technique <= TECHNIQUE_OWN_LOD_LIT);
}

static bool is_cast(gtx_technique technique)
{
    return technique <= TECHNIQUE_TILES || technique == TECHNIQUE_OWN_CAST ||
           technique == TECHNIQUE_OWN_TILES;
}

static bool is_tiles(gtx_technique technique)
{
    return technique == TECHNIQUE_TILES || technique == TECHNIQUE_OWN_TILES;
}

uint32_t gtx_pipeline_get(uint32_t pipeline, gtx_pipeline *out)
{
    const recipe r = recipe_of(pipeline);
    const bool made = is_made(pipeline) &&
                      r.technique != TECHNIQUE_LOD_SINGLE && /* OpenGL's alone */
                      !gtx_technique_is_at_vertices(r.technique);
    if (!out)
        return 0;
    *out = (gtx_pipeline){GTX_PASS_FORWARD, GTX_BUFFER_PROXY_VERTICES, 0, 0};
    if (made)
        *out = (gtx_pipeline){
            .pass = r.pass,
            .vertices = is_tiles(r.technique)  ? GTX_BUFFER_TILE_CORNERS
                        : is_cast(r.technique) ? GTX_BUFFER_PROXY_VERTICES
                        : is_lod(r.technique)  ? GTX_BUFFER_LOD_VERTICES
                        : gtx_technique_is_blocks(r.technique) ? GTX_BUFFER_BLOCKS
                                                               : GTX_BUFFER_GRID_VERTICES,
            .own_main = is_own(r.technique),
            .writes_depth = is_cast(r.technique)};
    return made;
}

void gtx_pipeline_label(uint32_t pipeline, char label[GTX_MAX_LABEL])
{
    const recipe r = recipe_of(pipeline);
    snprintf(label, GTX_MAX_LABEL, "geotex %s%s", techniques[r.technique].label,
             r.pass == GTX_PASS_FORWARD ? materials[r.material].label : passes[r.pass].label);
}

/* The texts of a shader, in order. */
typedef struct source {
    const char **texts;
    uint32_t count;
} source;

static void add(source *s, const char *text)
{
    s->texts[s->count++] = text;
}

static void add_file(source *s, const char *name)
{
    if (name)
        add(s, gtx_shader_source(name));
}

/* What both stages begin with. */
static void begin(source *s, const recipe *r)
{
    static const char *const shared[] = {"geotex_dialect.glsl", "geotex_records.glsl",
                                         "geotex_height_field.glsl", "geotex_view.glsl"};
    add(s, techniques[r->technique].defines);
    add(s, materials[r->material].defines);
    for (size_t i = 0; i < sizeof shared / sizeof *shared; ++i)
        add_file(s, shared[i]);
}

static void add_own(source *s, const char *own_main)
{
    add(s, "#undef normalize\n#line 1 1\n");
    add(s, own_main);
}

/* Vertices that are lit have materials. */
static void add_vertex(source *s, const recipe *r, const char *own_main)
{
    const gtx_technique by = r->technique;
    const bool own = gtx_technique_is_at_vertices(by);
    const bool is_lit = own || by == TECHNIQUE_GRID_LIT || by == TECHNIQUE_GRID_WHOLE_LIT;
    if (is_lit && materials[r->material].file) {
        add_file(s, "geotex_surface.glsl");
        add_file(s, materials[r->material].file);
    }
    if (own)
        add_own(s, own_main);
    add_file(s, techniques[r->technique].vertex);
}

static void add_fragment(source *s, const recipe *r, const char *own_main)
{
    const technique_files *t = &techniques[r->technique];
    add_file(s, "geotex_surface.glsl");
    add_file(s, materials[r->material].file);
    for (int i = 0; i < MAX_PARTS; ++i)
        add_file(s, t->parts[i]);
    if (is_own(r->technique) && !t->forward)
        add_own(s, own_main);
    else
        add_file(s, r->pass == GTX_PASS_FORWARD ? t->forward : passes[r->pass].main);
}

uint32_t gtx_pipeline_source(uint32_t pipeline, gtx_stage stage, const char *own_main,
                             const char *texts[GTX_MAX_SHADER_TEXTS])
{
    const recipe r = recipe_of(pipeline);
    source s = {texts, 0};
    if (!texts || !is_made(pipeline) || (is_own(r.technique) && !own_main))
        return 0;
    begin(&s, &r);
    if (stage == GTX_STAGE_VERTEX)
        add_vertex(&s, &r, own_main);
    else
        add_fragment(&s, &r, own_main);
    return s.count;
}
