/* Drawing a scene into an image, without a window. */
#pragma once

#include "cli/view/scene.hpp"

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
};

struct Still {
    Vector<uint8_t> color;      /* RGBA, rows from the top */
    Vector<float> depth;        /* along the view axis in object units; infinity = nothing */
};

/* Throws Error: GL, SHADER, MEMORY, LIMIT, UNSUPPORTED. */
Still draw_still(const Scene &scene, const StillOptions &options);

} // namespace gtx
