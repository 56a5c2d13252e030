/* EGL contexts without a surface: devices first, then Mesa's surfaceless platform, then the default
 * display. */
#include "host/offscreen.h"

#include "base/error.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdlib.h>

enum { MAX_DEVICES = 16 };

struct gtx_offscreen {
    EGLDisplay display;
    EGLContext context;
};

gtx_host_proc gtx_offscreen_load(const char *name, void *user)
{
    (void)user;
    return (gtx_host_proc)eglGetProcAddress(name);
}

static EGLContext best_context(EGLDisplay display, EGLConfig config)
{
    static const int versions[][2] = {{4, 6}, {4, 5}, {4, 3}, {4, 1}, {4, 0}, {3, 3}};
    for (size_t i = 0; i < sizeof versions / sizeof *versions; ++i) {
        const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     versions[i][0],
                                     EGL_CONTEXT_MINOR_VERSION,
                                     versions[i][1],
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     EGL_NONE};
        EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
        if (context != EGL_NO_CONTEXT)
            return context;
    }
    return EGL_NO_CONTEXT;
}

/* A current context on `display`, or false with nothing left behind. */
static int try_display(gtx_offscreen *offscreen, EGLDisplay display)
{
    static const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                    EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = NULL;
    EGLint count = 0;
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL))
        return 0;
    if (eglBindAPI(EGL_OPENGL_API) &&
        eglChooseConfig(display, wanted, &config, 1, &count) && count > 0) {
        EGLContext context = best_context(display, config);
        if (context != EGL_NO_CONTEXT) {
            if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
                offscreen->display = display;
                offscreen->context = context;
                return 1;
            }
            eglDestroyContext(display, context);
        }
    }
    eglTerminate(display);
    return 0;
}

static int try_all_displays(gtx_offscreen *offscreen)
{
    PFNEGLGETPLATFORMDISPLAYEXTPROC platform_display =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
    PFNEGLQUERYDEVICESEXTPROC query_devices =
        (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
    EGLDeviceEXT devices[MAX_DEVICES];
    EGLint count = 0;
    if (platform_display && query_devices && query_devices(MAX_DEVICES, devices, &count))
        for (EGLint i = 0; i < count; ++i)
            if (try_display(offscreen, platform_display(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL)))
                return 1;
    if (platform_display &&
        try_display(offscreen, platform_display(EGL_PLATFORM_SURFACELESS_MESA, NULL, NULL)))
        return 1;
    return try_display(offscreen, eglGetDisplay(EGL_DEFAULT_DISPLAY));
}

gtx_result gtx_offscreen_create(gtx_offscreen **out, gtx_error *error)
{
    *out = NULL;
    gtx_offscreen *offscreen = calloc(1, sizeof *offscreen);
    if (!offscreen)
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory");
    if (!try_all_displays(offscreen)) {
        free(offscreen);
        return gtx_fail(error, GTX_ERROR_GL, "EGL offers no OpenGL 3.3 core context");
    }
    *out = offscreen;
    return GTX_OK;
}

void gtx_offscreen_destroy(gtx_offscreen *offscreen)
{
    if (!offscreen)
        return;
    eglMakeCurrent(offscreen->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(offscreen->display, offscreen->context);
    eglTerminate(offscreen->display);
    free(offscreen);
}
