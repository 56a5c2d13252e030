/* Shader programs of hosts, and drawing the whole screen with one. */
#ifndef GTX_HOST_PROGRAM_H
#define GTX_HOST_PROGRAM_H

#include "host/gl.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Texts without #version: of the current context's kind. Those that state no precision of their
 * own, as geotex_dialect.glsl does, get OpenGL ES's highest. Errors: SHADER, with the driver's
 * words. */
gtx_result gtx_host_program_create(const gtx_host_gl *gl, const char *vertex,
                                   const char *fragment, GLuint *out, gtx_error *error);

/* A vertex shader of one triangle that covers the screen: `at` is 0..1 on it. */
extern const char gtx_screen_vertex[];
/* Draws that triangle with the program in use; leaves vertex array 0. */
void gtx_screen_draw(const gtx_host_gl *gl);

/* Sets uniforms of the program in use. */
void gtx_set_matrix(const gtx_host_gl *gl, GLuint program, const char *name, const float value[16]);
void gtx_set_vector(const gtx_host_gl *gl, GLuint program, const char *name, const float value[4]);
/* Binds the 2D texture to the unit that is set as the sampler's; leaves unit 0 active. */
void gtx_set_texture(const gtx_host_gl *gl, GLuint program, const char *name, GLuint unit,
                     GLuint texture);

#ifdef __cplusplus
}
#endif
#endif
