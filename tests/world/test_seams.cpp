/* What a stream shows has no hole: from all sides, and to who stands among its tiles; on rough
 * terrain, whose ridges heights do not hold exactly, none that rays do not have. */
#include "worlds.hpp"

#include "host/camera.h"
#include "host/framebuffer.h"
#include "host/offscreen.h"
#include "host/polygons.h"

#include <geotex/stream.h>

#include <cmath>
#include <cstring>

using namespace gtx;

namespace {

constexpr int WIDTH = 480, HEIGHT = 270, PIXELS = WIDTH * HEIGHT;

struct Stage {
    gtx_offscreen *offscreen = nullptr;
    gtx_host_gl gl;
    gtx_framebuffer framebuffer;
    gtx_renderer *renderer = nullptr;
    gtx_polygon_program program;
    bool open();
};

Stage stage;

void no_error(gtx_result result, const gtx_error &error)
{
    if (result)
        fail_msg("%s", error.message);
}

/* Of fragments that are seen from the front the colour is white. */
const char side_text[] =
    "layout(location = 0) out vec4 color;\n"
    "void main()\n"
    "{\n"
    "    color = vec4(gl_FrontFacing ? 1.0 : 0.0);\n"
    "}\n";

bool Stage::open()
{
    gtx_error error;
    gtx_renderer_desc desc = {};
    desc.load = gtx_offscreen_load;
    if (gtx_offscreen_create(&offscreen, &error))
        return false;
    no_error(gtx_host_gl_init(&gl, gtx_offscreen_load, nullptr, &error), error);
    no_error(gtx_framebuffer_create(&gl, WIDTH, HEIGHT, &framebuffer, &error), error);
    no_error(gtx_renderer_create(&desc, &renderer, &error), error);
    no_error(gtx_polygon_program_create_with(&gl, side_text, &program, &error), error);
    return true;
}

/* Distances along the view axis, of what `draw` draws; and what is seen from the front. */
struct Picture {
    Vector<float> depth = Vector<float>(PIXELS);
    Vector<uint8_t> color = Vector<uint8_t>(4 * PIXELS);
    template <class Draw> void take(const gtx_view &view, Draw draw)
    {
        const gtx_host_gl &gl = stage.gl;
        gtx_framebuffer_bind(&gl, &stage.framebuffer);
        gl.DepthMask(GL_TRUE);
        gl.ClearColor(0, 0, 0, 0);
        gl.ClearDepthf(1);
        gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        draw();
        gtx_framebuffer_read_color(&gl, &stage.framebuffer, color.data());
        gtx_framebuffer_read_depth(&gl, &stage.framebuffer, depth.data());
        for (float &d : depth)
            d = d < 1 ? gtx_camera_distance(view.projection, 0, d) : INFINITY;
    }
};

/* A tile in memory, and how it is placed. */
struct Shown {
    gtx_asset *asset = nullptr;
    gtx_instance instance = {};
};

void release(void *payload, void *)
{
    auto *shown = static_cast<Shown *>(payload);
    gtx_model_destroy(stage.renderer, const_cast<gtx_model *>(shown->instance.model));
    gtx_close(shown->asset);
    delete shown;
}

/* A world and its source, on the GPU. */
struct World {
    std::string path;
    Mesh source;
    gtx_polygons polygons;
    gtx_stream *stream = nullptr;
    gtx_stream_frame frame = {};
    uint32_t frames = 0, drawn = 0;  /* pictures, and tiles in them */

