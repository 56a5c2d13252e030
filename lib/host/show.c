/* A window with an orbit camera, or one antialiased picture. */
#include "host/show.h"

#include "base/error.h"
#include "host/framebuffer.h"
#include "host/offscreen.h"
#include "host/window.h"

#include <stdlib.h>

static gtx_result draw_frame(const gtx_show *show, const gtx_host_gl *gl, gtx_error *error)
{
    float view[16], projection[16];
    const float aspect = (float)show->width / (float)show->height;
    gtx_camera_matrices(&show->camera, aspect, view, projection);
    return show->draw(gl, view, projection, show->user, error);
}

gtx_result gtx_show_window(gtx_show *show, gtx_error *error)
{
    gtx_host_gl gl;
    gtx_window *window;
    gtx_result result = gtx_window_create(show->title, show->width, show->height, &show->camera,
                                          &window, error);
    if (result)
        return result;
    result = gtx_host_gl_init(&gl, gtx_window_load, NULL, error);
    if (!result)
        result = show->load(&gl, gtx_window_load, show->user, error);
    while (!result && gtx_window_next(window, &show->width, &show->height)) {
        if (gtx_window_pressed(window, GTX_KEY_ESCAPE))
            gtx_window_close(window);
        if (show->width == 0 || show->height == 0)
            continue;
        gtx_window_pointer(window, show->pointer);
        gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
        gl.Viewport(0, 0, show->width, show->height);
        result = draw_frame(show, &gl, error);
    }
    gtx_window_destroy(window);
    return result;
}

/* What is drawn once the context is there. */
static gtx_result draw_still(const gtx_show *show, uint8_t *pixels, gtx_error *error)
{
    enum { SUPERSAMPLE = 2 };
    gtx_host_gl gl;
    gtx_framebuffer target;
    gtx_result result = gtx_host_gl_init(&gl, gtx_offscreen_load, NULL, error);
    if (!result)
        result = show->load(&gl, gtx_offscreen_load, show->user, error);
    if (!result)
        result = gtx_framebuffer_create(&gl, SUPERSAMPLE * show->width, SUPERSAMPLE * show->height,
                                        &target, error);
    if (result)
        return result;
    result = draw_frame(show, &gl, error);
    gtx_framebuffer_read_color(&gl, &target, pixels);
    gtx_average_down(pixels, show->width, show->height, SUPERSAMPLE);
    gtx_framebuffer_destroy(&gl, &target);
    return result;
}

gtx_result gtx_show_still(gtx_show *show, uint8_t **pixels, gtx_error *error)
{
    const int limit = 8192;
    gtx_offscreen *context;
    *pixels = NULL;
    if (show->width < 1 || show->height < 1 || show->width > limit || show->height > limit)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "%d x %d is not within 1..%d", show->width,
                        show->height, limit);
    gtx_result result = gtx_offscreen_create(&context, error);
    if (result)
        return result;
    uint8_t *memory = calloc((size_t)show->width * (size_t)show->height, 16);
    result = memory ? draw_still(show, memory, error)
                    : gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the picture");
    gtx_offscreen_destroy(context);
    if (result)
        free(memory);
    else
        *pixels = memory;
    return result;
}
