/* A GLFW window with an OpenGL core context, whose mouse turns an orbit camera. */
#ifndef GTX_HOST_WINDOW_H
#define GTX_HOST_WINDOW_H

#include "host/camera.h"
#include "host/gl.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gtx_window gtx_window;

/* Opens a window and makes its context current. Left drag turns `camera`, the wheel moves it, and
 * Escape closes; the camera must outlive the window.
 * Errors: MEMORY, GL (no display, no 3.3 core). */
gtx_result gtx_window_create(const char *title, int width, int height, gtx_camera *camera,
                             gtx_window **out, gtx_error *error);
void gtx_window_destroy(gtx_window *window);

/* Shows what was drawn and takes input. Returns 0 once the window wants to close; otherwise
 * *width and *height are the framebuffer's size for the next frame. */
int gtx_window_next(gtx_window *window, int *width, int *height);

/* Where the mouse is in clip space: x and y in -1..1 within the window. */
void gtx_window_pointer(const gtx_window *window, float pointer[2]);

/* 1 once after each press of a letter key ('A'..'Z') or digit. */
int gtx_window_pressed(gtx_window *window, char key);

/* Loads by name, for gtx_host_gl_init and gtx_renderer_desc.load. `user` is unused. */
gtx_host_proc gtx_window_load(const char *name, void *user);

#ifdef __cplusplus
}
#endif
#endif
