/* Plans: which proxy each patch of an instance is cast by, if any, and in which order. */
#include "render/plan.h"

#include "base/alloc.h"
#include "base/error.h"
#include "render/renderer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A plane or any other linear function over object space, and how fast it grows. */
typedef struct plane {
    double row[4], slope;
} plane;

/* What is in view, as planes over object space. */
typedef struct frustum {
    plane side[6];            /* inside is above 0; the near one, the far one... */
    plane w;                  /* of clip space */
    double scale;             /* pixels an object unit at w = 1, over the error allowed */
    int32_t level;            /* of all patches; -1: by their errors */
} frustum;

static plane finish(plane p)
{
    p.slope = sqrt(p.row[0] * p.row[0] + p.row[1] * p.row[1] + p.row[2] * p.row[2]);
    return p;
}

/* w + factor * row */
static plane combine(const plane *w, double w_factor, const plane *row, double factor)
{
    plane p;
    for (int k = 0; k < 4; ++k)
        p.row[k] = w_factor * w->row[k] + factor * row->row[k];
    return finish(p);
}

static frustum frustum_of(const gtx_draw_call *draw, const gtx_model *model,
                          const gtx_instance_data *placed)
{
    const gtx_view *view = draw->view;
    const gtx_frame *frame = &draw->frame;
    plane rows[4] = {{{0}, 0}};
    for (int r = 0; r < 4; ++r) {
        for (int k = 0; k < 4; ++k)
            for (int i = 0; i < 3; ++i)
                rows[r].row[k] += (double)frame->clip_from_world[4 * i + r] * placed->world[i][k];
        rows[r].row[3] += frame->clip_from_world[12 + r];
    }
    const plane *w = &rows[3];
    const plane low = combine(w, frame->depth[0], &rows[2], 1), high = combine(w, 1, &rows[2], -1);
    frustum f = {.side = {frame->reversed ? high : low, frame->reversed ? low : high,
                          combine(w, 1, &rows[0], 1), combine(w, 1, &rows[0], -1),
                          combine(w, 1, &rows[1], 1), combine(w, 1, &rows[1], -1)},
                 .w = finish(*w),
                 .scale = frame->detail[0] * gtx_stretch_of(placed),
                 .level = -1};
    const int32_t last = (int32_t)model->mip_count - 1;
    if (view->level > 0)
        f.level = (int32_t)view->level - 1 < last ? (int32_t)view->level - 1 : last;
    else if (view->viewport_height == 0)
        f.level = 0;
    return f;
}

static double at_centre(const plane *p, const float sphere[4])
{
    return p->row[0] * sphere[0] + p->row[1] * sphere[1] + p->row[2] * sphere[2] + p->row[3];
}

/* Object units that are the error allowed, where the sphere is nearest. */
static double allowed_error(const frustum *f, const float sphere[4])
{
    const double nearest = at_centre(&f->w, sphere) - f->w.slope * sphere[3];
    return fmax(nearest, 0) / f->scale;
}

static bool is_before_near(const frustum *f, const float sphere[4])
{
    return at_centre(&f->side[0], sphere) < f->side[0].slope * sphere[3];
}

static bool is_outside(const frustum *f, const float sphere[4])
{
    bool outside = false;
    for (int k = 0; k < 6; ++k)
        outside = outside || at_centre(&f->side[k], sphere) < -f->side[k].slope * sphere[3];
    return outside;
}

/* The coarsest level whose error is allowed. */
static uint32_t level_of(const frustum *f, const gtx_model *model, const gtx_patch_facts *facts)
{
    if (f->level >= 0)
        return (uint32_t)f->level;
    const double allowed = allowed_error(f, facts->sphere);
    uint32_t level = 0;
    while (level + 1 < model->mip_count && facts->error[level + 1] <= allowed)
        ++level;
    return level;
}

gtx_result gtx_plan_reserve(gtx_renderer *renderer, uint32_t patches, gtx_error *error)
{
    gtx_plan *plan = &renderer->plan;
    if (patches <= plan->capacity)
        return GTX_OK;
    gtx_plan_free(renderer);
    plan->capacity = patches;
    plan->counts = gtx_alloc_array(&renderer->allocator, patches, sizeof *plan->counts);
    plan->offsets = gtx_alloc_array(&renderer->allocator, patches, sizeof *plan->offsets);
    plan->entries = gtx_alloc_array(&renderer->allocator, patches, sizeof *plan->entries);
    if (plan->counts && plan->offsets && plan->entries)
        return GTX_OK;
    gtx_plan_free(renderer);
    return gtx_fail(error, GTX_ERROR_MEMORY, "no memory to draw %u patches", patches);
}

void gtx_plan_free(gtx_renderer *renderer)
{
    gtx_plan *plan = &renderer->plan;
    gtx_free_array(&renderer->allocator, plan->counts, plan->capacity, sizeof *plan->counts);
    gtx_free_array(&renderer->allocator, plan->offsets, plan->capacity, sizeof *plan->offsets);
    gtx_free_array(&renderer->allocator, plan->entries, plan->capacity, sizeof *plan->entries);
    *plan = (gtx_plan){0};
}

uint32_t gtx_plan_whole(const gtx_draw_call *draw, const gtx_model *model,
                        const gtx_instance_data *placed)
{
    const frustum f = frustum_of(draw, model, placed);
    if (model->boxed_count || is_before_near(&f, model->sphere))
        return 0;
    if (f.level >= 0)
        return 1 + (uint32_t)f.level;
    return model->coarsest_error <= allowed_error(&f, model->sphere) ? model->mip_count : 0;
}

/* Boxes come first, in order of their levels. */
static int compare(const void *a, const void *b)
{
    const gtx_plan_entry *x = a, *y = b;
    if (x->distance != y->distance)
        return x->distance < y->distance ? -1 : 1;
    return x->slot < y->slot ? -1 : x->slot > y->slot;
}

void gtx_plan_patches(const gtx_draw_call *draw, const gtx_model *model,
                      const gtx_instance_data *placed, bool edited_only)
{
    gtx_plan *plan = &draw->renderer->plan;
    const frustum f = frustum_of(draw, model, placed);
    uint32_t count = 0, boxes = 0;
    memset(plan->box_count, 0, sizeof plan->box_count);
    for (uint32_t i = 0; i < model->patch_count; ++i) {
        const gtx_patch_facts *facts = &model->facts[i];
        if ((edited_only && !model->lods.edited[i]) || is_outside(&f, facts->hull))
            continue;
        const bool box = facts->boxed || is_before_near(&f, facts->hull);
        const uint32_t level = level_of(&f, model, facts);
        const uint32_t slot = (box ? 0 : 1 + level) * model->patch_count + i;
        if (model->first_index[slot] == model->first_index[slot + 1])
            continue;
        const float distance = (float)at_centre(&f.side[0], facts->hull);
        plan->entries[count++] = (gtx_plan_entry){
            box ? (float)level - GTX_MAX_MIPS : fmaxf(distance, 0), slot, i, level};
        boxes += box;
        plan->box_count[level] += box;
    }
    qsort(plan->entries, count, sizeof *plan->entries, compare);
    plan->count = count;
    plan->hull_count = count - boxes;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t first = model->first_index[plan->entries[i].slot];
        plan->counts[i] = (gl_size)(model->first_index[plan->entries[i].slot + 1] - first);
        plan->offsets[i] = (const char *)NULL + first * sizeof(uint32_t);
    }
}
