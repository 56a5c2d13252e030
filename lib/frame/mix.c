/* Which patches are drawn by displaced grids and which are cast: by what both are thought to
 * take. */
#include "frame/mix.h"

#include <float.h>
#include <math.h>

gtx_grids_state gtx_grids_state_of(const gtx_grids *g)
{
    gtx_grids_state f = {.vertices = g->vertex_count};
    for (int k = 0; k < GTX_GRID_LOOKS; ++k)
        f.indices[k] = g->index_count[k];
    return f;
}

static void empty_to(gtx_grids *g, const gtx_grids_state *f)
{
    g->vertex_count = f->vertices;
    for (int k = 0; k < GTX_GRID_LOOKS; ++k)
        g->index_count[k] = f->indices[k];
}

uint32_t gtx_triangles_since(const gtx_grids *g, const gtx_grids_state *f)
{
    uint32_t count = 0;
    for (int k = 0; k < GTX_GRID_LOOKS; ++k)
        count += (g->index_count[k] - f->indices[k]) / 3;
    return count;
}

/* Whether the eye is in a sphere. */
static bool is_inside(const gtx_frustum *f, const float sphere[4])
{
    double square = 0;
    for (int k = 0; k < 3; ++k)
        square += pow(f->eye[k] - f->eye[3] * sphere[k], 2);
    return square <= f->eye[3] * f->eye[3] * sphere[3] * sphere[3];
}

/* Blocks are counted behind each other. Of what they cover so much shows, as costs have it that are
 * a fit of random views of a dragon and a bunny. */
static const double nearest_share = 0.6;

/* A patch that is cast among grids takes so many times what it does where all is cast: it hides
 * nothing. Near a dragon 20 views take 5 % more at a third. Those seen from two sides, whose grids
 * draw both, take less: standing on the Andes views take a fifth more at double and a bit. */
static const double among_grids[2] = {3, 0.4};

/* How many patches may be cast, nearest first, without a grid between them, until the rest is, too:
 * entries come nearest first, what is farther has fewer pixels a triangle, and finding triangles
 * that are not drawn takes time. Of 12 views of a bunny those from outside take up to a tenth less
 * than without it; at half, two others take a quarter and two fifths longer. */
static const uint32_t most_given_up = 6;

/* By fragments a patch's box may cover the picture, whatever the patch does; by tiles rays in it
 * start at the eye. Near planes often touch what they show. */
static bool is_beside(const gtx_draw_call *draw, const gtx_frustum *f, const float hull[4])
{
    return gtx_is_before_near(f, hull) && (!gtx_tiles_suit(draw) || is_inside(f, hull));
}

/* The share is less where much lies behind each other: if rays looked at all of it, an engine of
 * 1,150 patches would take twice as long (1280x1024). */
static double cast_cost(const gtx_draw_call *draw, const gtx_model *model, uint32_t patches,
                        double pixels)
{
    return gtx_cast_cost(draw, patches, pixels / (double)model->depth_complexity);
}

/* Pixels of the viewport, where they are known. */
static double viewport_of(const gtx_draw_call *draw)
{
    const gtx_view *view = draw->view;
    const double pixels = (double)view->viewport_width * view->viewport_height;
    return pixels > 0 ? pixels : DBL_MAX;
}

/* Looks at what each patch covers. Returns what casting all would take: more than anything else
 * where that must not be. */
static double cost_of_all(const gtx_draw_call *draw, const gtx_frustum *f, const gtx_model *model,
                          gtx_cover *covers)
{
    const gtx_plan *plan = &draw->planner->plan;
    uint32_t *shown = draw->planner->grids.shown.data;
    const double most = viewport_of(draw);
    double pixels = 0;
    bool beside = false;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const uint32_t patch = plan->entries[i].patch;
        covers[i] = gtx_cover_of(f, model, patch, most, NULL, shown);
        pixels += nearest_share * covers[i].pixels;
        beside = beside || is_beside(draw, f, model->facts[patch].hull);
    }
    return beside ? DBL_MAX : cast_cost(draw, model, plan->count, fmin(pixels, most));
}

