/* The making of LOD meshes: shared vertices of the asset become buffers in which each has one
 * patch. */
#include "frame/lod.h"

#include "base/alloc.h"
#include "base/error.h"

#include <string.h>

/* The greatest 16-bit index stays unused, for hosts that have enabled primitive restart. A run's
 * indices are no more than what llvmpipe draws at once. */
enum { MAX_NARROW_VERTICES = 65535, MAX_RUN_TRIANGLES = 4095 / 3 };

/* The latest copy of one of the level's vertices. */
typedef struct gtx_lod_copy {
    uint32_t patch;           /* one more than the patch that it is for */
    uint32_t index;
    bool shared;              /* there was one for another patch */
} gtx_lod_copy;

/* The run of patch order[i], whose first vertex would be `vertex`: a new one where the last is full
 * and where culling changes. */
static gtx_lod_run *run_of(const gtx_lod_meshes *lods, gtx_lod_level *level, uint32_t i,
                           uint32_t vertex)
{
    uint32_t *count = &level->run_count;
    const uint32_t start = *count > 1 ? level->runs[*count - 2].end : 0;
    if (*count == 0 || i == lods->one_sided ||
        level->first[i + 1] - start > MAX_RUN_TRIANGLES)
        level->runs[(*count)++].first_vertex = vertex;
    gtx_lod_run *run = &level->runs[*count - 1];
    run->end = level->first[i + 1];
    return run;
}

static void store_index(const gtx_lod_meshes *lods, const gtx_lod_level *level, uint32_t at,
                        uint32_t index)
{
    uint8_t *out = lods->indices + level->index_offset + (size_t)at * level->index_size;
    const uint16_t narrow = (uint16_t)index;
    memcpy(out, level->index_size == 2 ? (const void *)&narrow : (const void *)&index,
           level->index_size);
}

/* The vertex's copy for a patch, a new one if it has none. */
static gtx_lod_copy *copy_of(gtx_lod_level *level, uint32_t vertex, uint32_t patch, uint32_t *count)
{
    gtx_lod_copy *s = &level->copies[vertex];
    if (s->patch == patch + 1)
        return s;
    s->shared = s->shared || s->patch;
    s->patch = patch + 1;
    s->index = (*count)++;
    return s;
}

/* Counts the copies, one of each vertex for each patch that uses it. */
static uint32_t count_copies(const gtx_lod_meshes *lods, gtx_lod_level *level,
                             const gtx_lod_mesh *source)
{
    uint32_t count = 0;
    memset(level->copies, 0, source->vertex_count * sizeof *level->copies);
    for (uint32_t i = 0; i < lods->patch_count; ++i) {
        const uint32_t patch = lods->order[i], *first = &source->first[patch];
        gtx_lod_run *run = run_of(lods, level, i, count);
        for (uint64_t c = 3 * (uint64_t)first[0]; c < 3 * (uint64_t)first[1]; ++c)
            copy_of(level, source->indices[c], patch, &count);
        run->vertex_count = count - run->first_vertex;
    }
    for (uint32_t v = 0; v < source->vertex_count; ++v)
        level->copies[v].patch = 0;
    return count;
}

static bool is_at_border(const gtx_lod_level *level, const uint32_t *corners)
{
    return level->copies[corners[0]].shared || level->copies[corners[1]].shared ||
           level->copies[corners[2]].shared;
}

/* As it is in the file, 0 where there is none. */
static uint16_t normal_of(const gtx_lod_mesh *source, uint32_t vertex)
{
    const uint8_t *n = source->normals ? source->normals + 2 * (size_t)vertex : NULL;
    return n ? (uint16_t)(n[0] | n[1] << 8) : 0;
}

static void store_vertex(const gtx_lod_meshes *lods, const gtx_lod_level *level, uint32_t at,
                         const gtx_lod_mesh *source, uint32_t vertex, uint32_t patch)
{
    uint8_t *out = lods->vertices + level->vertex_offset + (size_t)at * level->vertex_size;
    const uint16_t *q = source->positions + 3 * (size_t)vertex;
    const gtx_lod_vertex wide = {{q[0], q[1], q[2]}, normal_of(source, vertex), patch};
    const gtx_lod_narrow_vertex narrow = {{q[0], q[1], q[2]}, (uint16_t)patch};
    if (level->vertex_size == sizeof wide)
        memcpy(out, &wide, sizeof wide);
    else
        memcpy(out, &narrow, sizeof narrow);
}

