/* Correspondences: texels outside a patch's outline are looked up in its neighbours, by casting
 * along the patch's z, or around the ridge where that hits nothing; from then on they follow the
 * texels found. */
#include "edit/edit.h"

#include "base/alloc.h"
#include "base/error.h"
#include "trace/caster.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far, in texels across the surface, two height fields of one surface may be apart. */
static const double APART = 1.5;
/* Surfaces that are steeper against z than this are looked for no farther. */
static const double STEEP = 0.3;

/* Patches in the order in which a plane along x meets their spheres. */
typedef struct reach {
    float low, high;
    uint32_t patch;
} reach;

static int by_low(const void *a, const void *b)
{
    const reach *p = a, *q = b;
    if (p->low != q->low)
        return p->low < q->low ? -1 : 1;
    return p->patch < q->patch ? -1 : p->patch > q->patch;
}

/* What the search works with. */
typedef struct search {
    gtx_edit *edit;
    gtx_caster *caster;
    reach *reaches;
    float widest;             /* of the reaches */
    uint32_t *near;           /* patches whose spheres meet that of the one at hand */
    uint32_t near_count;
} search;

static void find_near(search *s, uint32_t patch)
{
    const gtx_edit *edit = s->edit;
    const float *ball = edit->source->patches[patch].sphere;
    const float slack = ball[3] + 4 * edit->texel_size, low = ball[0] - slack - s->widest;
    uint32_t first = 0, last = edit->count;
    while (first < last) {
        const uint32_t middle = first + (last - first) / 2;
        if (s->reaches[middle].low < low)
            first = middle + 1;
        else
            last = middle;
    }
    s->near_count = 0;
    for (; first < edit->count && s->reaches[first].low <= ball[0] + slack; ++first) {
        const uint32_t other = s->reaches[first].patch;
        const float *t = edit->source->patches[other].sphere;
        const float r = slack + t[3], x = ball[0] - t[0], y = ball[1] - t[1],
                    z = ball[2] - t[2];
        if (other != patch && x * x + y * y + z * z <= r * r)
            s->near[s->near_count++] = other;
    }
}

/* Where a texel's surface is on a neighbour. */
typedef struct place {
    gtx_crossing at;
    double trim;              /* code there */
} place;

static double trim_at(const gtx_height_field *field, double x, double y)
{
    const uint32_t i = (uint32_t)fmin(fmax(x, 0), field->width - 2);
    const uint32_t j = (uint32_t)fmin(fmax(y, 0), field->height - 2);
    const double u = x - i, v = y - j;
    const uint8_t *row = field->trim + (size_t)j * field->width + i, *next = row + field->width;
    return (1 - v) * ((1 - u) * row[0] + u * row[1]) + v * ((1 - u) * next[0] + u * next[1]);
}

/* The neighbour that is nearest, and in whose outline the texel lies: the two are weighed, for
 * which height field is a little nearer is chance. The texel is at the middle of the ray. */
static place find_owner(const search *s, const gtx_line *ray, double facing)
{
    place best = {.at = {.field = UINT32_MAX}};
    double least = INFINITY;
    for (uint32_t i = 0; i < s->near_count; ++i) {
        gtx_crossing found = {.t = ray->t_max, .field = UINT32_MAX};
        gtx_walk_field(s->caster, s->near[i], ray, false, &found);
        if (found.field == UINT32_MAX)
            continue;
        const double trim = trim_at(&s->caster->fields[found.field], found.x, found.y);
        const double apart = fabs(found.t - ray->t_max / 2) * facing / s->edit->texel_size;
        const double cost = 2 * apart + fmax(gtx_trim_distance(trim), -0.5);
        if (cost >= least)
            continue;
        least = cost;
        best = (place){found, trim};
    }
    return best;
}

static gtx_correspondence make_correspondence(const gtx_edit *edit, uint32_t texel,
                                              const gtx_crossing *at)
{
    const gtx_field_span *other = &edit->fields[at->field];
    const double x = fmax(at->x, 0), y = fmax(at->y, 0);
    const uint32_t last_x = other->width - 2 * GTX_EDIT_MARGIN - 2;
    const uint32_t last_y = other->height - 2 * GTX_EDIT_MARGIN - 2;
    const uint32_t i = x < last_x ? (uint32_t)x : last_x, j = y < last_y ? (uint32_t)y : last_y;
    return (gtx_correspondence){.texel = texel, .patch = at->field,
                      .source = (j + GTX_EDIT_MARGIN) * other->width + i + GTX_EDIT_MARGIN,
                      .u = (float)fmin(x - i, 1), .v = (float)fmin(y - j, 1)};
}

