/* A framebuffer object with RGBA8 colour and 32-bit float depth, and reading it back. */
#ifndef GTX_HOST_FRAMEBUFFER_H
#define GTX_HOST_FRAMEBUFFER_H

#include "host/gl.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gtx_framebuffer {
    GLuint object, color, depth;
    int width, height;
} gtx_framebuffer;

/* Creates it, binds it and sets the viewport. Errors: GL. */
gtx_result gtx_framebuffer_create(const gtx_host_gl *gl, int width, int height,
                                  gtx_framebuffer *out, gtx_error *error);
void gtx_framebuffer_destroy(const gtx_host_gl *gl, gtx_framebuffer *framebuffer);

/* Binds it and sets the viewport. */
void gtx_framebuffer_bind(const gtx_host_gl *gl, const gtx_framebuffer *framebuffer);

/* width * height texels, the top row first: 4 bytes of colour, or one float of window depth
 * (which OpenGL ES reads with NV_read_depth alone). */
void gtx_framebuffer_read_color(const gtx_host_gl *gl, const gtx_framebuffer *framebuffer,
                                uint8_t *pixels);
void gtx_framebuffer_read_depth(const gtx_host_gl *gl, const gtx_framebuffer *framebuffer,
                                float *depth);
/* Writes what was read, changed. Leaves the framebuffer bound. Errors: GL. */
gtx_result gtx_framebuffer_write_color(const gtx_host_gl *gl, const gtx_framebuffer *framebuffer,
                                       const uint8_t *pixels, gtx_error *error);

/* Averages squares of n x n texels, in place: an image drawn n times as large becomes a smooth one
 * of width x height RGBA texels. */
void gtx_average_down(uint8_t *pixels, int width, int height, int n);

#ifdef __cplusplus
}
#endif
#endif
