/* A GLFW window with an OpenGL core context, whose mouse turns an orbit camera. */
#ifndef GTX_HOST_WINDOW_H
#define GTX_HOST_WINDOW_H

#include "host/camera.h"
#include "host/gl.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gtx_window gtx_window;

enum { GTX_KEY_SHIFT = 1, GTX_KEY_ESCAPE = 27 };

/* Opens a window and makes its context current. Left drag turns `camera`, right and middle drag
 * pan it, and the wheel moves it unless its distance is 0; the camera must outlive the window.
 * Errors: MEMORY, GL (no display, no 3.3 core). */
gtx_result gtx_window_create(const char *title, int width, int height, gtx_camera *camera,
                             gtx_window **out, gtx_error *error);
/* The same without a context, for Vulkan. */
gtx_result gtx_window_create_bare(const char *title, int width, int height, gtx_camera *camera,
                                  gtx_window **out, gtx_error *error);
void gtx_window_destroy(gtx_window *window);
/* Its GLFWwindow. */
void *gtx_window_glfw(const gtx_window *window);

/* Shows what was drawn and takes input. Returns 0 once the window wants to close; otherwise
 * *width and *height are the framebuffer's size for the next frame. Both are 0 while the window is
 * minimised: there is nothing to draw, and the call waits a little. */
int gtx_window_next(gtx_window *window, int *width, int *height);

/* Makes the next gtx_window_next return 0. */
void gtx_window_close(gtx_window *window);

/* Where the mouse is in clip space: x and y in -1..1 within the window. */
void gtx_window_pointer(const gtx_window *window, float pointer[2]);

/* The presses of a key since the last call: a letter ('A'..'Z', as the keyboard's layout has it), a
 * digit or GTX_KEY_ESCAPE. */
int gtx_window_pressed(gtx_window *window, char key);

/* Whether a key is held down now: a letter, where a keyboard of the US has it, or GTX_KEY_SHIFT. */
int gtx_window_held(const gtx_window *window, char key);

/* Steps of the wheel, up, that did not move the camera, since the last call: its distance is 0. */
float gtx_window_scrolled(gtx_window *window);

/* A file that was dropped onto the window, in the order dropped, or NULL; freed by the caller. */
char *gtx_window_dropped(gtx_window *window);

void gtx_window_title(gtx_window *window, const char *title);
void gtx_window_resize(gtx_window *window, int width, int height);
/* Minimises the window, or brings it back, as a user would. */
void gtx_window_minimise(gtx_window *window, int minimised);

/* Loads by name, for gtx_host_gl_init and gtx_renderer_desc.load. `user` is unused. */
gtx_host_proc gtx_window_load(const char *name, void *user);

#ifdef __cplusplus
}
#endif
#endif
