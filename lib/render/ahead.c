/* Programs that are compiled when a renderer is made, so that no frame waits for them. */
#include "frame/units.h"
#include "render/renderer.h"

gtx_result gtx_programs_create(gtx_renderer *renderer, gtx_error *error)
{
    gtx_result result = GTX_OK;
    for (int i = 0; i < TECHNIQUE_COUNT && !result; ++i)
        if (gtx_technique_is_forward((gtx_technique)i) &&
            (i != TECHNIQUE_TILES || renderer->gl.TexBuffer) &&
            !gtx_is_displaced_otherwise(renderer, (gtx_technique)i))
            result = gtx_programs_need(renderer, (gtx_technique)i, GTX_PASS_FORWARD, error);
    return result;
}
