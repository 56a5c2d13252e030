/* A GLFW window with an orbit camera. */
#define GLFW_INCLUDE_NONE
#include "host/window.h"

#include "base/error.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Files dropped at once come in one list, and leave it one by one. */
struct gtx_window {
    GLFWwindow *glfw;
    gtx_camera *camera;
    double x, y;              /* of the pointer when last seen */
    unsigned char presses[128];
    float scrolled;
    char **dropped;
    int dropped_count, dropped_next;
    int bare;                 /* without a context */
    int minimised;            /* asked for, or seen: not every window manager says so */
};

gtx_host_proc gtx_window_load(const char *name, void *user)
{
    (void)user;
    return (gtx_host_proc)glfwGetProcAddress(name);
}

static void turn(gtx_camera *camera, float dx, float dy)
{
    const float degrees_per_pixel = 0.4f;
    camera->azimuth -= degrees_per_pixel * dx;
    camera->elevation += degrees_per_pixel * dy;
    camera->elevation = fminf(fmaxf(camera->elevation, -89), 89);
}

/* What is as far away as the target follows the pointer. */
static void pan(gtx_camera *camera, float dx, float dy, float window_height)
{
    const float field = (camera->field > 0 ? camera->field : 45) * 3.14159265f / 180;
    const float step = 2 * tanf(field / 2) * camera->distance * camera->radius / window_height;
    float right[3], up[3], back[3];
    gtx_camera_axes(camera, right, up, back);
    for (int k = 0; k < 3; ++k)
        camera->pan[k] += step * (dy * up[k] - dx * right[k]);
}

static int held(GLFWwindow *glfw, int button)
{
    return glfwGetMouseButton(glfw, button) == GLFW_PRESS;
}

static void on_pointer(GLFWwindow *glfw, double x, double y)
{
    gtx_window *window = glfwGetWindowUserPointer(glfw);
    const float dx = (float)(x - window->x), dy = (float)(y - window->y);
    int width, height;
    glfwGetWindowSize(glfw, &width, &height);
    if (held(glfw, GLFW_MOUSE_BUTTON_LEFT))
        turn(window->camera, dx, dy);
    else if (held(glfw, GLFW_MOUSE_BUTTON_RIGHT) || held(glfw, GLFW_MOUSE_BUTTON_MIDDLE))
        pan(window->camera, dx, dy, (float)(height > 0 ? height : 1));
    window->x = x;
    window->y = y;
}

static void on_wheel(GLFWwindow *glfw, double x, double y)
{
    gtx_window *window = glfwGetWindowUserPointer(glfw);
    (void)x;
    if (window->camera->distance <= 0) {
        window->scrolled += (float)y;
        return;
    }
    window->camera->distance *= powf(0.9f, (float)y);
    window->camera->distance = fminf(fmaxf(window->camera->distance, 0.05f), 50);
}

/* Counted, not looked at: a frame may take longer than a key is held. */
static void on_key(GLFWwindow *glfw, int key, int scancode, int action, int modifiers)
{
    gtx_window *window = glfwGetWindowUserPointer(glfw);
    (void)modifiers;
    if (action != GLFW_PRESS)
        return;
    const char *name = key == GLFW_KEY_ESCAPE ? NULL : glfwGetKeyName(key, scancode);
    if (name && name[0] > 0 && !name[1]) /* as the layout has it, where that is ASCII */
        key = name[0] >= 'a' && name[0] <= 'z' ? name[0] - 'a' + 'A' : name[0];
    else if (key == GLFW_KEY_ESCAPE)
        key = GTX_KEY_ESCAPE;
    if (key >= 0 && key < 128)
        ++window->presses[key];
}

static void on_minimised(GLFWwindow *glfw, int minimised)
{
    gtx_window *window = glfwGetWindowUserPointer(glfw);
    window->minimised = minimised;
}

static void forget_dropped(gtx_window *window)
{
    while (window->dropped_next < window->dropped_count)
        free(window->dropped[window->dropped_next++]);
    free(window->dropped);
    window->dropped = NULL;
    window->dropped_count = window->dropped_next = 0;
}

static char *copy(const char *text)
{
    const size_t size = strlen(text) + 1;
    char *out = malloc(size);
    return out ? memcpy(out, text, size) : NULL;
}

/* The last drop counts. */
static void on_drop(GLFWwindow *glfw, int count, const char **paths)
{
    gtx_window *window = glfwGetWindowUserPointer(glfw);
    forget_dropped(window);
    window->dropped = count > 0 ? calloc((size_t)count, sizeof *window->dropped) : NULL;
    for (int i = 0; window->dropped && i < count; ++i)
        window->dropped[window->dropped_count++] = copy(paths[i]);
}