/* Triangles of a patch that is halved to an error: each middle ends two on either side. Between
 * what is counted they grow evenly. */
static double triangles_of(const gtx_rtin *rtin, double error)
{
    int exponent = 0;
    const double units = rtin->unit > 0 ? error / (double)rtin->unit : GTX_RTIN_MAX_ERROR;
    const double share = 2 * frexp(fmin(fmax(units, 1), GTX_RTIN_MAX_ERROR), &exponent) - 1;
    const uint32_t *halved = &rtin->halved[exponent - 1];
    return 2 * ((1 - share) * halved[0] + share * halved[1]);
}

/* Pixels that a patch covers toward the eye, as seen from its middle, where w is what it is; below
 * 0 from behind. */
static double pixels_of(const gtx_frustum *f, const gtx_patch_facts *facts, double w)
{
    double toward = 0, square = 0;
    for (int k = 0; k < 3; ++k) {
        const double d = f->eye[k] - f->eye[3] * facts->sphere[k];
        toward += d * facts->area[k];
        square += d * d;
    }
    return f->pixels * f->pixels * toward / (sqrt(square) * w * w);
}

/* Grids that are thought to take so many times what casting does, by sums of each patch, are not
 * looked at. In 12,280 views of a dragon that draw grids it is up to 0.72, in some of a gargoyle
 * more than 1; of 5,184 that do not it is more than 1.3 in half, and from outside about 2: at
 * double that takes ten times as long, at half other views are cast. */
static const double surely_cast = 1.5;

/* Whether casting all is sure to take less. Patches that are not in view as a whole may take
 * nothing. */
static bool is_surely_cast(const gtx_draw_call *draw, const gtx_frustum *f, const gtx_model *model)
{
    const gtx_plan *plan = &draw->planner->plan;
    const double patch_cost = cast_cost(draw, model, 1, 0), pixel = cast_cost(draw, model, 0, 1);
    const double triangle = gtx_grid_cost(draw, 1, 0), of_grid = gtx_grid_cost(draw, 0, 1);
    double pixels = 0, grids = 0;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const uint32_t patch = plan->entries[i].patch;
        const gtx_patch_facts *facts = &model->facts[patch];
        const double w = gtx_plane_at(&f->w, facts->sphere);
        const bool two_sided = model->records[patch][GTX_RECORD_TWO_SIDED][3] > 0;
        if (gtx_is_before_near(f, facts->hull) || w <= 2 * f->w.slope * (double)facts->sphere[3])
            return false;
        const double seen = pixels_of(f, facts, w);
        const double covered = nearest_share * (two_sided ? fabs(seen) : fmax(seen, 0));
        pixels += covered;
        if (covered > 0 && !gtx_is_cut(f, facts->hull))
            grids += fmin(among_grids[two_sided] * (patch_cost + pixel * covered / nearest_share),
                          of_grid * covered + triangle * triangles_of(&model->rtins[patch],
                                                                      w / f->scale));
    }
    return f->level < 0 && grids > surely_cast * (patch_cost * plan->count + pixel * pixels);
}

/* Room for the slots and blocks of any one patch. */
static bool reserve_patch(gtx_planner *planner, const gtx_model *model)
{
    const gtx_plan *plan = &planner->plan;
    gtx_grids *g = &planner->grids;
    size_t nodes = 0, blocks = 0;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const uint32_t patch = plan->entries[i].patch, *slab = &model->first_slab[patch];
        const size_t *node = &model->first_node[patch];
        nodes = node[1] - node[0] > nodes ? node[1] - node[0] : nodes;
        blocks = slab[1] - slab[0] > blocks ? slab[1] - slab[0] : blocks;
    }
    return gtx_scratch_reserve(&planner->allocator, &g->slots, nodes, sizeof(uint32_t)) &&
           gtx_scratch_reserve(&planner->allocator, &g->shown, blocks, sizeof(uint32_t));
}

