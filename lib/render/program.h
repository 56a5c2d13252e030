/* Shader programs: one a pipeline, with where its uniforms are. */
#ifndef GTX_RENDER_PROGRAM_H
#define GTX_RENDER_PROGRAM_H

#include "frame/pipelines.h"
#include "render/gl.h"

#include <geotex/render.h>

/* The members of gtx_constants. */
enum { GTX_CONSTANT_COUNT = 8 };

typedef struct gtx_program {
    gl_uint object;
    gl_int constants[GTX_CONSTANT_COUNT];
    gl_int place;             /* of the only instance */
    gl_int tint, instance;    /* of what is cast by tiles */
} gtx_program;

enum { OWN_TECHNIQUE_COUNT = TECHNIQUE_COUNT - TECHNIQUE_OWN_CAST };

struct gtx_shading {
    /* From TECHNIQUE_OWN_CAST on; without an object where the context or the main has none, or
     * where it is not compiled yet. */
    gtx_program programs[OWN_TECHNIQUE_COUNT];
    bool has[OWN_TECHNIQUE_COUNT];
    char *text;               /* until all is compiled */
    size_t text_size;
};

static inline bool gtx_shading_has(const gtx_shading *shading, gtx_technique technique)
{
    return shading->has[technique - TECHNIQUE_OWN_CAST];
}

/* gtx_shading_create in two steps: with nothing compiled, and some of it, from bit 0 for
 * TECHNIQUE_OWN_CAST on. Draws that lack some draw nothing from there on, and
 * gtx_renderer.lacking tells what. */
gtx_result gtx_shading_begin(gtx_renderer *renderer, const char *text, gtx_shading **out,
                             gtx_error *error);
gtx_result gtx_shading_compile(gtx_renderer *renderer, gtx_shading *shading, uint32_t techniques,
                               gtx_error *error);

/* Compiles what a technique needs for a pass, with any material. Errors: SHADER. */
gtx_result gtx_programs_need(gtx_renderer *renderer, gtx_technique technique, gtx_pass pass,
                             gtx_error *error);
/* What only a CPU displaces where a GPU draws, and the other way round. */
bool gtx_is_displaced_otherwise(const gtx_renderer *renderer, gtx_technique technique);
/* ahead.c: those of the forward pass, for all techniques that the context has. Errors: SHADER. */
gtx_result gtx_programs_create(gtx_renderer *renderer, gtx_error *error);
void gtx_programs_destroy(gtx_renderer *renderer);
/* Sets what differs of the uniforms of the program in use; all of them where `before` is NULL. */
void gtx_program_set(const gtx_gl *gl, const gtx_program *program, const gtx_constants *constants,
                     const gtx_constants *before);

#endif
