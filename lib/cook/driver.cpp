/* An OpenGL context through EGL: devices first, then Mesa's surfaceless platform. */
#include "cook/driver.hpp"

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

namespace gtx {

#define GTX_EGL(X)                                                                                 \
    X(BindAPI)                                                                                     \
    X(ChooseConfig)                                                                                \
    X(CreateContext)                                                                               \
    X(DestroyContext)                                                                              \
    X(GetCurrentContext)                                                                           \
    X(GetCurrentDisplay)                                                                           \
    X(GetCurrentSurface)                                                                           \
    X(GetProcAddress)                                                                              \
    X(Initialize)                                                                                  \
    X(MakeCurrent)                                                                                 \
    X(QueryAPI)

namespace {

/* The functions of libEGL. It stays loaded, for drivers leave threads and handlers behind. */
struct Egl {
#define GTX_EGL_FIELD(name) decltype(&egl##name) name = nullptr;
    GTX_EGL(GTX_EGL_FIELD)
#undef GTX_EGL_FIELD

    Egl()
    {
        void *library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
        if (!library)
            throw Error(GTX_ERROR_GL, "no OpenGL driver: libEGL.so.1 cannot be loaded");
#define GTX_EGL_LOAD(name)                                                                         \
    name = reinterpret_cast<decltype(name)>(dlsym(library, "egl" #name));                          \
    if (!name)                                                                                     \
        throw Error(GTX_ERROR_GL, "no OpenGL driver: libEGL has no egl" #name);
        GTX_EGL(GTX_EGL_LOAD)
#undef GTX_EGL_LOAD
    }

    template <class Function> Function extension(const char *name) const
    {
        return reinterpret_cast<Function>(GetProcAddress(name));
    }
};

/* What a thread has current. */
struct Held {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLSurface draw = EGL_NO_SURFACE, read = EGL_NO_SURFACE;
    EGLContext context = EGL_NO_CONTEXT;
};

} // namespace

struct Driver::Context {
    Egl egl;
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    Held held; /* of the thread that has acquired the context, which one has at a time */

    Context();
    ~Context() { egl.DestroyContext(display, context); }
    void acquire();
    void release();

private:
    bool make(EGLDisplay on);
};

/* Displays are the process's and not ours to end: others may draw through the same. */
bool Driver::Context::make(EGLDisplay on)
{
    constexpr EGLint WANTED[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                 EGL_OPENGL_BIT, EGL_NONE};
    constexpr EGLint VERSION[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3,
                                  EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                  EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (on == EGL_NO_DISPLAY || !egl.Initialize(on, nullptr, nullptr) ||
        !egl.ChooseConfig(on, WANTED, &config, 1, &count) || count < 1)
        return false;
    EGLContext made = egl.CreateContext(on, config, EGL_NO_CONTEXT, VERSION);
    if (made == EGL_NO_CONTEXT)
        return false;
    display = on;
    context = made;
    return true;
}

Driver::Context::Context()
{
    constexpr EGLint MAX_DEVICES = 16; /* a limit: machines have 1 to 8, and one is taken */
    auto display_of =
        egl.extension<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    auto query_devices = egl.extension<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    const EGLenum api_before = egl.QueryAPI();
    EGLDeviceEXT devices[MAX_DEVICES];
    EGLint count = 0;
    bool made = false;
    if (display_of && egl.BindAPI(EGL_OPENGL_API)) {
        if (query_devices && query_devices(MAX_DEVICES, devices, &count))
            for (EGLint i = 0; i < count && !made; ++i)
                made = make(display_of(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
        if (!made)
            made = make(display_of(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    }
    egl.BindAPI(api_before);
    if (!made)
        throw Error(GTX_ERROR_GL, "no OpenGL driver: EGL offers no 3.3 core context");
}

void Driver::Context::acquire()
{
    held = {egl.GetCurrentDisplay(), egl.GetCurrentSurface(EGL_DRAW),
            egl.GetCurrentSurface(EGL_READ), egl.GetCurrentContext()};
    if (!egl.MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
        throw Error(GTX_ERROR_GL, "EGL cannot make an OpenGL context current on a thread");
}

void Driver::Context::release()
{
    if (held.context == EGL_NO_CONTEXT)
        egl.MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    else
        egl.MakeCurrent(held.display, held.draw, held.read, held.context);
}

Driver::Driver() : context_(std::make_unique<Context>())
{
    Context &c = *context_;
    extractor_ = std::make_unique<Extractor>(
        GlContext{[&c](const char *name) { return c.egl.GetProcAddress(name); },
                  [&c] { c.acquire(); }, [&c] { c.release(); }});
}

Driver::~Driver() = default;

} // namespace gtx