static void ask_for_context(void)
{
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS, 24);
}

static gtx_result create(const char *title, int width, int height, gtx_camera *camera, int bare,
                         gtx_window **out, gtx_error *error)
{
    *out = NULL;
    if (!glfwInit())
        return gtx_fail(error, GTX_ERROR_GL, "no display to open a window on");
    gtx_window *window = calloc(1, sizeof *window);
    if (!window) {
        glfwTerminate();
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory");
    }
    if (bare)
        glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    else
        ask_for_context();
    window->bare = bare;
    window->glfw = glfwCreateWindow(width, height, title, NULL, NULL);
    window->camera = camera;
    if (!window->glfw) {
        gtx_window_destroy(window);
        return gtx_fail(error, GTX_ERROR_GL,
                        bare ? "the display opens no window"
                             : "the display offers no OpenGL 3.3 core context");
    }
    if (!bare) {
        glfwMakeContextCurrent(window->glfw);
        glfwSwapInterval(1);
    }
    glfwSetWindowUserPointer(window->glfw, window);
    glfwSetCursorPosCallback(window->glfw, on_pointer);
    glfwSetScrollCallback(window->glfw, on_wheel);
    glfwSetKeyCallback(window->glfw, on_key);
    glfwSetWindowIconifyCallback(window->glfw, on_minimised);
    glfwSetDropCallback(window->glfw, on_drop);
    glfwGetCursorPos(window->glfw, &window->x, &window->y);
    *out = window;
    return GTX_OK;
}

gtx_result gtx_window_create(const char *title, int width, int height, gtx_camera *camera,
                             gtx_window **out, gtx_error *error)
{
    return create(title, width, height, camera, 0, out, error);
}

gtx_result gtx_window_create_bare(const char *title, int width, int height, gtx_camera *camera,
                                  gtx_window **out, gtx_error *error)
{
    return create(title, width, height, camera, 1, out, error);
}

void *gtx_window_glfw(const gtx_window *window)
{
    return window->glfw;
}

void gtx_window_destroy(gtx_window *window)
{
    if (!window)
        return;
    if (window->glfw)
        glfwDestroyWindow(window->glfw);
    glfwTerminate();
    forget_dropped(window);
    free(window);
}

int gtx_window_next(gtx_window *window, int *width, int *height)
{
    const double patience = 0.05; /* seconds */
    if (!window->bare)
        glfwSwapBuffers(window->glfw);
    if (window->minimised)
        glfwWaitEventsTimeout(patience);
    else
        glfwPollEvents();
    glfwGetFramebufferSize(window->glfw, width, height);
    if (window->minimised)
        *width = *height = 0;
    return !glfwWindowShouldClose(window->glfw);
}

void gtx_window_close(gtx_window *window)
{
    glfwSetWindowShouldClose(window->glfw, GLFW_TRUE);
}

void gtx_window_pointer(const gtx_window *window, float pointer[2])
{
    int width, height;
    glfwGetWindowSize(window->glfw, &width, &height);
    pointer[0] = width > 0 ? 2 * (float)window->x / (float)width - 1 : 0;
    pointer[1] = height > 0 ? 1 - 2 * (float)window->y / (float)height : 0;
}

int gtx_window_pressed(gtx_window *window, char key)
{
    const int presses = window->presses[key & 127];
    window->presses[key & 127] = 0;
    return presses;
}

int gtx_window_held(const gtx_window *window, char key)
{
    if (key != GTX_KEY_SHIFT)
        return glfwGetKey(window->glfw, key) == GLFW_PRESS;
    return glfwGetKey(window->glfw, GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS ||
           glfwGetKey(window->glfw, GLFW_KEY_RIGHT_SHIFT) == GLFW_PRESS;
}

float gtx_window_scrolled(gtx_window *window)
{
    const float steps = window->scrolled;
    window->scrolled = 0;
    return steps;
}

char *gtx_window_dropped(gtx_window *window)
{
    if (window->dropped_next < window->dropped_count)
        return window->dropped[window->dropped_next++];
    forget_dropped(window);
    return NULL;
}

void gtx_window_title(gtx_window *window, const char *title)
{
    glfwSetWindowTitle(window->glfw, title);
}

void gtx_window_resize(gtx_window *window, int width, int height)
{
    glfwSetWindowSize(window->glfw, width, height);
}

void gtx_window_minimise(gtx_window *window, int minimised)
{
    window->minimised = minimised;
    if (minimised)
        glfwIconifyWindow(window->glfw);
    else
        glfwRestoreWindow(window->glfw);
}
