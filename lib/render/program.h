/* Shader programs: one for each draw technique, pass and kind of material that needs its own. */
#ifndef GTX_RENDER_PROGRAM_H
#define GTX_RENDER_PROGRAM_H

#include "render/gl.h"

#include <geotex/render.h>

/* How fragments come about: by casting in the proxy of a patch, exactly or by the paper's search;
 * by casting in a tile; or by the LOD mesh. */
typedef enum gtx_technique {
    TECHNIQUE_CAST,
    TECHNIQUE_BOX,            /* the same in boxes, skipping by slabs */
    TECHNIQUE_PAPER,
    TECHNIQUE_TILES,
    TECHNIQUE_LOD,
    TECHNIQUE_LOD_FRONT,      /* front faces alone, under transforms that keep angles */
    TECHNIQUE_LOD_SINGLE,     /* depth of one instance, whose transform is a uniform */
    TECHNIQUE_GRID,           /* triangles of a displaced grid that do not show whole */
    TECHNIQUE_GRID_FRONT,
    TECHNIQUE_GRID_WHOLE,     /* those that do */
    TECHNIQUE_GRID_WHOLE_FRONT,
    TECHNIQUE_GRID_LIT,       /* those lit at their vertices */
    TECHNIQUE_GRID_WHOLE_LIT,
    TECHNIQUE_COUNT
} gtx_technique;

/* What a model's surface is shaded by. */
typedef enum gtx_material_kind {
    MATERIAL_NONE,            /* Lambert, of the instance's tint */
    MATERIAL_COLORS,          /* Lambert, of the map of colours */
    MATERIAL_MAPS,            /* metallic-roughness, or emission */
    MATERIAL_CONSTANT,        /* metallic-roughness, the same all over, without emission */
    MATERIAL_COUNT
} gtx_material_kind;

enum { GTX_PASS_COUNT = GTX_PASS_GBUFFER + 1 };

typedef struct gtx_program {
    gl_uint object;
    gl_int clip_from_world, depth, light, detail, search, maps, lod, constant_material;
    gl_int place;             /* of the only instance */
    gl_int tint, instance;    /* of what is cast by tiles */
} gtx_program;

struct gtx_shading {
    gtx_program cast, lod, grid;
};

/* Compiles what a technique needs for a pass, with any material. Errors: SHADER. */
gtx_result gtx_programs_need(gtx_renderer *renderer, gtx_technique technique, gtx_pass pass,
                             gtx_error *error);
/* Those of the forward pass, for all techniques that the context has. Errors: SHADER. */
gtx_result gtx_programs_create(gtx_renderer *renderer, gtx_error *error);
void gtx_programs_destroy(gtx_renderer *renderer);
const gtx_program *gtx_program_of(const gtx_renderer *renderer, gtx_technique technique,
                                  gtx_pass pass, gtx_material_kind material);

#endif