/* Whether the surface that was found looks the same way, as one surface does. */
static bool faces(const search *s, const place *found, const float normal[3])
{
    const gtx_crossing *at = &found->at;
    float n[3];
    gtx_field_normal(&s->caster->fields[at->field], at->x, at->y, n);
    return n[0] * normal[0] + n[1] * normal[1] + n[2] * normal[2] > 0.3f;
}

/* Casts at one texel. One past the coded ones is set down on what is found there. */
static bool find_along_z(const search *s, uint32_t patch, uint32_t texel, gtx_correspondence *out)
{
    gtx_edit *edit = s->edit;
    const gtx_field_span *field = &edit->fields[patch];
    const float *z = edit->source->patches[patch].axis_z;
    const size_t at = field->first + texel;
    const float *n = edit->normal[at];
    double facing = 0;
    for (int k = 0; k < 3; ++k)
        facing += (double)n[k] * z[k];
    const double far = APART * (1 + edit->ring[at]) * edit->texel_size / fmax(facing, STEEP);
    gtx_line ray = {.t_max = 2 * far};
    for (int k = 0; k < 3; ++k) {
        ray.origin[k] = edit->rest[at][k] + far * z[k];
        ray.direction[k] = -z[k];
    }
    const place found = find_owner(s, &ray, facing);
    if (found.at.field == UINT32_MAX || !faces(s, &found, n))
        return false;
    *out = make_correspondence(edit, texel, &found.at);
    if (edit->ring[at]) {
        edit->height[at] += (float)(far - found.at.t);
        for (int k = 0; k < 3; ++k)
            edit->rest[at][k] = (float)(ray.origin[k] + found.at.t * ray.direction[k]);
    }
    return true;
}

/* The crossing of a neighbour near a point, along the neighbour's z. */
static bool project(const search *s, uint32_t patch, const double point[3], place *out)
{
    const float *z = s->edit->source->patches[patch].axis_z;
    const double far = 2 * APART * s->edit->texel_size;
    gtx_line ray = {.t_max = 2 * far};
    for (int k = 0; k < 3; ++k) {
        ray.origin[k] = point[k] + far * z[k];
        ray.direction[k] = -z[k];
    }
    gtx_crossing found = {.t = ray.t_max, .field = UINT32_MAX};
    gtx_walk_field(s->caster, patch, &ray, false, &found);
    if (found.field == UINT32_MAX)
        return false;
    *out = (place){found, trim_at(&s->caster->fields[patch], found.x, found.y)};
    out->at.t -= far; /* above the point */
    return true;
}

/* Turns `v` as the least turn from one unit vector to another does. */
static bool turn(const float from[3], const float to[3], double v[3])
{
    double axis[3], cosine = 0, along = 0;
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        axis[k] = (double)from[a] * to[b] - (double)from[b] * to[a];
        cosine += (double)from[k] * to[k];
        along += axis[k] * v[k];
    }
    if (cosine < -0.9)
        return false;
    double out[3];
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        out[k] = cosine * v[k] + axis[a] * v[b] - axis[b] * v[a] + axis[k] * along / (1 + cosine);
    }
    memcpy(v, out, sizeof out);
    return true;
}

/* The own texel that is nearest in the grid. */
static bool find_own(const gtx_edit *edit, const gtx_field_span *field, uint32_t texel, size_t *out)
{
    const int64_t i = texel % field->width, j = texel / field->width;
    int64_t best = INT64_MAX;
    for (int64_t y = j - GTX_EDIT_MARGIN; y <= j + GTX_EDIT_MARGIN; ++y)
        for (int64_t x = i - GTX_EDIT_MARGIN; x <= i + GTX_EDIT_MARGIN; ++x) {
            if (x < 0 || y < 0 || x >= field->width || y >= field->height)
                continue;
            const size_t at = field->first + (size_t)y * field->width + (size_t)x;
            const int64_t square = (x - i) * (x - i) + (y - j) * (y - j);
            if (edit->kind[at] != GTX_TEXEL_OWN || square >= best)
                continue;
            best = square;
            *out = at;
        }
    return best < INT64_MAX;
}

/* Where the step from an own texel to the one at hand leads on a neighbour that goes on at another
 * angle. */
