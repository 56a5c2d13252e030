/* Openings of an LOD mesh, through which its inside can be seen: where the eye is behind all of
 * them, what it sees are front faces, and backs need not be drawn.
 *
 * The mesh and a cap on each opening bound a volume. A ray that comes from outside enters before it
 * leaves: through a front face, or through a cap that faces it. None does that to an eye behind all
 * of the rim, as long as the eye's way to it is steeper than the rim itself: else a ray may come in
 * where the rim is low, and meet the back of what stands across. */
#include "frame/frustum.h"

#include "base/alloc.h"

#include <math.h>
#include <string.h>

/* Edges of which a vertex is the lesser end: their number's square is what it takes to look for
 * rims. Only hostile assets have more. */
enum { MAX_AT_VERTEX = 1024 };

typedef struct search {
    const gtx_lod_mesh *source;
    uint32_t *first;          /* edges of the vertices before one, by the lesser of their ends */
    uint32_t *ends;           /* of each edge twice the greater end, and 1 where it comes first */
    uint32_t *piece, *rim;    /* vertices that hang together, of all edges and of those of rims:
                                 each leads to another one, at last to the first of them */
    double *volume;           /* six times that of a piece, at its first vertex */
    double out[GTX_MAX_OPENINGS][3]; /* areas of the openings, as vectors */
    uint32_t of[GTX_MAX_OPENINGS], count; /* the first vertices of their rims */
    bool failed;
} search;

/* Of a rim, along the way out and across it. */
typedef struct rim_extent {
    double out[3], sum[3], least, most, around;
    uint32_t count;
} rim_extent;

static uint32_t first_of(uint32_t *leads, uint32_t v)
{
    while (leads[v] != v)
        v = leads[v] = leads[leads[v]];
    return v;
}

static void join(uint32_t *leads, uint32_t a, uint32_t b)
{
    leads[first_of(leads, a)] = first_of(leads, b);
}

/* Twice the area of a triangle of vertices, as a vector, and six times its volume with the
 * origin. */
static double area_of(const search *s, const uint32_t corner[3], double area[3])
{
    const uint16_t *p[3];
    for (int c = 0; c < 3; ++c)
        p[c] = s->source->positions + 3 * (size_t)corner[c];
    double volume = 0;
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        area[k] = (double)(p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) -
                  (double)(p[1][j] - p[0][j]) * (p[2][i] - p[0][i]);
        volume += area[k] * p[0][k];
    }
    return volume;
}

static void list_edges(search *s)
{
    const gtx_lod_mesh *m = s->source;
    const uint32_t corners = 3 * m->triangle_count;
    for (int fill = 0; fill < 2; ++fill) {
        for (uint32_t c = 0; c < corners; ++c) {
            const uint32_t a = m->indices[c], b = m->indices[c % 3 == 2 ? c - 2 : c + 1];
            const uint32_t low = a < b ? a : b;
            if (!fill)
                ++s->first[low + 1];
            else
                s->ends[--s->first[low + 1]] = 2 * (a + b - low) + (low == b);
        }
        for (uint32_t v = 0; !fill && v < m->vertex_count; ++v)
            s->first[v + 1] += s->first[v];
    }
}

/* A rim is what no triangle beside it has the other way round. Calls with its edges, as those of a
 * cap. */
static void each_rim(search *s, void (*call)(search *s, uint32_t from, uint32_t to))
{
    const gtx_lod_mesh *m = s->source;
    const uint32_t edges = 3 * m->triangle_count;
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        const uint32_t begin = s->first[v + 1];
        const uint32_t end = v + 1 < m->vertex_count ? s->first[v + 2] : edges;
        s->failed |= end - begin > MAX_AT_VERTEX;
        for (uint32_t e = begin; e < end && !s->failed; ++e) {
            const uint32_t other = s->ends[e] / 2;
            int more = 0, before = 0;
            for (uint32_t f = begin; f < end; ++f) {
                const bool same = s->ends[f] / 2 == other;
                more += same ? 1 - 2 * (int)(s->ends[f] & 1) : 0;
                before += same && f < e;
            }
            if (before || other == v)
                continue;
            for (; more > 0; --more)
                call(s, other, v);
            for (; more < 0; ++more)
                call(s, v, other);
        }
    }
}

static void join_rim(search *s, uint32_t from, uint32_t to)
{
    join(s->rim, from, to);
}

static void add_cap(search *s, uint32_t from, uint32_t to)
{
    const uint32_t apex = first_of(s->rim, from);
    uint32_t i = 0;
    while (i < s->count && s->of[i] != apex)
        ++i;
    if (i == GTX_MAX_OPENINGS) {
        s->failed = true;
        return;
    }
    if (i == s->count)
        s->of[s->count++] = apex;
    double area[3];
    s->volume[first_of(s->piece, from)] += area_of(s, (uint32_t[3]){apex, from, to}, area);
    for (int k = 0; k < 3; ++k)
        s->out[i][k] += area[k];
}

