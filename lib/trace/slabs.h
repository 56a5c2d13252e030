/* Intersection of a ray with the boxes of a hierarchy. */
#ifndef GTX_TRACE_SLABS_H
#define GTX_TRACE_SLABS_H

#include "trace/caster.h"

#include <math.h>

/* The ray as the hierarchy sees it: in float, and with its time scaled by a power of two so that
 * the direction is about 1 long. */
typedef struct gtx_slabs {
    float before[3], behind[3]; /* the origin, rounded so that it enters early and leaves late */
    float inverse[3];
    double scale;             /* a time of the ray, times this, is a time here */
    float t_min;
} gtx_slabs;

/* What a time is off by at most here, in shares of itself: an upper bound for the three roundings
 * between a plane and its time (Ize, "Robust BVH Ray Traversal", JCGT 2013). */
#define GTX_SLAB_SLACK 5e-7f

static inline float gtx_earlier(float t)
{
    return t - GTX_SLAB_SLACK * fabsf(t);
}

static inline float gtx_later(float t)
{
    return t + GTX_SLAB_SLACK * fabsf(t);
}

static inline gtx_slabs gtx_slabs_of(const gtx_line *ray)
{
    gtx_slabs s;
    int power;
    frexp(fmax(fmax(fabs(ray->direction[0]), fabs(ray->direction[1])), fabs(ray->direction[2])),
          &power);
    s.scale = ldexp(1, power);
    for (int a = 0; a < 3; ++a) {
        const double o = ray->origin[a];
        const float near = (float)o;
        const float high = near < o ? nextafterf(near, INFINITY) : near;
        const float low = near > o ? nextafterf(near, -INFINITY) : near;
        s.inverse[a] = (float)(s.scale / ray->direction[a]);
        s.before[a] = s.inverse[a] < 0 ? low : high;
        s.behind[a] = s.inverse[a] < 0 ? high : low;
    }
    s.t_min = gtx_earlier((float)(ray->t_min * s.scale));
    return s;
}

/* Where the ray enters the box, no later than `limit`; infinity when it misses. */
static inline float gtx_enter(const gtx_node *node, const gtx_slabs *s, float limit)
{
    float t0 = s->t_min, t1 = limit;
    for (int a = 0; a < 3; ++a) {
        const bool back = s->inverse[a] < 0;
        const float first = back ? node->high[a] : node->low[a];
        const float last = back ? node->low[a] : node->high[a];
        const float near = (first - s->before[a]) * s->inverse[a];
        const float far = (last - s->behind[a]) * s->inverse[a];
        t0 = near > t0 ? near : t0; /* false with a NaN, of a ray within the plane */
        t1 = far < t1 ? far : t1;
    }
    return gtx_earlier(t0) <= gtx_later(t1) ? t0 : INFINITY;
}

/* A subtree that the ray enters at t. */
typedef struct gtx_subtree {
    uint32_t node;
    float t;
} gtx_subtree;

/* The latest time here that a crossing may have in order to count before t of the ray. */
static inline float gtx_slabs_limit(const gtx_slabs *s, double t)
{
    return gtx_later((float)(t * s->scale));
}

/* Goes on to the leaf that the ray enters next, no later than `limit`: the nearer child first, the
 * other on the stack. NULL when there is none. `at` begins at the root. */
static inline const gtx_node *gtx_next_leaf(const gtx_node *nodes, const gtx_slabs *s, float limit,
                                            gtx_subtree *at, gtx_subtree *stack, int *size)
{
    for (;;) {
        if (at->t > limit || at->t == INFINITY) {
            if (!*size)
                return NULL;
            *at = stack[--*size];
            continue;
        }
        const gtx_node *node = &nodes[at->node];
        if (node->link & GTX_LEAF) {
            at->t = INFINITY;
            return node;
        }
        const gtx_subtree one = {at->node + 1, gtx_enter(node + 1, s, limit)};
        const gtx_subtree two = {node->link, gtx_enter(&nodes[node->link], s, limit)};
        *at = one.t <= two.t ? one : two;
        if (one.t != INFINITY && two.t != INFINITY)
            stack[(*size)++] = one.t <= two.t ? two : one;
    }
}

#endif
