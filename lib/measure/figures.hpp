/* The figures of one view of assets and their source, pixel by pixel. */
#pragma once

#include "measure/cast.hpp"
#include "measure/measure.hpp"

namespace gtx {

/* Of one view at one level. Sums are made within a view and added up in the order of the views, so
 * that they do not depend on the threads. */
struct Figures {
    uint64_t surface = 0, holes = 0, walls = 0, leaks = 0, both = 0, either = 0;
    /* At level 0 only; the lists until they are added up. */
    uint64_t turned = 0;
    Vector<float> depth, angle;
    double depth_square = 0, angle_sum = 0, color_square = 0;
    Vector<PixelFault> faults;
};

/* Views of one size, and the assets as they are looked at there. */
struct Scene {
    Vector<View> views;
    AssetView asset;
    uint32_t level = 0;
    bool appearance = false;      /* all figures, not holes and silhouettes alone */
    bool list_faults = false;     /* holes and walls are listed, too */
};

/* What all views share. */
struct Comparison {
    const Mesh &mesh;
    Extent extent;
};

/* Adds to `out` what view `view_index` of the scene shows; `image` is the source in it. */
void measure_view(const Comparison &all, const Scene &scene, uint32_t view_index,
                  const MeshImage &image, Figures &out);

} // namespace gtx