/* Each piece must have its inside within: what is turned inside out shows its backs. */
static bool is_sound(search *s)
{
    const gtx_lod_mesh *m = s->source;
    const uint32_t *corner = m->indices, *end = corner + 3 * (size_t)m->triangle_count;
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        s->piece[v] = s->rim[v] = v;
    for (; corner < end; corner += 3) {
        join(s->piece, corner[0], corner[1]);
        join(s->piece, corner[0], corner[2]);
    }
    for (corner = m->indices; corner < end; corner += 3) {
        double area[3];
        s->volume[first_of(s->piece, *corner)] += area_of(s, corner, area);
    }
    list_edges(s);
    each_rim(s, join_rim);
    each_rim(s, add_cap);
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        s->failed |= s->volume[v] < 0;
    return !s->failed;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Calls with each vertex of an opening's rim, less `from`. */
static void each_place(const search *s, uint32_t opening, const double from[3],
                       void (*call)(rim_extent *e, const double at[3]), rim_extent *e)
{
    const gtx_lod_mesh *m = s->source;
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        if (first_of(s->rim, v) != s->of[opening])
            continue;
        double at[3];
        for (int k = 0; k < 3; ++k)
            at[k] = (double)m->origin[k] +
                    (double)m->step * m->positions[3 * (size_t)v + (size_t)k] - from[k];
        call(e, at);
    }
}

static void add_place(rim_extent *e, const double at[3])
{
    for (int k = 0; k < 3; ++k)
        e->sum[k] += at[k];
    ++e->count;
}

static void add_extent(rim_extent *e, const double at[3])
{
    const double height = dot(e->out, at);
    e->least = fmin(e->least, height);
    e->most = fmax(e->most, height);
    e->around += sqrt(fmax(dot(at, at) - height * height, 0));
}

static void store(const search *s, gtx_lod_meshes *lods)
{
    for (uint32_t i = 0; i < s->count; ++i) {
        gtx_lod_opening *o = &lods->openings[i];
        const double length = sqrt(dot(s->out[i], s->out[i]));
        rim_extent e = {.least = INFINITY, .most = -INFINITY};
        each_place(s, i, (double[3]){0}, add_place, &e);
        for (int k = 0; k < 3; ++k) {
            o->out[k] = e.out[k] = s->out[i][k] / length;
            o->middle[k] = e.sum[k] / e.count;
        }
        each_place(s, i, o->middle, add_extent, &e);
        o->before = -e.least;
        o->steep = e.count * (e.most - e.least) / (2 * e.around);
    }
    lods->opening_count = s->count;
    lods->solid = true;
}

void gtx_lod_find_openings(const gtx_asset *asset, const gtx_allocator *allocator,
                           gtx_lod_meshes *lods)
{
    gtx_lod_mesh m;
    gtx_get_lod_mesh(asset, 0, &m);
    const size_t edges = 3 * (size_t)m.triangle_count;
    search s = {&m,
                gtx_alloc_array(allocator, m.vertex_count + 1, sizeof *s.first),
                gtx_alloc_raw(allocator, edges, sizeof *s.ends),
                gtx_alloc_raw(allocator, m.vertex_count, sizeof *s.piece),
                gtx_alloc_raw(allocator, m.vertex_count, sizeof *s.rim),
                gtx_alloc_array(allocator, m.vertex_count, sizeof *s.volume),
                {{0}}, {0}, 0, false};
    if (s.first && s.ends && s.piece && s.rim && s.volume && is_sound(&s))
        store(&s, lods);
    gtx_free_array(allocator, s.first, m.vertex_count + 1, sizeof *s.first);
    gtx_free_array(allocator, s.ends, edges, sizeof *s.ends);
    gtx_free_array(allocator, s.piece, m.vertex_count, sizeof *s.piece);
    gtx_free_array(allocator, s.rim, m.vertex_count, sizeof *s.rim);
    gtx_free_array(allocator, s.volume, m.vertex_count, sizeof *s.volume);
}

bool gtx_lod_hides_backs(const gtx_lod_meshes *lods, uint32_t level, const gtx_frustum *f)
{
    const double *near = f->side[0].row;
    double least = near[3];   /* of what is before the near plane */
    for (int k = 0; k < 3; ++k)
        least += fmin(near[k] * lods->low[k], near[k] * lods->high[k]);
    bool hidden = lods->solid && !f->two && least > 0;
    for (uint32_t i = 0; i < lods->opening_count; ++i) {
        const gtx_lod_opening *o = &lods->openings[i];
        double way[3];        /* from the eye */
        for (int k = 0; k < 3; ++k)
            way[k] = f->eye[3] * o->middle[k] - f->eye[k];
        const double begins = f->eye[3] * (o->before + (double)lods->levels[level].error);
        hidden = hidden && dot(way, o->out) - begins > o->steep * sqrt(dot(way, way));
    }
    return hidden;
}
