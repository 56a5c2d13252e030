/* Pictures of the LOD mesh and of what is cast, and how they differ. */
#ifndef GTX_TESTS_PICTURES_H
#define GTX_TESTS_PICTURES_H

#include "lods.h"

#include <stdbool.h>

enum { TEXELS = 96 };
static const double radius = 2;

/* With an LOD mesh that always wins where it is fine enough. */
static inline int open_stage(void **state)
{
    const int result = stage_open(state);
    stage *s = *state;
    const gtx_renderer_desc desc = {.load = gtx_offscreen_load, .log = stage_log,
                                    .costs = {0, 0, 1, 1}};
    if (result || !s->offscreen)
        return result;
    gtx_renderer_destroy(s->renderer);
    return gtx_renderer_create(&desc, &s->renderer, NULL);
}

static inline subject sphere_open(stage *s)
{
    return subject_open(s, with_lod(fixture_sphere(radius, TEXELS, 8), radius, LOD_LEVELS, 0));
}

/* How two pictures of the same view differ. */
typedef struct difference {
    long both, either, holes; /* holes: covered a, with all its neighbours, and not b */
    double mean, worst;       /* bytes of colour, over the pixels that both cover */
} difference;

typedef struct picture {
    uint8_t color[4 * STAGE_PIXELS];
    float depth[STAGE_PIXELS];
    float empty;
} picture;

static picture first, second;

/* An engine's own main that shows normals. */
#define NORMALS_MAIN                                                                               \
    "layout(location = 0) out vec4 color;\n"                                                       \
    "void main()\n"                                                                                \
    "{\n"                                                                                          \
    "    gtx_surface s;\n"                                                                         \
    "    if (!gtx_find(s))\n"                                                                      \
    "        discard;\n"                                                                           \
    "    color = vec4(0.5 + 0.5 * gtx_world_normal(s), 1.0);\n"                                    \
    "    gtx_write_depth(s);\n"                                                                    \
    "}\n"

static inline void draw(stage *s, const gtx_view *view, gtx_method method,
                        const gtx_instance *instances, uint32_t count, picture *out)
{
    gtx_view with = *view;
    with.method = method;
    stage_draw(s, &with, instances, count);
    memcpy(out->color, s->color, sizeof s->color);
    memcpy(out->depth, s->depth, sizeof s->depth);
    out->empty = view->flags & GTX_VIEW_REVERSED_Z ? 0 : 1;
}

static inline bool covers(const picture *p, int x, int y)
{
    return x >= 0 && y >= 0 && x < STAGE_WIDTH && y < STAGE_HEIGHT &&
           p->depth[y * STAGE_WIDTH + x] != p->empty;
}

static inline difference compare(const picture *a, const picture *b)
{
    difference d = {0, 0, 0, 0, 0};
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        const int x = i % STAGE_WIDTH, y = i / STAGE_WIDTH;
        const bool in_a = covers(a, x, y), in_b = covers(b, x, y);
        d.either += in_a || in_b;
        if (in_a && !in_b) {
            bool inside = true;
            for (int k = 0; k < 9; ++k)
                inside = inside && covers(a, x + k % 3 - 1, y + k / 3 - 1);
            d.holes += inside;
        }
        if (!in_a || !in_b)
            continue;
        ++d.both;
        for (int k = 0; k < 3; ++k) {
            const double change = fabs((double)a->color[4 * i + k] - b->color[4 * i + k]);
            d.mean += change / 3;
            d.worst = fmax(d.worst, change);
        }
    }
    d.mean /= (double)(d.both ? d.both : 1);
    return d;
}

static inline void expect_alike(const difference *d, double least_iou, double most_mean,
                                double most)
{
    const double iou = (double)d->both / (double)d->either;
    if (d->both < 1500 || iou < least_iou || d->holes || d->mean > most_mean || d->worst > most)
        fail_msg("%ld pixels, IoU %g, %ld holes, colours differ by %g and at most %g", d->both, iou,
                 d->holes, d->mean, d->worst);
}

#endif
