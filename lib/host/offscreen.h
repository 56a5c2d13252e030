/* An OpenGL core or OpenGL ES context without a window or a display server, through EGL. */
#ifndef GTX_HOST_OFFSCREEN_H
#define GTX_HOST_OFFSCREEN_H

#include "host/gl.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gtx_offscreen gtx_offscreen;

/* Makes the highest core context of at least 3.3 that a device, Mesa's surfaceless platform or the
 * default display offers, and makes it current on this thread. Errors: MEMORY, GL. */
gtx_result gtx_offscreen_create(gtx_offscreen **out, gtx_error *error);
/* The same for OpenGL ES, of at least 3.0. */
gtx_result gtx_offscreen_create_es(gtx_offscreen **out, gtx_error *error);
void gtx_offscreen_destroy(gtx_offscreen *offscreen);

/* Loads by name, for gtx_host_gl_init and gtx_renderer_desc.load. `user` is unused. */
gtx_host_proc gtx_offscreen_load(const char *name, void *user);

#ifdef __cplusplus
}
#endif
#endif
