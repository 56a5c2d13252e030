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
    EGLenum api;
};

gtx_host_proc gtx_offscreen_load(const char *name, void *user)
{
    (void)user;
    return (gtx_host_proc)eglGetProcAddress(name);
}

/* What distinguishes contexts of OpenGL from those of OpenGL ES; versions from the highest down. */
typedef struct client_api {
    EGLenum name;
    EGLint renderable;
    int versions[6][2];
    const char *missing;
} client_api;

static const client_api desktop = {EGL_OPENGL_API, EGL_OPENGL_BIT,
                            {{4, 6}, {4, 5}, {4, 3}, {4, 1}, {4, 0}, {3, 3}},
                            "EGL offers no OpenGL 3.3 core context"};
static const client_api embedded = {EGL_OPENGL_ES_API, EGL_OPENGL_ES3_BIT, {{3, 2}, {3, 1}, {3, 0}},
                             "EGL offers no OpenGL ES 3.0 context"};

static EGLContext best_context(EGLDisplay display, EGLConfig config, const client_api *api)
{
    for (int i = 0; i < 6 && api->versions[i][0]; ++i) {
        EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, api->versions[i][0],
                               EGL_CONTEXT_MINOR_VERSION, api->versions[i][1],
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
        if (api == &embedded) /* it has no profiles */
            attributes[4] = EGL_NONE;
        EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
        if (context != EGL_NO_CONTEXT)
            return context;
    }
    return EGL_NO_CONTEXT;
}

/* A current context on `display`, or false with nothing left behind. */
static int try_display(gtx_offscreen *offscreen, EGLDisplay display, const client_api *api)
{
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                             api->renderable, EGL_NONE};
    EGLConfig config = NULL;
    EGLint count = 0;
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL))
        return 0;
    if (eglBindAPI(api->name) &&
        eglChooseConfig(display, wanted, &config, 1, &count) && count > 0) {
        EGLContext context = best_context(display, config, api);
        if (context != EGL_NO_CONTEXT) {
            if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
                offscreen->display = display;
                offscreen->context = context;
                offscreen->api = api->name;
                return 1;
            }
            eglDestroyContext(display, context);
        }
    }
    eglTerminate(display);
    return 0;
}

static int try_all_displays(gtx_offscreen *offscreen, const client_api *api)
{
    PFNEGLGETPLATFORMDISPLAYEXTPROC platform_display =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
    PFNEGLQUERYDEVICESEXTPROC query_devices =
        (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
    EGLDeviceEXT devices[MAX_DEVICES];
    EGLint count = 0;
    if (platform_display && query_devices && query_devices(MAX_DEVICES, devices, &count))
        for (EGLint i = 0; i < count; ++i)
            if (try_display(offscreen, platform_display(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL),
                            api))
                return 1;
    if (platform_display &&
        try_display(offscreen, platform_display(EGL_PLATFORM_SURFACELESS_MESA, NULL, NULL), api))
        return 1;
    return try_display(offscreen, eglGetDisplay(EGL_DEFAULT_DISPLAY), api);
}

static gtx_result create(gtx_offscreen **out, const client_api *api, gtx_error *error)
{
    *out = NULL;
    gtx_offscreen *offscreen = calloc(1, sizeof *offscreen);
    if (!offscreen)
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory");
    if (!try_all_displays(offscreen, api)) {
        free(offscreen);
        return gtx_fail(error, GTX_ERROR_GL, "%s", api->missing);
    }
    *out = offscreen;
    return GTX_OK;
}

gtx_result gtx_offscreen_create(gtx_offscreen **out, gtx_error *error)
{
    return create(out, &desktop, error);
}

gtx_result gtx_offscreen_create_es(gtx_offscreen **out, gtx_error *error)
{
    return create(out, &embedded, error);
}

void gtx_offscreen_destroy(gtx_offscreen *offscreen)
{
    if (!offscreen)
        return;
    eglBindAPI(offscreen->api); /* each has a current context of its own */
    eglMakeCurrent(offscreen->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(offscreen->display, offscreen->context);
    eglTerminate(offscreen->display);
    free(offscreen);
}
