/* Renderers: the objects of one context that all models share. */
#include "render/renderer.h"

#include "base/alloc.h"
#include "base/error.h"

#include <stdio.h>

/* One line on what the renderer runs on: the first question of every bug report. */
static void log_context(const gtx_renderer *renderer)
{
    const gtx_gl *gl = &renderer->gl;
    char line[256];
    if (!renderer->log)
        return;
    snprintf(line, sizeof line, "geotex: %s%.80s, %.100s%s", gl->es ? "" : "OpenGL ",
             (const char *)gl->GetString(GL_VERSION), (const char *)gl->GetString(GL_RENDERER),
             gl->ObjectLabel ? ", objects labelled" : "");
    renderer->log(line, renderer->log_user);
}

/* A name becomes an object, and can be labelled, once it is bound. */
static void create_shared(gtx_renderer *renderer)
{
    const gtx_gl *gl = &renderer->gl;
    gl->GenVertexArrays(1, &renderer->vertex_array);
    gl->BindVertexArray(renderer->vertex_array);
    gtx_gl_label(gl, GL_VERTEX_ARRAY, renderer->vertex_array, "geotex attributes");
    gl->BindVertexArray(0);
    gl->GenBuffers(1, &renderer->picked_buffer);
    gl->GenBuffers(1, &renderer->instance_buffer);
    gl->BindBuffer(GL_ARRAY_BUFFER, renderer->instance_buffer);
    gtx_gl_label(gl, GL_BUFFER, renderer->instance_buffer, "geotex instances");
    gl->BindBuffer(GL_ARRAY_BUFFER, 0);
}

gtx_result gtx_renderer_create(const gtx_renderer_desc *desc, gtx_renderer **out, gtx_error *error)
{
    if (!desc || !desc->load || !out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a renderer needs a loader of OpenGL functions");
    *out = NULL;
    gtx_result result = gtx_check_reserved(desc->reserved, 2, error);
    if (result)
        return result;
    if ((unsigned)desc->tiles > GTX_TILES_ALWAYS)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the renderer asks for an unknown tiling");
    const gtx_allocator hooks = gtx_allocator_or_default(desc->allocator);
    gtx_renderer *renderer = gtx_alloc_array(&hooks, 1, sizeof *renderer);
    if (!renderer)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a renderer");
    renderer->allocator = hooks;
    renderer->compress = desc->compress;
    renderer->jobs = desc->jobs ? *desc->jobs : (gtx_jobs){0};
    renderer->log = desc->log;
    renderer->log_user = desc->log_user;
    result = gtx_planner_init(&renderer->planner, &hooks, &desc->costs, error);
    if (!result)
        result = gtx_gl_init(&renderer->gl, desc, error);
    if (result) { /* no function may be called */
        gtx_free_array(&hooks, renderer, 1, sizeof *renderer);
        return result;
    }
    renderer->planner.on_gpu = !gtx_gl_is_software(&renderer->gl);
    gtx_tile_stream_create(renderer);
    gtx_grid_stream_create(renderer);
    result = gtx_programs_create(renderer, error);
    if (result) {
        gtx_renderer_destroy(renderer);
        return result;
    }
    create_shared(renderer);
    log_context(renderer);
    *out = renderer;
    return GTX_OK;
}

gtx_compression gtx_renderer_compression(const gtx_renderer *renderer)
{
    return !renderer                                 ? GTX_COMPRESS_NONE
           : renderer->gl.reads[GTX_COMPRESS_BC]   ? GTX_COMPRESS_BC
           : renderer->gl.reads[GTX_COMPRESS_ETC2] ? GTX_COMPRESS_ETC2
                                                     : GTX_COMPRESS_NONE;
}

void gtx_renderer_destroy(gtx_renderer *renderer)
{
    if (!renderer)
        return;
    gtx_programs_destroy(renderer);
    gtx_tile_stream_destroy(renderer);
    gtx_grid_stream_destroy(renderer);
    gtx_block_stream_destroy(renderer);
    renderer->gl.DeleteVertexArrays(1, &renderer->vertex_array);
    renderer->gl.DeleteBuffers(1, &renderer->picked_buffer);
    renderer->gl.DeleteBuffers(1, &renderer->instance_buffer);
    const gtx_allocator hooks = renderer->allocator;
    gtx_planner_free(&renderer->planner);
    gtx_free_array(&hooks, renderer, 1, sizeof *renderer);
}
