/* What uploading a model shares with updating it. */
#ifndef GTX_RENDER_UPLOAD_H
#define GTX_RENDER_UPLOAD_H

#include "frame/model.h"
#include "render/gl.h"

/* How the texture of a unit is stored and read. */
typedef struct gtx_texture_kind {
    gl_enum target, inner, format, type, min_filter, mag_filter; /* format: 0 of blocks */
    uint32_t texel_size;
} gtx_texture_kind;
gtx_texture_kind gtx_texture_kind_of(const gtx_model *model, uint32_t unit);
/* Errors: LIMIT, UNSUPPORTED (blocks). */
gtx_result gtx_check_textures(const gtx_gl *gl, const gtx_model *model, gtx_error *error);
void gtx_allocate_textures(const gtx_gl *gl, gtx_model *model);
/* Whether all rows of a level have been uploaded. */
bool gtx_is_complete(const gtx_level *l);
/* Uploads rows of a level until it is done or `*budget` bytes are used up; always at least one. */
void gtx_upload_rows(const gtx_gl *gl, gtx_model *model, gtx_level *l, uint64_t *budget);
/* Binds the renderer's vertex array and returns the host's, to be bound again: index buffers go
 * through the element target, which belongs to vertex arrays; WebGL takes them no other way. */
gl_uint gtx_take_vertex_array(const gtx_renderer *renderer);
/* Leaves no buffer bound. */
void gtx_fill_buffer(const gtx_gl *gl, gl_enum target, gl_uint buffer, uint64_t at, uint64_t size,
                     const void *data);
/* Pixel unpacking as render.h promises to leave it. */
void gtx_default_unpacking(const gtx_gl *gl);
/* Errors: GL (out of memory since the last look). */
gtx_result gtx_check_gl_memory(const gtx_gl *gl, gtx_error *error);

#endif
