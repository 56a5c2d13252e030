/* What is drawn against what the CPU casts, pixel by pixel. */
#ifndef GTX_TESTS_ORACLE_H
#define GTX_TESTS_ORACLE_H

#include "stage.h"

typedef struct agreement {
    long hits, wrong, excluded; /* pixels that the caster hits; that differ; within rounding */
} agreement;

typedef struct oracle {
    const gtx_asset *asset;
    const gtx_caster *caster;
    const gtx_view *view;
    const gtx_instance *instances;
    uint32_t count;
} oracle;

/* Window depth of the nearest hit at window position (x, y), y from the top; 2 for a miss. `texels`
 * and `codes` get what a change of depth by one means on the patch that was hit. */
static inline double oracle_depth(const oracle *o, double x, double y, double *texels,
                                  double *codes)
{
    const int zero_to_one = (o->view->flags & GTX_VIEW_DEPTH_ZERO_TO_ONE) != 0;
    const int reversed = (o->view->flags & GTX_VIEW_REVERSED_Z) != 0;
    double best = 2;
    for (uint32_t i = 0; i < o->count; ++i) {
        const matrix clip = matrix_mul(
            matrix_mul(matrix_of(o->view->projection), matrix_of(o->view->view)),
            matrix_of(o->instances[i].transform));
        const matrix back = matrix_inverse(clip);
        double ends[2][3];
        for (int e = 0; e < 2; ++e) {
            const double z = (e == 0) != reversed ? (zero_to_one ? 0 : -1) : 1;
            const double ndc[3] = {2 * x / STAGE_WIDTH - 1, 1 - 2 * y / STAGE_HEIGHT, z};
            matrix_point(back, ndc, ends[e]);
        }
        gtx_ray ray = {.t_max = 1};
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = (float)ends[0][k];
            ray.direction[k] = (float)(ends[1][k] - ends[0][k]);
        }
        gtx_hit hit;
        assert_int_equal(gtx_raycast(o->caster, &ray, &hit, 1, 0), GTX_OK);
        if (hit.patch == UINT32_MAX)
            continue;
        double window[2];
        for (int e = 0; e < 2; ++e) { /* at the hit, and a little behind it */
            double at[3], ndc[3];
            for (int k = 0; k < 3; ++k)
                at[k] = ray.origin[k] + (hit.t + 1e-5 * e) * (double)ray.direction[k];
            matrix_point(clip, at, ndc);
            window[e] = zero_to_one ? ndc[2] : 0.5 + 0.5 * ndc[2];
        }
        const double nearer = reversed ? 1 - window[0] : window[0];
        if (nearer >= (reversed && best <= 1 ? 1 - best : best))
            continue;
        best = window[0];
        const gtx_patch *patch = &gtx_patches(o->asset)[hit.patch];
        double length = 0, along_z = 0;
        for (int k = 0; k < 3; ++k) {
            length += (double)ray.direction[k] * ray.direction[k];
            along_z += (double)ray.direction[k] * patch->axis_z[k];
        }
        const double change = fabs(window[1] - window[0]) / 1e-5;
        const double pitch =
            fmin(patch->extent_x / patch->rect[2], patch->extent_y / patch->rect[3]);
        *texels = sqrt(length) / pitch / change;
        *codes = fabs(along_z) / patch->extent_z * 254 / change;
    }
    return best;
}

/* A wrong pixel: hit and miss differ, or the hits by more than a height step of 8 bits or 1/8
 * texel. Steps of 16 bits are finer than what 1/256 pixel, to which rasterisers snap, does to a
 * ray. */
static inline int agrees(double expected, double texels, double codes, double drawn, double empty)
{
    if ((expected > 1) != (drawn == empty))
        return 0;
    const double change = fabs(expected - drawn);
    return expected > 1 || (change * texels <= 0.125 && change * codes <= 1);
}

static inline int stage_is_software(const stage *s)
{
    const char *name = (const char *)s->gl.GetString(GL_RENDERER);
    return strstr(name, "llvmpipe") || strstr(name, "softpipe");
}

/* Draws and compares each pixel with the ray through its centre, cast at the view's level. A
 * difference is excluded when a ray less than 1/70 pixel away agrees; on a GPU one pixel in 200 is,
 * for how exactly it interpolates is its own affair (NVIDIA H200: up to 20 of 5,000). */
static inline agreement stage_compare(stage *s, const gtx_asset *asset, const gtx_view *view,
                                      const gtx_instance *instances, uint32_t count)
{
    gtx_caster *caster;
    gtx_error error = {0};
    agreement a = {0, 0, 0};
    const gtx_caster_desc desc = {.level = view->level ? view->level - 1 : 0};
    must(gtx_caster_create(asset, &desc, &caster, &error), &error);
    const oracle o = {asset, caster, view, instances, count};
    const double empty = view->flags & GTX_VIEW_REVERSED_Z ? 0 : 1;
    stage_draw(s, view, instances, count);
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        const double x = i % STAGE_WIDTH + 0.5, y = i / STAGE_WIDTH + 0.5;
        double texels = 0, codes = 0;
        const double expected = oracle_depth(&o, x, y, &texels, &codes);
        a.hits += expected <= 1;
        if (agrees(expected, texels, codes, s->depth[i], empty))
            continue;
        int near = 0;
        for (int k = 0; k < 9 && !near; ++k) {
            const double e = oracle_depth(&o, x + (k % 3 - 1) * 0.01, y + (k / 3 - 1) * 0.01,
                                          &texels, &codes);
            near = agrees(e, texels, codes, s->depth[i], empty);
        }
        a.excluded += near;
        a.wrong += !near;
    }
    gtx_caster_destroy(caster);
    if (!stage_is_software(s) && 200 * a.wrong <= a.hits) {
        a.excluded += a.wrong;
        a.wrong = 0;
    }
    return a;
}

static inline void expect_agreement(stage *s, const subject *shown, const gtx_view *view,
                                    long least_hits)
{
    const agreement a = stage_compare(s, shown->asset, view, &shown->instance, 1);
    if (a.wrong || a.hits < least_hits || a.excluded * 100 > a.hits)
        fail_msg("%ld hits, %ld wrong, %ld excluded", a.hits, a.wrong, a.excluded);
}

#endif
