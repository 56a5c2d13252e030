/* Drawing scenes into images, without a window. */
#pragma once

#include "cli/view/scene_renderer.hpp"
#include "cli/view/vulkan.hpp"
#include "host/framebuffer.h"
#include "host/offscreen.h"

#include <geotex/render.h>

namespace gtx {

struct StillOptions {
    uint32_t width = 1024, height = 768;
    double camera[3] = {30, 20, 2.8}; /* azimuth, elevation in degrees; distance in radii */
    gtx_method method = GTX_METHOD_AUTO;
    uint32_t level = 0;               /* of detail; as gtx_view has it, like the error */
    double max_error = 0;
    bool gles = false;                /* by OpenGL ES */
    bool vulkan = false;              /* by Vulkan: assets alone */
    DebugView debug = DebugView::NONE;
    bool has_light = false;           /* fixed to the scene; else over the camera's shoulder */
    double light[3] = {0, 0, 0.2};    /* azimuth and elevation, and the share of light from
                                         everywhere */
    uint8_t light_color[3] = {255, 255, 255};  /* sRGB; takes its share of all that is seen */
    uint8_t background[4] = {235, 237, 242, 255};
    bool contours = false;            /* lines of equal height; a step of 0 is chosen */
    double contour_step = 0;
    bool legend = false;              /* a line of text, and what colours mean, on the picture */
};

struct Still {
    Vector<uint8_t> color;      /* RGBA, rows from the top */
    Vector<float> depth;        /* along the view axis in object units; infinity = nothing */
};

/* Of a scene from one side. */
struct Shot {
    double camera[3];           /* as in StillOptions */
    std::string label;          /* in the upper left corner; may be empty */
};

/* A context and what it shows. Everything throws Error: GL, SHADER, MEMORY, LIMIT,
 * UNSUPPORTED. */
class Studio {
public:
    explicit Studio(const StillOptions &options);
    /* Shows another scene, which outlives it. */
    void show(const Scene &scene);
    Still draw(const Shot &shot);

private:
    void draw_by_gl(const gtx_view &view, Still &out);
    void draw_by_vulkan(const gtx_view &view, Still &out);
    void tint(Still &still) const;
    void add_text(Still &still, const std::string &label);

    struct Offscreen {
        gtx_offscreen *context = nullptr;
        explicit Offscreen(bool gles);
        Offscreen(const Offscreen &) = delete;
        ~Offscreen();
    };
    const StillOptions options;
    Offscreen offscreen;        /* outlives what it draws with */
    SceneRenderer renderer;
    gtx_framebuffer target;     /* dies with the context */
    const Scene *scene = nullptr;
    std::unique_ptr<VulkanDrawer> vulkan;     /* where options.vulkan */
};

} // namespace gtx
