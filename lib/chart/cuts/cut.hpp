/* Charts cut straight into patches: rectangles of their own frames. */
#pragma once

#include "chart/layers.hpp"

namespace gtx {

/* What patches are cut for. */
struct CutPlan {
    size_t patches;       /* wanted number; more where charts are more, or would be too long */
    double pitch;         /* of texels, object units */
    unsigned side;        /* texels, most along a side of a patch, its overlap included */
    unsigned grain;       /* sides become multiples of as many texels */
    unsigned overlap[2];  /* texels that a patch has beyond its core: at a cut, at another side */
    double steps;         /* height codes; relief that they resolve worse than texels costs */
    bool one_density;     /* texels are alike in all patches */
};

/* Cuts the charts of `regions` and `frames`, which fold nowhere. Deterministic for any thread
 * count. */
Vector<Chart> cut_charts(const Surface &surface, Vector<Region> regions,
                         Vector<Frame> frames, const CutPlan &plan, Task &task);

} // namespace gtx
