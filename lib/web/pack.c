/* Models between copies of the core: what a worker has prepared, as bytes, and what of it goes to
 * the GPU, which geotex.js sends from wherever it lies. Built by emscripten alone; see web.mk. */
#include "base/alloc.h"
#include "frame/model.h"

#include <emscripten/emscripten.h>

#include <string.h>

#define WEB_API EMSCRIPTEN_KEEPALIVE

/* What is done with each array of a model. */
typedef void array_fn(void **array, size_t count, size_t size, void *user);

static void each_array(gtx_model *m, array_fn *fn, void *user)
{
    gtx_lod_meshes *lods = &m->lods;
    const size_t patches = m->patch_count, slots = m->kind_count * patches + 1;
#define EACH(array, count) fn((void **)&(array), count, sizeof *(array), user)
    EACH(m->first_vertex, slots);
    EACH(m->first_index, slots);
    EACH(m->facts, patches);
    EACH(m->records, patches);
    EACH(m->first_slab, m->mip_count * patches + 1);
    EACH(m->first_node, patches + 1);
    EACH(m->rtins, patches);
    EACH(m->slabs, m->first_slab ? m->first_slab[m->mip_count * patches] : 0);
    EACH(m->blocks, m->first_slab ? m->first_slab[patches] : 0);
    EACH(m->nodes, m->first_node ? m->first_node[patches] : 0);
    for (uint32_t k = 0; k < lods->level_count; ++k) {
        EACH(lods->levels[k].first, patches + 1);
        EACH(lods->levels[k].border, patches);
        EACH(lods->levels[k].runs, patches);
        EACH(lods->levels[k].faces, lods->levels[k].triangle_count);
    }
    EACH(lods->order, lods->patch_count);
    EACH(lods->edited, lods->patch_count);
    EACH(lods->first_neighbour, lods->patch_count + 1);
    EACH(lods->neighbours, lods->neighbour_count);
#undef EACH
}

/* Bytes that are written, or read: NULL, and only counted. */
typedef struct packed {
    uint8_t *bytes;
    size_t at;
    gtx_allocator hooks;
    bool failed;
} packed;

static void put(void **array, size_t count, size_t size, void *user)
{
    packed *p = user;
    if (!*array)
        return;
    if (p->bytes)
        memcpy(p->bytes + p->at, *array, count * size);
    p->at += count * size;
}

/* Of Module.plan, so that the heap never holds it twice. */
EM_JS(void, read_plan, (void *to, size_t from, size_t size),
      { HEAPU8.set(Module['plan'].subarray(from, from + size), to); });

static void take(void **array, size_t count, size_t size, void *user)
{
    packed *p = user;
    const bool there = *array != NULL;
    *array = there && !p->failed ? gtx_alloc_raw(&p->hooks, count, size) : NULL;
    if (*array)
        read_plan(*array, p->at, count * size);
    p->failed |= there && count && !*array;
    p->at += there ? count * size : 0;
}

/* All of a model but what goes to the GPU; *size gets the number of bytes. To be freed. */
WEB_API void *gtxw_model_pack(gtx_model *model, uint32_t *size)
{
    packed p = {.at = sizeof *model, .hooks = gtx_allocator_or_default(NULL)};
    each_array(model, put, &p);
    *size = (uint32_t)p.at;
    p = (packed){.bytes = gtx_alloc_raw(&p.hooks, p.at, 1), .at = sizeof *model};
    if (p.bytes) {
        memcpy(p.bytes, model, sizeof *model);
        each_array(model, put, &p);
    }
    return p.bytes;
}

/* Of bytes that gtxw_model_pack of this very core gave, as Module.plan. 0 without memory. */
WEB_API gtx_model *gtxw_model_unpack(void)
{
    packed p = {.at = sizeof(gtx_model), .hooks = gtx_allocator_or_default(NULL)};
    gtx_model *model = gtx_alloc_raw(&p.hooks, 1, sizeof *model);
    if (!model)
        return NULL;
    read_plan(model, 0, sizeof *model);
    model->allocator = p.hooks;
    for (uint32_t i = 0; i < model->level_count; ++i)
        model->levels[i].data = NULL;
    model->proxies.vertices = NULL;
    model->proxies.indices = NULL;
    model->lods.vertices = NULL;
    model->lods.indices = NULL;
    each_array(model, take, &p);
    if (p.failed) {
        gtx_model_free(model);
        return NULL;
    }
    return model;
}

enum { OF_A_TEXTURE = 7 + GTX_MAX_TEXTURE_LEVELS };

/* Of each texture its format, texel size, width, height, layers, levels, whether it is an array,
 * and where its levels lie; then of each buffer where it lies, and its bytes. Valid until the next
 * call. */
WEB_API const uint32_t *gtxw_model_resources(const gtx_model *model)
{
    static uint32_t out[GTX_SLOT_COUNT * OF_A_TEXTURE + 2 * GTX_BUFFER_GRID_VERTICES];
    uint32_t *next = out;
    for (uint32_t slot = 0; slot < GTX_SLOT_COUNT; ++slot) {
        gtx_texture t;
        gtx_model_texture(model, (gtx_slot)slot, &t);
        const uint32_t numbers[7] = {(uint32_t)t.format, t.texel_size, t.width,   t.height,
                                     t.layers,           t.levels,     t.is_array};
        memcpy(next, numbers, sizeof numbers);
        for (uint32_t k = 0; k < GTX_MAX_TEXTURE_LEVELS; ++k)
            next[7 + k] = (uint32_t)(uintptr_t)t.texels[k];
        next += OF_A_TEXTURE;
    }
    for (uint32_t i = 0; i < GTX_BUFFER_GRID_VERTICES; ++i) {
        uint64_t size;
        *next++ = (uint32_t)(uintptr_t)gtx_model_buffer(model, (gtx_buffer)i, &size);
        *next++ = (uint32_t)size;
    }
    return out;
}

/* The names of its textures and buffers, all of which is sent: it can be drawn. */
WEB_API void gtxw_model_sent(gtx_model *model, const uint32_t *names)
{
    memcpy(model->textures, names, sizeof model->textures);
    names += UNIT_COUNT;
    model->vertices = names[GTX_BUFFER_PROXY_VERTICES];
    model->indices = names[GTX_BUFFER_PROXY_INDICES];
    model->lods.vertex_buffer = names[GTX_BUFFER_LOD_VERTICES];
    model->lods.index_buffer = names[GTX_BUFFER_LOD_INDICES];
    model->ready = true;
    gtx_model_uploaded(model);
}
