/* A Gaussian over the whole surface: heat flows along it, across the borders of patches.
 *
 * Where heat flows is told by the cotangent weights of the points (Desbrun et al. 1999), so that
 * neither the tilt of a patch's frame nor where it ends matters. Time goes by in
 * Runge-Kutta-Legendre steps (Meyer, Balsara, Aslam 2012), whose s stages go as far as s^2 / 2
 * explicit steps. What is followed is the change, not the position: borrowed texels take it from
 * their owners after every stage and keep their own rounding of where they are. */
#include "edit/edit.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <string.h>

/* The heat kernel of several steps is closer to a Gaussian than that of one. */
enum { STEPS = 6 };
/* Rates, in square texels, beyond which a texel is slowed down: patches of up to three times the
 * usual density are not. */
static const float FASTEST = 36;
/* Stages for each texel of the radius: the fastest rates take 2.5, only what overflows more. */
static const double MAX_STAGES = 3;

/* Neighbours in pairs: k + 4 is opposite to k. */
static const int8_t NEXT[8][2] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                  {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

typedef float rates[8];

typedef struct flow {
    const gtx_edit *edit;
    gtx_change *surface;      /* points and details as they stand; borrowed ones the owners' */
    rates *rate;              /* of each texel's neighbours */
    gtx_change *source;       /* how the surface as it stands would flow */
} flow;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Half the cotangents of a triangle's angles, and a third of its area. */
static void measure_triangle(const flow *f, const size_t corner[3], double half[3], double *third)
{
    double edge[3][3], normal[3]; /* edge k is opposite to corner k */
    for (int k = 0; k < 3; ++k) {
        const float *a = f->surface[corner[(k + 1) % 3]], *b = f->surface[corner[(k + 2) % 3]];
        for (int c = 0; c < 3; ++c)
            edge[k][c] = (double)b[c] - a[c];
    }
    for (int c = 0; c < 3; ++c) {
        const int i = (c + 1) % 3, j = (c + 2) % 3;
        normal[c] = edge[0][i] * edge[1][j] - edge[0][j] * edge[1][i];
    }
    const double twice = sqrt(dot(normal, normal));
    for (int k = 0; k < 3; ++k)
        half[k] = twice > 0 ? -0.5 * dot(edge[(k + 1) % 3], edge[(k + 2) % 3]) / twice : 0;
    *third = twice / 6;
}

/* The two triangles of a cell by corners 0..3 = (0,0), (1,0), (1,1), (0,1), split from 0 to 2 or
 * from 1 to 3, and the directions in NEXT of their edges: of edge k, from corner k + 1 to k + 2. */
static const struct {
    uint8_t corner[3], next[3];
} TRIANGLES[2][2] = {{{{0, 1, 2}, {2, 5, 0}}, {{0, 2, 3}, {4, 6, 1}}},
                     {{{0, 1, 3}, {3, 6, 0}}, {{1, 2, 3}, {4, 7, 2}}}};

static void add_cell(const flow *f, const size_t corner[4], double *mass)
{
    double half[2][2][3], third[2][2], across[2];
    for (int split = 0; split < 2; ++split)
        for (int t = 0; t < 2; ++t) {
            size_t at[3];
            for (int k = 0; k < 3; ++k)
                at[k] = corner[TRIANGLES[split][t].corner[k]];
            measure_triangle(f, at, half[split][t], &third[split][t]);
        }
    /* Of the two diagonals the one that Delaunay has: its weight is not negative. */
    across[0] = half[0][0][1] + half[0][1][2];
    across[1] = half[1][0][0] + half[1][1][1];
    const int split = across[1] > across[0];
    for (int t = 0; t < 2; ++t)
        for (int k = 0; k < 3; ++k) {
            const uint8_t *c = TRIANGLES[split][t].corner, next = TRIANGLES[split][t].next[k];
            f->rate[corner[c[(k + 1) % 3]]][next] += (float)half[split][t][k];
            f->rate[corner[c[(k + 2) % 3]]][(next + 4) % 8] += (float)half[split][t][k];
            mass[corner[c[k]]] += third[split][t];
        }
}

/* The rates of a height field's texels; returns the largest sum of a texel's. `mass` is scratch. */
static float measure_field(const flow *f, const gtx_field_span *field, float most, double *mass)
{
    const gtx_edit *edit = f->edit;
    const uint32_t w = field->width, h = field->height;
    float largest = 0;
    for (uint32_t j = 0; j + 1 < h; ++j)
        for (uint32_t i = 0; i + 1 < w; ++i) {
            const size_t a = field->first + (size_t)j * w + i;
            const size_t corner[4] = {a, a + 1, a + w + 1, a + w};
            if (edit->kind[a] && edit->kind[a + 1] && edit->kind[a + w] && edit->kind[a + w + 1])
                add_cell(f, corner, mass);
        }
    for (size_t t = 0; t < (size_t)w * h; ++t) {
        const size_t at = field->first + t;
        float sum = 0;
        for (int k = 0; k < 8; ++k) {
            float *rate = &f->rate[at][k];
            *rate = *rate > 0 && mass[at] > 0 ? (float)(*rate / mass[at]) : 0;
            sum += *rate;
        }
        if (sum > most) {
            for (int k = 0; k < 8; ++k)
                f->rate[at][k] *= most / sum;
            sum = most;
        }
        if (edit->kind[at] == GTX_TEXEL_OWN && sum > largest)
            largest = sum;
    }
    return largest;
}

/* A stage: out = a * now + b * before + step * (how `now` flows). */
typedef struct stage {
    gtx_change *now, *before, *out;
    float a, b, step;
} stage;

/* For all own texels. */
static void advance(const flow *f, const stage *s)
{
    const gtx_change *now = (const gtx_change *)s->now, *before = (const gtx_change *)s->before;
    const gtx_edit *edit = f->edit;
    for (uint32_t p = 0; p < edit->count; ++p) {
        const gtx_field_span *field = &edit->fields[p];
        const size_t last = field->first + (size_t)field->width * field->height;
        ptrdiff_t next[8];
        for (int k = 0; k < 8; ++k)
            next[k] = NEXT[k][1] * (ptrdiff_t)field->width + NEXT[k][0];
        for (size_t t = field->first; t < last; ++t) {
            if (edit->kind[t] != GTX_TEXEL_OWN) /* these have neighbours all around: the margin */
                continue;
            gtx_change flows;
            memcpy(flows, f->source[t], sizeof flows);
            for (int k = 0; k < 8; ++k) {
                const float rate = f->rate[t][k], *other = now[(ptrdiff_t)t + next[k]];
                for (int c = 0; c < 8; ++c)
                    flows[c] += rate * (other[c] - now[t][c]);
            }
            for (int c = 0; c < 8; ++c)
                s->out[t][c] = s->a * now[t][c] + s->b * before[t][c] + s->step * flows[c];
        }
    }
    gtx_edit_follow(edit, s->out);
}

/* Points and details as they stand. Past a ridge a height field goes straight on, and only the
 * owner knows where its surface is. */
static void gather(const flow *f)
{
    const gtx_edit *edit = f->edit;
    for (int pass = 0; pass < 2; ++pass) {
        for (size_t t = 0; t < edit->texels; ++t) {
            if (pass && edit->kind[t] != GTX_TEXEL_LOOSE)
                continue;
            memcpy(f->surface[t] + GTX_CHANGE_MOVE, edit->point[t], sizeof edit->point[t]);
            memcpy(f->surface[t] + GTX_CHANGE_DETAIL, edit->detail[t], sizeof edit->detail[t]);
        }
        if (!pass)
            gtx_edit_follow(edit, f->surface);
    }
}

/* How the surface as it stands flows. */
static void measure_source(const flow *f)
{
    const gtx_edit *edit = f->edit;
    for (uint32_t p = 0; p < edit->count; ++p) {
        const gtx_field_span *field = &edit->fields[p];
        const size_t last = field->first + (size_t)field->width * field->height;
        for (size_t t = field->first; t < last; ++t)
            for (int k = 0; k < 8 && edit->kind[t] == GTX_TEXEL_OWN; ++k) {
                const ptrdiff_t next = NEXT[k][1] * (ptrdiff_t)field->width + NEXT[k][0];
                for (int c = 0; c < 8; ++c)
                    f->source[t][c] += f->rate[t][k] * (f->surface[(ptrdiff_t)t + next][c] -
                                                        f->surface[t][c]);
            }
    }
}

/* Lets the time of a radius go by, at largest sums of rates `fastest`. `ring` are three arrays of
 * changes, all 0; the result is ring[0]. */
static void run(const flow *f, double radius, float fastest, gtx_change *ring[3])
{
    const double step = radius * radius / 2 / STEPS;
    const double stages = fmin(sqrt(0.25 + 2 * step * fastest) - 0.5,
                               MAX_STAGES * radius / f->edit->texel_size + 1);
    const int count = stages > 1 ? (int)ceil(stages) : 1;
    const double unit = 2 * step / ((double)count * count + count);
    for (int n = 0; n < STEPS; ++n) {
        advance(f, &(stage){ring[0], ring[0], ring[1], 1, 0, (float)unit});
        for (int j = 2; j <= count; ++j) {
            const double a = (2 * j - 1.0) / j, b = (1.0 - j) / j;
            advance(f, &(stage){ring[1], ring[0], ring[2], (float)a, (float)b,
                                (float)(a * unit)});
            gtx_change *oldest = ring[0];
            ring[0] = ring[1];
            ring[1] = ring[2];
            ring[2] = oldest;
        }
        gtx_change *done = ring[1];
        ring[1] = ring[0];
        ring[0] = done;
    }
}

gtx_result gtx_edit_heat_flow(gtx_edit *edit, double radius, gtx_error *error)
{
    const gtx_allocator *hooks = &edit->allocator;
    flow f = {.edit = edit};
    gtx_change *owned[2], *ring[3] = {edit->changes};
    f.rate = gtx_alloc_array(hooks, edit->texels, sizeof *f.rate);
    f.source = gtx_alloc_array(hooks, edit->texels, sizeof *f.source);
    double *mass = gtx_alloc_array(hooks, edit->texels, sizeof *mass);
    bool all = f.rate && f.source && mass;
    for (int k = 0; k < 2; ++k) {
        owned[k] = ring[k + 1] = gtx_alloc_array(hooks, edit->texels, sizeof *owned[k]);
        all = all && owned[k];
    }
    if (all) {
        f.surface = ring[1];
        gather(&f);
        const float most = FASTEST / (edit->texel_size * edit->texel_size);
        float fastest = 0;
        for (uint32_t p = 0; p < edit->count; ++p)
            fastest = fmaxf(fastest, measure_field(&f, &edit->fields[p], most, mass));
        measure_source(&f);
        memset(ring[1], 0, edit->texels * sizeof *ring[1]);
        run(&f, radius, fastest, ring);
        if (ring[0] != edit->changes)
            memcpy(edit->changes, ring[0], edit->texels * sizeof *edit->changes);
    }
    for (int k = 0; k < 2; ++k)
        gtx_free_array(hooks, owned[k], edit->texels, sizeof *owned[k]);
    gtx_free_array(hooks, f.source, edit->texels, sizeof *f.source);
    gtx_free_array(hooks, f.rate, edit->texels, sizeof *f.rate);
    gtx_free_array(hooks, mass, edit->texels, sizeof *mass);
    return all ? GTX_OK : gtx_fail(error, GTX_ERROR_MEMORY, "no memory for a blur");
}