    World(const char *name, Mesh mesh, uint32_t triangles, float max_error);
    ~World();
    void answer(const gtx_stream_request &request);
    void update(const gtx_view &view);
    void draw(const gtx_view &view);
};

World::World(const char *name, Mesh mesh, uint32_t triangles, float max_error)
    : path(in_folder(name)), source(std::move(mesh))
{
    PlanOptions options;
    options.models = {path + ".ply"};
    options.folder = path;
    options.triangles = triangles;
    write_file(options.models[0], ply_text(source));
    make_world(options);
    const std::string index = read_file(path + "/tiles.gtw");
    gtx_stream_desc desc = {};
    gtx_error error;
    desc.index = index.data();
    desc.index_size = index.size();
    desc.max_error = max_error;
    desc.release = release;
    no_error(gtx_stream_create(&desc, &stream, &error), error);
    Vector<gtx_polygon_vertex> vertices;
    for (const Vec3d &p : source.positions)
        vertices.push_back({{float(p.x), float(p.y), float(p.z)}, {}, {}, {}});
    const gtx_polygon_data data = {vertices.data(), source.triangles[0].data(),
                                   uint32_t(vertices.size()),
                                   uint32_t(3 * source.triangles.size())};
    no_error(gtx_polygons_create(&stage.gl, &data, &polygons, &error), error);
}

World::~World()
{
    gtx_stream_destroy(stream);
    gtx_polygons_destroy(&stage.gl, &polygons);
}

void World::answer(const gtx_stream_request &request)
{
    const std::string bytes = read_file(path + "/" + request.uri).substr(0, request.bytes);
    auto *shown = new Shown;
    gtx_error error;
    gtx_info info;
    gtx_model *model;
    no_error(gtx_stream_open(&request, bytes.data(), bytes.size(), nullptr, &shown->asset, nullptr,
                             &error), error);
    no_error(gtx_model_create(stage.renderer, shown->asset, &model, &error), error);
    gtx_get_info(shown->asset, &info);
    shown->instance.model = model;
    for (size_t k = 0; k < 4; ++k)
        shown->instance.transform[5 * k] = 1;
    for (size_t k = 0; k < 3; ++k)
        shown->instance.transform[12 + k] = float(info.anchor[k]);
    assert_int_equal(gtx_stream_deliver(stream, request.id, shown, 1, 0), GTX_OK);
}

void World::update(const gtx_view &view)
{
    gtx_stream_view eye = {};
    gtx_error error;
    std::memcpy(eye.view, view.view, sizeof eye.view);
    std::memcpy(eye.projection, view.projection, sizeof eye.projection);
    eye.viewport_height = HEIGHT;
    no_error(gtx_stream_update(stream, &eye, 1, &frame, &error), error);
    for (uint32_t i = 0; i < frame.request_count; ++i)
        answer(frame.requests[i]);
}

void World::draw(const gtx_view &view)
{
    Vector<gtx_instance> instances;
    gtx_error error;
    for (uint32_t i = 0; i < frame.draw_count; ++i)
        instances.push_back(static_cast<const Shown *>(frame.draws[i].payload)->instance);
    no_error(gtx_draw(stage.renderer, &view, instances.data(), frame.draw_count, &error), error);
}


} // namespace

/* Pixels that show what is a tenth deeper than all that the source shows within two of them, where
 * it is seen from the front. */
static size_t holes_in(const Picture &source, const Picture &shown)
{
    constexpr int REACH = 2;
    size_t holes = 0;
    for (int y = REACH; y < HEIGHT - REACH; ++y)
        for (int x = REACH; x < WIDTH - REACH; ++x) {
            float deepest = 0;
            bool front = true;
            for (int b = y - REACH; b <= y + REACH; ++b)
                for (int a = x - REACH; a <= x + REACH; ++a) {
                    const size_t n = size_t(b * WIDTH + a);
                    front = front && source.color[4 * n] == 255;
                    deepest = std::max(deepest, source.depth[n]);
                }
            holes += front && shown.depth[size_t(y * WIDTH + x)] > 1.1f * deepest;
        }
    return holes;
}

static gtx_view view_of(const gtx_camera &camera)
{
    gtx_view view = {};
    gtx_camera_matrices(&camera, float(WIDTH) / HEIGHT, view.view, view.projection);
    view.viewport_width = WIDTH;
    view.viewport_height = HEIGHT;
    return view;
}