static uint32_t triangles_in(double room)
{
    return (uint32_t)fmax(0, fmin(room, 1e9));
}

/* So many pixels a triangle pay for finding out what patches hide that are seen from one side. In
 * 16 views inside a dragon's coils, at half a third more triangles are looked at for 2 % fewer that
 * are drawn; at double a fifth more are drawn. What is seen from both sides hides its far side. */
static const double hiding_pixels = 32;

/* Adds what a look found of a patch, and what that hides. False, and nothing is added, if it takes
 * more than `most` triangles, or without memory. */
static bool add(const gtx_draw_call *draw, const gtx_frustum *f, const gtx_model *model,
                uint32_t patch, const gtx_cover *c, uint32_t most)
{
    gtx_planner *planner = draw->planner;
    gtx_grids *grids = &planner->grids;
    const gtx_grids_state before = gtx_grids_state_of(grids);
    if (!gtx_blocks_add(planner, f, model, patch, grids->shown.data, c->blocks, most)) {
        empty_to(grids, &before);
        return false;
    }
    const bool two_sided = model->records[patch][GTX_RECORD_TWO_SIDED][3] > 0;
    if (two_sided || c->pixels >= hiding_pixels * gtx_triangles_since(grids, &before))
        gtx_occlusion_add(&planner->occlusion, model, patch, grids, &before,
                          &planner->allocator);
    return true;
}

/* Finding triangles that are not drawn takes time: it ends once all would take so many times what
 * casting does, if what is behind takes as much a pixel as what is near. Then it takes more, but is
 * hidden. That is told from so many pixels. In 48 random views of a dragon choices are the same at
 * half and double; a third more triangles are found in vain at 1.5 and a 16th, and twice as many
 * at 2 and a 16th. */
static const double hopeless = 1.25, known_share = 1.0 / 64;

/* Grids instead of casting, patch by patch: `covers` has what each covers. False where casting all
 * of them takes no more than what was found. */
static bool mix(const gtx_draw_call *draw, const gtx_frustum *f, const gtx_model *model,
                gtx_cover *covers)
{
    gtx_planner *planner = draw->planner;
    const gtx_plan *plan = &planner->plan;
    gtx_grids *grids = &planner->grids;
    const double most = cost_of_all(draw, f, model, covers), in_view = viewport_of(draw);
    double cost = 0, pixels = 0, seen = 0, all = 0;
    uint32_t given_up = 0;
    bool any = false;
    for (uint32_t i = 0; i < plan->count; ++i)
        all += covers[i].pixels;
    for (uint32_t i = 0; i < plan->count && cost < most; ++i) {
        const uint32_t patch = plan->entries[i].patch;
        const bool must = is_beside(draw, f, model->facts[patch].hull);
        if (seen > known_share * all && cost * all > hopeless * most * seen)
            return false;
        seen += covers[i].pixels;
        /* Without a grid nothing is hidden, and the cover is the one that was found. */
        const bool known = !any && !must && given_up >= most_given_up;
        const gtx_cover c = known ? covers[i]
                                  : gtx_cover_of(f, model, patch, in_view, &planner->occlusion,
                                                 grids->shown.data);
        const bool two_sided = model->records[patch][GTX_RECORD_TWO_SIDED][3] > 0;
        const double cast = among_grids[two_sided] * cast_cost(draw, model, 1, c.pixels);
        const double grid = nearest_share * c.pixels;
        const double empty = gtx_grid_cost(draw, 0, fmin(grid, fmax(in_view - pixels, 0)));
        const double room = (fmin(cast, most - cost) - empty) / gtx_grid_cost(draw, 1, 0);
        const gtx_grids_state before = gtx_grids_state_of(grids);
        covers[i] = c;
        covers[i].grid = !c.blocks;
        if (!c.blocks)
            continue;
        covers[i].grid = (must || given_up < most_given_up) &&
                         add(draw, f, model, patch, &c, must ? UINT32_MAX : triangles_in(room));
        given_up = covers[i].grid ? 0 : given_up + 1;
        any = any || covers[i].grid;
        pixels += covers[i].grid ? grid : 0;
        cost += covers[i].grid ? empty + gtx_grid_cost(draw, gtx_triangles_since(grids, &before), 0)
                               : cast;
    }
    return cost < most;
}