/* Writes copies and indices in drawing order, of each patch the triangles at its border last. */
static void split(const gtx_lod_meshes *lods, gtx_lod_level *level, const gtx_lod_mesh *source)
{
    uint32_t count = 0, met = 0;
    level->run_count = 0;
    for (uint32_t i = 0; i < lods->patch_count; ++i) {
        const uint32_t patch = lods->order[i], *first = &source->first[patch];
        const gtx_lod_run *run = run_of(lods, level, i, count);
        for (int border = 0; border < 2; ++border) {
            level->border[i] = border ? met / 3 : 0;
            for (uint32_t t = first[0]; t < first[1]; ++t) {
                const uint32_t *corners = source->indices + 3 * (size_t)t;
                if (is_at_border(level, corners) != border)
                    continue;
                for (int k = 0; k < 3; ++k) {
                    const uint32_t c = corners[lods->first_provokes ? (k + 2) % 3 : k];
                    const uint32_t before = count;
                    const gtx_lod_copy *s = copy_of(level, c, patch, &count);
                    if (count > before)
                        store_vertex(lods, level, s->index, source, c, patch);
                    store_index(lods, level, met++, s->index - run->first_vertex);
                }
            }
        }
    }
}

/* Patches that are seen from the front alone first: they are drawn with back faces culled. */
static void put_in_order(const gtx_asset *asset, gtx_lod_meshes *out)
{
    uint32_t next = 0;
    for (uint32_t side = 0; side < 2; ++side) {
        for (uint32_t p = 0; p < out->patch_count; ++p)
            if (!(asset->patches[p].flags & GTX_PATCH_TWO_SIDED) == !side)
                out->order[next++] = p;
        if (side == 0)
            out->one_sided = next;
    }
}

/* An asset was checked when it was opened; what is used as an index is checked again. */
static bool is_sound(const gtx_lod_mesh *source, uint32_t patches)
{
    bool sound = source->first[0] == 0 && source->first[patches] == source->triangle_count;
    for (uint32_t p = 0; p < patches; ++p)
        sound = sound && source->first[p] <= source->first[p + 1];
    for (size_t c = 0; sound && c < 3 * (size_t)source->triangle_count; ++c)
        sound = source->indices[c] < source->vertex_count;
    return sound;
}

/* Takes a level's properties from the asset, and allocates what its size is known of. */
static bool begin_level(const gtx_lod_meshes *lods, gtx_lod_level *level,
                        const gtx_lod_mesh *source, const gtx_allocator *hooks)
{
    const uint32_t patches = lods->patch_count;
    memcpy(level->place, source->origin, sizeof source->origin);
    level->place[3] = source->step;
    level->error = source->error;
    level->far = source->flags & GTX_LOD_FAR;
    level->triangle_count = source->triangle_count;
    level->first = gtx_alloc_array(hooks, patches + 1, sizeof *level->first);
    level->border = gtx_alloc_array(hooks, patches, sizeof *level->border);
    level->runs = gtx_alloc_array(hooks, patches, sizeof *level->runs);
    level->source_vertices = source->vertex_count;
    level->copies = gtx_alloc_raw(hooks, source->vertex_count, sizeof *level->copies);
    return level->first && level->border && level->runs && level->copies;
}

bool gtx_lod_begin(const gtx_asset *asset, const gtx_allocator *allocator, gtx_lod_meshes *out)
{
    *out = (gtx_lod_meshes){.level_count = asset->info.lod_levels,
                            .patch_count = asset->info.patch_count};
    if (!out->level_count)
        return true;
    memcpy(out->low, asset->info.bounds_min, sizeof out->low);
    memcpy(out->high, asset->info.bounds_max, sizeof out->high);
    out->order = gtx_alloc_array(allocator, out->patch_count, sizeof *out->order);
    out->edited = gtx_alloc_array(allocator, out->patch_count, sizeof *out->edited);
    if (out->order)
        put_in_order(asset, out);
    return out->order && out->edited;
}

void gtx_lod_measure(const gtx_asset *asset, uint32_t k, const gtx_allocator *allocator,
                     gtx_lod_meshes *out)
{
    gtx_lod_level *level = &out->levels[k];
    gtx_lod_mesh source;
    gtx_get_lod_mesh(asset, k, &source);
    level->result = is_sound(&source, out->patch_count) ? GTX_OK : GTX_ERROR_CORRUPT;
    if (!level->result && !begin_level(out, level, &source, allocator))
        level->result = GTX_ERROR_MEMORY;
    if (level->result)
        return;
    for (uint32_t i = 0; i < out->patch_count; ++i) {
        const uint32_t *of = source.first + out->order[i];
        level->first[i + 1] = level->first[i] + of[1] - of[0];
    }
    const uint32_t count = count_copies(out, level, &source);
    level->index_size = 2;
    for (uint32_t r = 0; r < level->run_count; ++r)
        if (level->runs[r].vertex_count > MAX_NARROW_VERTICES)
            level->index_size = 4;
    level->vertex_size =
        gtx_lod_may_be_lit(asset, k, out) || out->patch_count > UINT16_MAX
            ? sizeof(gtx_lod_vertex)
            : sizeof(gtx_lod_narrow_vertex);
    level->vertex_bytes = count * (uint64_t)level->vertex_size;
    if (k == 0 && !gtx_lod_find_neighbours(&source, count, allocator, out))
        level->result = GTX_ERROR_MEMORY;
}

