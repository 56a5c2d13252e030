/* One loop for samples and the command: a window with an orbit camera, or one antialiased picture.
 * */
#ifndef GTX_HOST_SHOW_H
#define GTX_HOST_SHOW_H

#include "host/camera.h"
#include "host/gl.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gtx_show {
    const char *title;
    int width, height;
    gtx_camera camera;
    float pointer[2];         /* of the mouse in clip space, kept up to date in a window */
    /* Both are called with the context current; an error ends the show. `load` is called once. */
    gtx_result (*load)(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error);
    /* Draws into the bound framebuffer, whose viewport is set. */
    gtx_result (*draw)(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error);
    void *user;
} gtx_show;

/* Opens a window and draws until it is closed. Errors: those of gtx_window_create and the calls. */
gtx_result gtx_show_window(gtx_show *show, gtx_error *error);

/* Draws without a window, twice as large and averaged down. *pixels gets width x height RGBA
 * texels, rows from the top, from malloc. Errors: MEMORY, GL, and those of the calls. */
gtx_result gtx_show_still(gtx_show *show, uint8_t **pixels, gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