static void all_grids(const gtx_draw_call *draw, const gtx_frustum *f, const gtx_model *model,
                      gtx_cover *covers)
{
    gtx_planner *planner = draw->planner;
    const gtx_plan *plan = &planner->plan;
    for (uint32_t i = 0; i < plan->count; ++i) {
        const uint32_t patch = plan->entries[i].patch;
        covers[i] = gtx_cover_of(f, model, patch, viewport_of(draw), &planner->occlusion,
                                 planner->grids.shown.data);
        covers[i].grid = add(draw, f, model, patch, &covers[i], UINT32_MAX);
    }
}

/* Leaves out what LOD meshes are to draw behind grids. They may stand out by what is allowed. */
static void hide_lods(gtx_planner *planner, const gtx_frustum *f, const gtx_model *model)
{
    gtx_plan *plan = &planner->plan;
    plan->any_lod = false;
    for (uint32_t i = 0; i < model->patch_count; ++i) {
        const float *sphere = model->facts[i].hull;
        if (plan->ways[i] < GTX_BY_LOD)
            continue;
        const double radius = (double)sphere[3] + gtx_allowed_error(f, sphere);
        if (gtx_is_sphere_hidden(&planner->occlusion, sphere, radius))
            plan->ways[i] = GTX_OUT_OF_VIEW;
        else
            plan->any_lod = true;
    }
}

bool gtx_blocks_fill(const gtx_draw_call *draw, const gtx_model *model,
                     const gtx_instance_data *placed)
{
    gtx_planner *planner = draw->planner;
    gtx_plan *plan = &planner->plan;
    gtx_grids *grids = &planner->grids;
    const gtx_frustum f = gtx_frustum_of(draw, model, placed);
    const gtx_grids_state nothing = {.vertices = 0};
    uint32_t left = 0;
    gtx_cover *covers = gtx_scratch_reserve(&planner->allocator, &grids->covers, plan->count,
                                            sizeof *covers);
    empty_to(grids, &nothing);
    if (f.two || !covers || !plan->count || !reserve_patch(planner, model))
        return false; /* blocks are culled for one eye */
    if (draw->view->method != GTX_METHOD_GRID && is_surely_cast(draw, &f, model))
        return false;
    gtx_occlusion_begin(&planner->occlusion, draw, model, placed);
    if (draw->view->method == GTX_METHOD_GRID) {
        all_grids(draw, &f, model, covers);
    } else if (!mix(draw, &f, model, covers)) {
        empty_to(grids, &nothing);
        gtx_occlusion_end(&planner->occlusion);
        return false;
    }
    for (uint32_t i = 0; i < plan->count; ++i)
        if (!covers[i].grid)
            plan->entries[left++] = plan->entries[i];
        else if (!covers[i].blocks)
            plan->ways[plan->entries[i].patch] = GTX_OUT_OF_VIEW;
    plan->count = left;
    if (plan->any_lod)
        hide_lods(planner, &f, model);
    return true;
}

void gtx_grids_free(gtx_grids *grids, const gtx_allocator *allocator)
{
    gtx_scratch_free(allocator, &grids->vertices);
    gtx_scratch_free(allocator, &grids->slots);
    gtx_scratch_free(allocator, &grids->covers);
    gtx_scratch_free(allocator, &grids->shown);
    for (int k = 0; k < GTX_GRID_LOOKS; ++k)
        gtx_scratch_free(allocator, &grids->indices[k]);
    for (int k = 0; k < GTX_BLOCK_LOOKS; ++k)
        gtx_scratch_free(allocator, &grids->blocks[k]);
}
