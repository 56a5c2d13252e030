/* A framebuffer of textures: what one pass draws into and another reads. */
#ifndef GTX_HOST_TARGET_H
#define GTX_HOST_TARGET_H

#include "host/gl.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { GTX_TARGET_COLORS = 4 };

typedef struct gtx_target {
    GLuint object, colors[GTX_TARGET_COLORS], depth;
    int width, height;
} gtx_target;

/* Colour textures of the formats given (GL_RGBA8, GL_RGB10_A2, GL_RGBA16F, GL_RGBA32UI; 0 ends the
 * list, which may be NULL) and a depth texture of 32-bit floats, all read texel by texel. Binds it.
 * Errors: GL. */
gtx_result gtx_target_create(const gtx_host_gl *gl, int width, int height, const GLenum *formats,
                             gtx_target *out, gtx_error *error);
void gtx_target_destroy(const gtx_host_gl *gl, gtx_target *target);

/* Makes it, or makes it anew, as large as the viewport is. *bound gets the framebuffer that was
 * bound, and stays so. Errors: GL. */
gtx_result gtx_target_fit(const gtx_host_gl *gl, const GLenum *formats, gtx_target *target,
                          GLuint *bound, gtx_error *error);

/* Binds it, sets the viewport and clears it, depth to 1; the depth test is on, LESS. */
void gtx_target_begin(const gtx_host_gl *gl, const gtx_target *target);

#ifdef __cplusplus
}
#endif
#endif
