/* Layers of a chart: what its own triangles cover twice along the axis of projection. */
#pragma once

#include "chart/frame.hpp"

namespace gtx {

/* Two layers at one texel centre: local triangles, and how far apart they are. */
struct DoubleSample {
    uint32_t front, back;
    float depth;
};

struct Layers {
    size_t samples = 0;                 /* texel centres covered */
    size_t doubled = 0;                 /* of those, twice */
    Vector<DoubleSample> folds;         /* the doubled ones that are not noise */
    /* Neighbouring texel centres far apart in depth with no surface between them: a hole opens
     * where the cell that bridges them is cut away. */
    Vector<DoubleSample> discontinuities;
};

/* Depths: `apart` makes two layers, a few of them up to `shallow` are a scan's noise, and a `step`
 * between neighbours is a depth discontinuity. */
struct LayerRule {
    float apart, shallow, step;
};
LayerRule layer_rule(const Surface &surface, double pitch);

/* Depths of triangles, both facings, at the texel centres of a frame. Texels count from a fixed
 * point of the mesh, so that a frame that grows keeps them; the grid begins at texel `first`. */
struct LayerGrid {
    struct Sample {
        float low = INFINITY, high = -INFINITY;
        uint32_t back = 0, front = 0;
    };
    int first[2] = {0, 0}, size[2] = {0, 0};
    Vector<Sample> samples;

    /* The sample at a texel of the frame, NULL outside the grid. */
    const Sample *at(int i, int j) const;
    /* Whether another grid of the same frame reaches out of this one. */
    bool grows_by(const LayerGrid &other) const;
    /* Takes the samples of another grid of the same frame. */
    void add(const LayerGrid &other);
};
LayerGrid make_layer_grid(const Surface &surface, const Region &region, const Frame &frame,
                          double pitch, Task &task);

/* Without `discontinuities` it finds none. */
Layers find_layers(const Surface &surface, const Region &region, const Frame &frame, double pitch,
                   Task &task, bool discontinuities = true);

/* Whether adding one grid to another makes a fold or a depth discontinuity; `doubled` counts the
 * texel centres that would be covered twice and are not yet. */
bool fold_together(const LayerGrid &target, const LayerGrid &added, const LayerRule &rule,
                   size_t &doubled);

} // namespace gtx