static bool find_around_ridge(const search *s, uint32_t patch, uint32_t texel,
                              gtx_correspondence *out)
{
    const gtx_edit *edit = s->edit;
    const gtx_field_span *field = &edit->fields[patch];
    place best = {.trim = INFINITY};
    size_t own = 0;
    if (!find_own(edit, field, texel, &own))
        return false;
    for (uint32_t i = 0; i < s->near_count; ++i) {
        const uint32_t other = s->near[i];
        const float *z = edit->source->patches[other].axis_z;
        double from[3], step[3];
        float normal[3];
        place start, end;
        for (int k = 0; k < 3; ++k) {
            from[k] = edit->rest[own][k];
            step[k] = (double)edit->rest[field->first + texel][k] - from[k];
        }
        if (!project(s, other, from, &start))
            continue;
        gtx_field_normal(&s->caster->fields[other], start.at.x, start.at.y, normal);
        if (!turn(edit->normal[own], normal, step))
            continue;
        for (int k = 0; k < 3; ++k)
            from[k] += step[k] - start.at.t * z[k];
        if (project(s, other, from, &end) && end.trim < best.trim)
            best = end;
    }
    if (best.trim == INFINITY)
        return false;
    *out = make_correspondence(edit, texel, &best.at);
    return true;
}

static gtx_result find_all(search *s, gtx_error *error)
{
    gtx_edit *edit = s->edit;
    size_t most = 0;
    for (size_t t = 0; t < edit->texels; ++t)
        most += edit->kind[t] == GTX_TEXEL_LOOSE;
    edit->correspondence_count = edit->loose_count = most;
    edit->correspondences = gtx_alloc_array(&edit->allocator, most, sizeof *edit->correspondences);
    edit->loose = gtx_alloc_array(&edit->allocator, most, sizeof *edit->loose);
    if (most && (!edit->correspondences || !edit->loose))
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for %zu borrowed texels", most);
    size_t found = 0, loose = 0;
    for (uint32_t p = 0; p < edit->count; ++p) {
        gtx_field_span *field = &edit->fields[p];
        const uint32_t count = field->width * field->height;
        find_near(s, p);
        field->first_correspondence = found;
        field->first_loose = loose;
        for (uint32_t t = 0; t < count; ++t)
            if (edit->kind[field->first + t] == GTX_TEXEL_LOOSE &&
                (find_along_z(s, p, t, &edit->correspondences[found]) ||
                 find_around_ridge(s, p, t, &edit->correspondences[found]))) {
                edit->kind[field->first + t] = GTX_TEXEL_BORROWED;
                ++found;
            }
        field->correspondence_count = found - field->first_correspondence;
        gtx_edit_order_loose(edit, field);
        loose += field->loose_count;
    }
    return GTX_OK;
}

/* The linear part, with heights in object units. */
static void take_frames(gtx_edit *edit, const gtx_caster *caster)
{
    for (uint32_t p = 0; p < edit->count; ++p) {
        const double step =
            gtx_height_step(&edit->source->patches[p], edit->source->info.height_bits);
        for (int r = 0; r < 3; ++r)
            for (int k = 0; k < 3; ++k)
                edit->fields[p].to_grid[r][k] =
                    caster->fields[p].to_grid[r][k] * (r == 2 ? step : 1);
    }
}

gtx_result gtx_edit_find_correspondences(gtx_edit *edit, gtx_error *error)
{
    const gtx_allocator *hooks = &edit->allocator;
    const gtx_limits all = {.memory = UINT64_MAX, .cells = UINT64_MAX};
    const gtx_caster_desc desc = {.allocator = hooks, .limits = all};
    search s = {.edit = edit};
    gtx_result result = gtx_caster_create(edit->source, &desc, &s.caster, error);
    if (result)
        return result;
    s.reaches = gtx_alloc_array(hooks, edit->count, sizeof *s.reaches);
    s.near = gtx_alloc_array(hooks, edit->count, sizeof *s.near);
    if (s.reaches && s.near) {
        for (uint32_t p = 0; p < edit->count; ++p) {
            const float *ball = edit->source->patches[p].sphere;
            s.reaches[p] = (reach){ball[0] - ball[3], ball[0] + ball[3], p};
            s.widest = fmaxf(s.widest, 2 * ball[3]);
        }
        qsort(s.reaches, edit->count, sizeof *s.reaches, by_low);
        take_frames(edit, s.caster);
        result = find_all(&s, error);
    } else {
        result = gtx_fail(error, GTX_ERROR_MEMORY, "no memory to find neighbours");
    }
    gtx_free_array(hooks, s.reaches, edit->count, sizeof *s.reaches);
    gtx_free_array(hooks, s.near, edit->count, sizeof *s.near);
    gtx_caster_destroy(s.caster);
    return result;
}
