/* Winding numbers: solid angles of near triangles, and of far ones together by the moments of the
 * nodes of a hierarchy (Barill et al. 2018). */
#include "trace/solid/solid.h"
#include "base/exact.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <string.h>

/* A node is far when it is so many of its radii away (the paper's beta). Sphere and box: within
 * 0.05 at 96 % of points in their bounds; at half at 35 to 60 %, and the box looks open; at 3 at
 * all, in 2.5 times the time. */
static const double FAR = 2;
static const double FULL = 12.566370614359172; /* the whole solid angle, 4 pi */

/* The solid angle of a triangle (Van Oosterom and Strackee 1983). */
static double angle_of(const gtx_element *e, const double point[3])
{
    double v[3][3], length[3];
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k)
            v[i][k] = (double)e->corner[i][k] - point[k];
        length[i] = sqrt(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]);
    }
    double det = 0, dot[3] = {0, 0, 0}; /* dot[i]: of the two corners beside i */
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        det += v[0][k] * (v[1][a] * v[2][b] - v[1][b] * v[2][a]);
        for (int i = 0; i < 3; ++i)
            dot[i] += v[(i + 1) % 3][k] * v[(i + 2) % 3][k];
    }
    const double across = length[0] * length[1] * length[2] + dot[0] * length[0] +
                          dot[1] * length[1] + dot[2] * length[2];
    return 2 * gtx_atan2(det, across);
}

static void add_moments(const gtx_solid_moments *from, gtx_solid_moments *to)
{
    for (int i = 0; i < 3; ++i) {
        to->normal[i] += from->normal[i];
        for (int j = 0; j < 3; ++j)
            to->spread[i][j] +=
                from->spread[i][j] + from->normal[i] * (from->centre[j] - to->centre[j]);
    }
}

/* Those of an element around its own middle, where its spread is none: it is flat. */
static gtx_solid_moments moments_of(const gtx_element *e)
{
    gtx_solid_moments m = {0};
    double square = 0;
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const float *p = e->corner[0], *q = e->corner[1], *r = e->corner[2];
        m.centre[k] = ((double)p[k] + (double)q[k] + (double)r[k]) / 3;
        m.normal[k] = (double)e->weight / 2 *
                      (((double)q[a] - (double)p[a]) * ((double)r[b] - (double)p[b]) -
                       ((double)q[b] - (double)p[b]) * ((double)r[a] - (double)p[a]));
        square += m.normal[k] * m.normal[k];
    }
    m.area = sqrt(square);
    return m;
}

static void add_centre(const gtx_solid_moments *from, gtx_solid_moments *to)
{
    to->area += from->area;
    for (int k = 0; k < 3; ++k)
        to->centre[k] += from->area * from->centre[k];
}

/* Divides the sum of centres, or takes the middle of the box. */
static void end_centre(const gtx_node *node, gtx_solid_moments *m)
{
    double square = 0;
    for (int k = 0; k < 3; ++k) {
        const double low = (double)node->low[k], high = (double)node->high[k];
        m->centre[k] = m->area > 0 ? m->centre[k] / m->area : (low + high) / 2;
        const double far = fmax(m->centre[k] - low, high - m->centre[k]);
        square += far * far;
    }
    m->radius = sqrt(square);
}

static void sum_group(const gtx_solid *solid, const gtx_node *node, gtx_solid_moments *m)
{
    const gtx_group *group = &solid->groups[node->link - GTX_LEAF];
    for (int pass = 0; pass < 2; ++pass) {
        for (uint32_t i = 0; i < group->count; ++i) {
            const gtx_solid_moments one = moments_of(&solid->elements[group->first + i]);
            (pass ? add_moments : add_centre)(&one, m);
        }
        if (!pass)
            end_centre(node, m);
    }
}

gtx_result gtx_winding_build(gtx_solid *solid, gtx_error *error)
{
    const gtx_node *nodes = solid->tree.nodes;
    solid->moments =
        gtx_alloc_array(&solid->allocator, solid->tree.node_count, sizeof *solid->moments);
    if (!solid->moments)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the moments of a solid");
    for (uint32_t n = solid->tree.node_count; n-- > 0;) { /* children come behind */
        gtx_solid_moments *m = &solid->moments[n];
        if (nodes[n].link & GTX_LEAF) {
            sum_group(solid, &nodes[n], m);
            continue;
        }
        const gtx_solid_moments *child[2] = {&solid->moments[n + 1],
                                             &solid->moments[nodes[n].link]};
        add_centre(child[0], m);
        add_centre(child[1], m);
        end_centre(&nodes[n], m);
        add_moments(child[0], m);
        add_moments(child[1], m);
    }
    return GTX_OK;
}

/* The solid angle of all of a node, by the first two terms of its expansion. By the first alone
 * 1 in 18 points is off by 0.05 in the armadillo's bounds; so none is. */
static double angle_from_afar(const gtx_solid_moments *m, const double r[3], double square)
{
    const double distance = sqrt(square), cube = square * distance;
    double first = 0, trace = 0, second = 0;
    for (int i = 0; i < 3; ++i) {
        first += r[i] * m->normal[i];
        trace += m->spread[i][i];
        for (int j = 0; j < 3; ++j)
            second += r[i] * m->spread[i][j] * r[j];
    }
    return (first + trace - 3 * second / square) / cube;
}

double gtx_winding_at(const gtx_solid *solid, const double point[3], uint64_t *steps)
{
    const gtx_node *nodes = solid->tree.nodes;
    double angle = 0;
    for (uint32_t n = 0; n < solid->tree.node_count;) {
        const gtx_solid_moments *m = &solid->moments[n];
        double r[3], square = 0;
        ++*steps;
        for (int k = 0; k < 3; ++k) {
            r[k] = m->centre[k] - point[k];
            square += r[k] * r[k];
        }
        if (square > FAR * FAR * m->radius * m->radius) {
            angle += angle_from_afar(m, r, square);
            n = nodes[n].skip;
            continue;
        }
        if (nodes[n].link & GTX_LEAF) {
            const gtx_group *group = &solid->groups[nodes[n].link - GTX_LEAF];
            *steps += group->count;
            for (uint32_t i = 0; i < group->count; ++i) {
                const gtx_element *e = &solid->elements[group->first + i];
                angle += (double)e->weight * angle_of(e, point);
            }
        }
        ++n;
    }
    return angle / FULL;
}

bool gtx_solid_meets(const gtx_solid *solid, const gtx_box *box)
{
    const gtx_node *nodes = solid->tree.nodes;
    for (uint32_t n = 0; n < solid->tree.node_count;) {
        bool apart = false;
        for (int k = 0; k < 3; ++k)
            apart |= nodes[n].low[k] > box->high[k] || nodes[n].high[k] < box->low[k];
        if (!apart && nodes[n].link & GTX_LEAF)
            return true;
        n = apart ? nodes[n].skip : n + 1;
    }
    return false;
}
