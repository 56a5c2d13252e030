/* A renderer in a context of its own on each of two threads, at once, of one asset: both draw the
 * same. `make config=thread test-threads` runs this under the thread sanitizer. */
#include "bake/shapes.hpp"
#include "host/camera.h"
#include "host/framebuffer.h"
#include "host/offscreen.h"

#include <geotex/cook.h>
#include <geotex/render.h>

#include <algorithm>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

/* Mesa and LLVM are not built with the thread sanitizer, which sees only half of their locks. */
extern "C" __attribute__((visibility("default"))) const char *__tsan_default_suppressions(void);
extern "C" const char *__tsan_default_suppressions(void)
{
    return "race:libEGL_mesa\nrace:swrast_dri\nrace:libLLVM\nrace:llvm::\nmutex:libLLVM\n";
}

static constexpr unsigned THREADS = 2;
static constexpr int SIDE = 48, FRAMES = 3;

static std::atomic<unsigned> arrived{0};

/* All threads wait here for each other: ending one context may end what another stands on. */
static void meet(unsigned times)
{
    for (++arrived; arrived < THREADS * times;)
        std::this_thread::yield();
}

static bool draw(gtx_renderer *renderer, const gtx_host_gl &gl, const gtx_asset *asset,
                 std::vector<uint8_t> &pixels)
{
    gtx_framebuffer framebuffer;
    gtx_model *model = nullptr;
    if (gtx_framebuffer_create(&gl, SIDE, SIDE, &framebuffer, nullptr))
        return false;
    bool good = gtx_model_create(renderer, asset, &model, nullptr) == GTX_OK;
    for (int frame = 0; good && frame < FRAMES; ++frame) {
        gtx_camera camera = {};
        camera.radius = 1.2f;
        camera.azimuth = float(40 * frame);
        camera.distance = 3;
        gtx_view view = {};
        view.method = frame % 2 ? GTX_METHOD_LOD : GTX_METHOD_CAST;
        gtx_camera_matrices(&camera, 1, view.view, view.projection);
        gtx_instance instance = {};
        instance.model = model;
        for (int k = 0; k < 4; ++k)
            instance.transform[5 * k] = 1;
        gl.ClearColor(0, 0, 0, 0);
        gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        good = gtx_draw(renderer, &view, &instance, 1, nullptr) == GTX_OK;
        const size_t before = pixels.size();
        pixels.resize(before + 4 * SIDE * SIDE);
        gtx_framebuffer_read_color(&gl, &framebuffer, &pixels[before]);
    }
    gtx_model_destroy(renderer, model);
    gtx_framebuffer_destroy(&gl, &framebuffer);
    return good;
}

/* What a thread does; a context is made and ended by one after the other. */
static void run(const gtx_asset *asset, std::vector<uint8_t> &pixels, std::atomic<unsigned> &good,
                std::atomic<unsigned> &without)
{
    gtx_offscreen *offscreen = nullptr;
    gtx_host_gl gl;
    gtx_renderer *renderer = nullptr;
    gtx_renderer_desc desc = {};
    desc.load = gtx_offscreen_load;
    without += gtx_offscreen_create(&offscreen, nullptr) != GTX_OK;
    meet(1);
    if (!without && gtx_host_gl_init(&gl, gtx_offscreen_load, nullptr, nullptr) == GTX_OK &&
        gtx_renderer_create(&desc, &renderer, nullptr) == GTX_OK)
        good += draw(renderer, gl, asset, pixels);
    gtx_renderer_destroy(renderer);
    meet(2);
    gtx_offscreen_destroy(offscreen);
}

static void two_renderers_draw_side_by_side(void **)
{
    const gtx::Mesh ball = shapes::ball(6, shapes::bumps);
    std::string text;
    for (const gtx::Vec3d &p : ball.positions)
        text += "v " + std::to_string(p.x) + ' ' + std::to_string(p.y) + ' ' +
                std::to_string(p.z) + '\n';
    for (const auto &t : ball.triangles)
        text += "f " + std::to_string(t[0] + 1) + ' ' + std::to_string(t[1] + 1) + ' ' +
                std::to_string(t[2] + 1) + '\n';
    gtx_cook_desc desc = {};
    desc.resolution = 64;
    desc.lod_levels = 1;
    gtx_asset *asset = nullptr;
    assert_int_equal(gtx_cook_memory(text.data(), text.size(), "ball.obj", &desc, &asset, nullptr,
                                     nullptr), GTX_OK);
    std::vector<uint8_t> pixels[THREADS];
    std::atomic<unsigned> good{0}, without{0};
    std::vector<std::thread> threads;
    for (auto &own : pixels)
        threads.emplace_back([&] { run(asset, own, good, without); });
    for (std::thread &thread : threads)
        thread.join();
    gtx_close(asset);
    if (without)
        skip(); /* no OpenGL here */
    assert_int_equal(good, THREADS);
    assert_true(pixels[0] == pixels[1]);
    assert_true(std::count(pixels[0].begin(), pixels[0].end(), 0) < 4 * SIDE * SIDE * FRAMES);
}

int main()
{
    const CMUnitTest tests[] = {cmocka_unit_test(two_renderers_draw_side_by_side)};
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