/* Of all frames until all is there. */
static size_t look(World &world, const gtx_camera &camera)
{
    const gtx_view view = view_of(camera);
    Picture source, shown;
    source.take(view, [&] {
        stage.gl.Enable(GL_DEPTH_TEST);
        stage.gl.Disable(GL_CULL_FACE);
        gtx_polygons_draw(&stage.gl, &stage.program, &world.polygons, nullptr, &view);
    });
    size_t holes = 0;
    for (bool complete = false; !complete;) {
        world.update(view);
        complete = world.frame.pending == 0;
        if (!world.frame.draw_count)
            continue;
        shown.take(view, [&] { world.draw(view); });
        holes += holes_in(source, shown);
        world.drawn += world.frame.draw_count;
        ++world.frames;
    }
    return holes;
}

static size_t look_around(World &world, gtx_camera camera)
{
    size_t holes = 0;
    camera.distance = 1.6f;
    for (int n = 0; n < 27; ++n) {
        const double x = n % 3 - 1, y = n / 3 % 3 - 1, z = n / 9 - 1;
        camera.azimuth = float(std::atan2(x, z) * 180 / M_PI);
        camera.elevation = float(std::atan2(y, std::hypot(x, z)) * 180 / M_PI);
        holes += n == 13 ? 0 : look(world, camera);
    }
    return holes;
}

/* Pixels that polygons show deeper than rays show anywhere within two, once all tiles are there. */
static size_t compare_methods(World &world, const gtx_camera &camera)
{
    gtx_view view = view_of(camera);
    Picture cast, shown;
    size_t holes = 0;
    do
        world.update(view);
    while (world.frame.pending);
    view.method = GTX_METHOD_CAST;
    cast.take(view, [&] { world.draw(view); });
    for (size_t n = 0; n < cast.depth.size(); ++n)
        cast.color[4 * n] = std::isfinite(cast.depth[n]) ? 255 : 0;
    for (gtx_method method : {GTX_METHOD_AUTO, GTX_METHOD_GRID}) {
        view.method = method;
        shown.take(view, [&] { world.draw(view); });
        holes += holes_in(cast, shown);
    }
    return holes;
}

/* Above vertices of the source, looking along it. */
static size_t stand(World &world, gtx_camera camera, int count,
                    size_t (*see)(World &, const gtx_camera &))
{
    size_t holes = 0;
    for (int n = 0; n < count; ++n) {
        const Vec3d p = world.source.positions[(size_t(n) * 7919 + 100) %
                                               world.source.positions.size()];
        for (size_t k = 0; k < 3; ++k)
            camera.pan[k] = float(p[k]);
        camera.pan[1] += 0.01f * float(1 + n % 3) * camera.radius;
        camera.azimuth = 67.0f * float(n);
        camera.elevation = float(2 + 3 * (n % 5));
        holes += see(world, camera);
    }
    return holes;
}

static void terrain_has_no_hole(void **)
{
    if (!stage.offscreen)
        skip();
    World world("hills", terrain(110), 1200, 1);
    gtx_camera camera = {};
    camera.radius = 1.5f;
    const size_t sides = look_around(world, camera), standing = stand(world, camera, 24, look);
    printf("    %u frames, %.1f tiles a frame: %zu holes from 26 sides, %zu standing\n",
           world.frames, double(world.drawn) / world.frames, sides, standing);
    assert_true(world.drawn > 8 * world.frames);
    assert_int_equal(sides + standing, 0);
}

static void rough_terrain_is_drawn_as_it_is_cast(void **)
{
    if (!stage.offscreen)
        skip();
    World world("rough", rough_terrain(60), 1200, 1);
    gtx_camera camera = {};
    camera.radius = 1.5f;
    const size_t holes = stand(world, camera, 48, compare_methods);
    printf("    %zu holes\n", holes);
    assert_int_equal(holes, 0);
}

static int begin(void **)
{
    stage.open();
    return make_folder(nullptr);
}

static int end(void **)
{
    if (stage.offscreen) {
        gtx_polygon_program_destroy(&stage.gl, &stage.program);
        gtx_renderer_destroy(stage.renderer);
        gtx_framebuffer_destroy(&stage.gl, &stage.framebuffer);
        gtx_offscreen_destroy(stage.offscreen);
    }
    return remove_folder(nullptr);
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(terrain_has_no_hole),
        cmocka_unit_test(rough_terrain_is_drawn_as_it_is_cast),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