gtx_result gtx_lod_place(const gtx_allocator *allocator, gtx_lod_meshes *out, gtx_error *error)
{
    gtx_result result = GTX_OK;
    for (uint32_t k = 0; k < out->level_count; ++k) {
        gtx_lod_level *level = &out->levels[k];
        result = level->result > result ? level->result : result;
        level->vertex_offset = out->vertex_bytes;
        level->index_offset = out->index_bytes;
        out->vertex_bytes += level->vertex_bytes;
        out->index_bytes += 3 * (uint64_t)level->triangle_count * level->index_size;
        out->index_bytes = (out->index_bytes + 3) / 4 * 4;
    }
    if (result == GTX_ERROR_CORRUPT)
        return gtx_fail(error, result, "an LOD mesh refers beyond its end");
    if (!result && out->level_count) {
        out->vertices = gtx_alloc_raw(allocator, (size_t)out->vertex_bytes, 1);
        out->indices = gtx_alloc_raw(allocator, (size_t)out->index_bytes, 1);
        result = out->vertices && out->indices ? GTX_OK : GTX_ERROR_MEMORY;
    }
    return result ? gtx_fail(error, result, "no memory for the model's LOD mesh") : GTX_OK;
}

static void free_copies(gtx_lod_level *level, const gtx_allocator *allocator)
{
    gtx_free_array(allocator, level->copies, level->source_vertices, sizeof *level->copies);
    level->copies = NULL;
}

void gtx_lod_fill(const gtx_asset *asset, uint32_t k, const gtx_allocator *allocator,
                  gtx_lod_meshes *out)
{
    gtx_lod_level *level = &out->levels[k];
    gtx_lod_mesh source;
    gtx_get_lod_mesh(asset, k, &source);
    uint8_t *normals = gtx_lod_normals(asset, k, &source, allocator);
    source.normals = normals ? normals : source.normals;
    split(out, level, &source);
    free_copies(level, allocator);
    /* The next level's indices are aligned. */
    const size_t end = 3 * (size_t)level->triangle_count * level->index_size;
    memset(out->indices + level->index_offset + end, 0, (4 - end % 4) % 4);
    gtx_lod_light(asset, k, &source, out);
    gtx_free_array(allocator, normals, source.vertex_count, 2);
    if (k == 0 && out->one_sided < out->patch_count)
        gtx_lod_find_openings(asset, allocator, out);
}

void gtx_lod_free_staging(gtx_lod_meshes *lods, const gtx_allocator *allocator)
{
    gtx_free_array(allocator, lods->vertices, (size_t)lods->vertex_bytes, 1);
    gtx_free_array(allocator, lods->indices, (size_t)lods->index_bytes, 1);
    lods->vertices = NULL;
    lods->indices = NULL;
}

void gtx_lod_free(gtx_lod_meshes *lods, const gtx_allocator *allocator)
{
    gtx_lod_free_staging(lods, allocator);
    for (uint32_t k = 0; k < lods->level_count; ++k) {
        free_copies(&lods->levels[k], allocator);
        gtx_free_array(allocator, lods->levels[k].first, lods->patch_count + 1,
                       sizeof *lods->levels[k].first);
        gtx_free_array(allocator, lods->levels[k].border, lods->patch_count,
                       sizeof *lods->levels[k].border);
        gtx_free_array(allocator, lods->levels[k].runs, lods->patch_count,
                       sizeof *lods->levels[k].runs);
        gtx_free_array(allocator, lods->levels[k].faces, lods->levels[k].triangle_count,
                       sizeof *lods->levels[k].faces);
    }
    gtx_free_array(allocator, lods->order, lods->patch_count, sizeof *lods->order);
    gtx_free_array(allocator, lods->edited, lods->patch_count, sizeof *lods->edited);
    gtx_free_array(allocator, lods->first_neighbour, lods->patch_count + 1,
                   sizeof *lods->first_neighbour);
    gtx_free_array(allocator, lods->neighbours, lods->neighbour_count, sizeof *lods->neighbours);
    *lods = (gtx_lod_meshes){0};
}
