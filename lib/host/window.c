/* A GLFW window with an orbit camera. */
#define GLFW_INCLUDE_NONE
#include "host/window.h"

#include "base/error.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stdlib.h>

struct gtx_window {
    GLFWwindow *glfw;
    gtx_camera *camera;
    double x, y;              /* of the pointer when last seen */
    unsigned char down[128];  /* keys held at the last look */
};

gtx_host_proc gtx_window_load(const char *name, void *user)
{
    (void)user;
    return (gtx_host_proc)glfwGetProcAddress(name);
}

static void on_pointer(GLFWwindow *glfw, double x, double y)
{
    gtx_window *window = glfwGetWindowUserPointer(glfw);
    if (glfwGetMouseButton(glfw, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
        const float degrees_per_pixel = 0.4f;
        gtx_camera *camera = window->camera;
        camera->azimuth -= degrees_per_pixel * (float)(x - window->x);
        camera->elevation += degrees_per_pixel * (float)(y - window->y);
        camera->elevation = fminf(fmaxf(camera->elevation, -89), 89);
    }
    window->x = x;
    window->y = y;
}

static void on_wheel(GLFWwindow *glfw, double x, double y)
{
    gtx_window *window = glfwGetWindowUserPointer(glfw);
    (void)x;
    window->camera->distance *= powf(0.9f, (float)y);
    window->camera->distance = fminf(fmaxf(window->camera->distance, 0.05f), 50);
}

gtx_result gtx_window_create(const char *title, int width, int height, gtx_camera *camera,
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
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS, 24);
    window->glfw = glfwCreateWindow(width, height, title, NULL, NULL);
    window->camera = camera;
    if (!window->glfw) {
        gtx_window_destroy(window);
        return gtx_fail(error, GTX_ERROR_GL, "the display offers no OpenGL 3.3 core context");
    }
    glfwMakeContextCurrent(window->glfw);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window->glfw, window);
    glfwSetCursorPosCallback(window->glfw, on_pointer);
    glfwSetScrollCallback(window->glfw, on_wheel);
    glfwGetCursorPos(window->glfw, &window->x, &window->y);
    *out = window;
    return GTX_OK;
}

void gtx_window_destroy(gtx_window *window)
{
    if (!window)
        return;
    if (window->glfw)
        glfwDestroyWindow(window->glfw);
    glfwTerminate();
    free(window);
}

int gtx_window_next(gtx_window *window, int *width, int *height)
{
    glfwSwapBuffers(window->glfw);
    glfwPollEvents();
    if (glfwGetKey(window->glfw, GLFW_KEY_ESCAPE) == GLFW_PRESS)
        glfwSetWindowShouldClose(window->glfw, GLFW_TRUE);
    glfwGetFramebufferSize(window->glfw, width, height);
    return !glfwWindowShouldClose(window->glfw);
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
    const unsigned char was = window->down[key & 127];
    window->down[key & 127] = glfwGetKey(window->glfw, key) == GLFW_PRESS;
    return window->down[key & 127] && !was;
}
