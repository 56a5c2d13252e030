/* Lines of equal height on what a picture shows. */
#pragma once

#include "cli/view/scene.hpp"

#include <geotex/view.h>

namespace gtx {

/* Heights are along +Y, in the units of the source: META's vertical exaggeration is taken off. */
struct Contours {
    double step = 0;        /* between two lines, of which every fifth is wider */
    double vertical = 1;    /* exaggeration of the scene's assets */
};

/* Of a scene, with a step of 1, 2 or 5 times a power of ten, for 10 to 25 lines, where it is 0. */
Contours contours_of(const Scene &scene, double step);

/* Blends lines into RGBA, rows from the top, where there is a depth: along the view axis, infinity
 * for none. `view` has the matrices that drew both, with the scene's centre at the origin. They are
 * drawn in the picture, so that they are as wide from near and far, whatever drew the surface. */
void draw_contours(const Contours &contours, const Scene &scene, const gtx_view &view,
                   const Vector<float> &depth, Vector<uint8_t> &color);

} // namespace gtx
