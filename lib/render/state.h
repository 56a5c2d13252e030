/* The OpenGL state that gtx_draw touches. */
#ifndef GTX_RENDER_STATE_H
#define GTX_RENDER_STATE_H

#include "render/gl.h"
#include "frame/units.h"

#include <stdbool.h>

enum { GTX_MAX_DRAW_BUFFERS = 16 };

typedef struct gtx_state {
    gl_int program, vertex_array, array_buffer, unit;
    gl_int textures[UNIT_CLEARED], arrays[UNIT_CLEARED], samplers[UNIT_CLEARED];
    gl_int depth_func, cull_mode, front_face, draw_buffers;
    gl_bool depth_test, depth_mask, cull;
    gl_bool by_samples;       /* where the context can */
    gl_int stream;            /* where the context casts by tiles */
    gl_bool blend[GTX_MAX_DRAW_BUFFERS], color_mask[GTX_MAX_DRAW_BUFFERS][4];
} gtx_state;

void gtx_state_read(const gtx_gl *gl, gtx_state *state);
void gtx_state_restore(const gtx_gl *gl, const gtx_state *state);
/* The state that render.h promises after a draw. */
void gtx_state_leave(const gtx_gl *gl, bool reversed);

#endif
