/* Triangles of LOD meshes that face the eye, picked for rasterizers in software: from outside at
 * most half of those of a solid do, and vertices and triangles take most of a frame. */
#include "frame/facing.h"
#include "frame/frustum.h"
#include "frame/planner.h"

#include "base/alloc.h"

#include <math.h>
#include <string.h>

/* Normals are in 127ths, and offsets in so many steps of positions times that, rounded down. Half a
 * diagonal of the former is how far they are off, by which what they tell of an eye is, times its
 * distance. */
static const float one = 127, offset_step = 1024, off = 0.87f;

/* Which vertex a run's indices count from here: the same for as many as 16 bits have indices for,
 * so that they are one draw. */
static uint32_t base_of(uint32_t first_vertex, uint32_t vertex_count)
{
    enum { GROUP = 1 << 15 };
    return vertex_count <= GROUP ? first_vertex / GROUP * GROUP : first_vertex;
}

static gtx_lod_face face_of(const uint8_t *vertices, uint32_t vertex_size, const uint16_t corner[3])
{
    gtx_lod_face out = {{0, 0, 0}, INT16_MIN, {corner[0], corner[1], corner[2]}};
    uint16_t at[3][3];
    float n[3], offset = 0;
    for (int c = 0; c < 3; ++c)
        memcpy(at[c], vertices + (size_t)corner[c] * vertex_size, sizeof at[c]);
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (float)(at[1][i] - at[0][i]) * (float)(at[2][j] - at[0][j]) -
               (float)(at[1][j] - at[0][j]) * (float)(at[2][i] - at[0][i]);
    }
    const float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3 && length > 0; ++k) {
        out.normal[k] = (int8_t)floorf(one * n[k] / length + 0.5f);
        offset += (float)(out.normal[k] * at[0][k]);
    }
    if (length > 0)
        out.offset = (int16_t)floorf(offset / offset_step);
    return out;
}

/* Triangles below which picking gains little. On a bunny in a page: at half a page holds 0.1 MB
 * more; at four times the level that it draws is not picked from, and a frame takes half as long
 * again. */
enum { MIN_TRIANGLES = 8192 };

static void surround(const gtx_lod_meshes *lods, gtx_lod_level *level)
{
    const uint8_t *vertex = lods->vertices + level->vertex_offset;
    const uint8_t *end = vertex + level->vertex_bytes;
    uint16_t low[3] = {UINT16_MAX, UINT16_MAX, UINT16_MAX}, high[3] = {0, 0, 0}, at[3];
    float square = 0;
    for (; vertex < end; vertex += level->vertex_size) {
        memcpy(at, vertex, sizeof at);
        for (int k = 0; k < 3; ++k) {
            low[k] = at[k] < low[k] ? at[k] : low[k];
            high[k] = at[k] > high[k] ? at[k] : high[k];
        }
    }
    for (int k = 0; k < 3; ++k) {
        const float half = 0.5f * (float)(high[k] - low[k]);
        level->faces_middle[k] = (float)low[k] + half;
        square += half * half;
    }
    level->faces_radius = sqrtf(square);
}

static void find_faces(const gtx_lod_meshes *lods, gtx_lod_level *level)
{
    uint32_t t = 0;
    for (const gtx_lod_run *run = level->runs; t < level->triangle_count; ++run) {
        const uint32_t base = base_of(run->first_vertex, run->vertex_count);
        const uint8_t *vertices =
            lods->vertices + level->vertex_offset + (size_t)base * level->vertex_size;
        for (; t < run->end; ++t) {
            uint16_t corner[3];
            memcpy(corner, lods->indices + level->index_offset + t * sizeof corner, sizeof corner);
            for (int c = 0; c < 3; ++c)
                corner[c] = (uint16_t)(corner[c] + run->first_vertex - base);
            level->faces[t] = face_of(vertices, level->vertex_size, corner);
        }
    }
}

/* Among those of a patch, and of its border, which are drawn alone. What is lit at vertices is so
 * whichever corner comes first. */
static void put_in_order(const gtx_lod_meshes *lods, gtx_lod_level *level)
{
    gtx_face_order order;
    gtx_face_order_begin(&order);
    for (uint32_t i = 0; i < lods->patch_count; ++i) {
        const uint32_t end[2] = {level->border[i], level->first[i + 1]};
        uint32_t t = level->first[i];
        for (int border = 0; border < 2; ++border)
            for (; t < end[border]; t = end[border])
                gtx_order_faces(&order, level->faces + t, end[border] - t, level->lit);
    }
}

void gtx_lod_find_faces(const gtx_allocator *allocator, gtx_lod_meshes *lods)
{
    for (uint32_t k = 0; k < lods->level_count; ++k) {
        gtx_lod_level *level = &lods->levels[k];
        if (level->index_size == sizeof(uint16_t) && level->triangle_count >= MIN_TRIANGLES)
            level->faces = gtx_alloc_raw(allocator, level->triangle_count, sizeof *level->faces);
        if (level->faces) {
            surround(lods, level);
            find_faces(lods, level);
            put_in_order(lods, level);
        }
    }
}

/* What a face tells at least of an eye that it faces: no face is farther from the eye. */
static float least_of(const gtx_lod_level *level, const float eye[4])
{
    float square = 0;
    for (int k = 0; k < 3; ++k) {
        const float away = eye[k] - eye[3] * level->faces_middle[k];
        square += away * away;
    }
    return -off * (sqrtf(square) + eye[3] * level->faces_radius);
}

/* Of an eye in steps of positions, as gtx_frustum has it; gives the number of indices. */
static uint32_t pick(const gtx_lod_face *face, uint32_t count, const float eye[4], float least,
                     uint16_t *out)
{
    const float w = eye[3] * offset_step;
    const uint16_t *begin = out;
    for (const gtx_lod_face *end = face + count; face < end; ++face) {
        const float before = eye[0] * face->normal[0] + eye[1] * face->normal[1] +
                             eye[2] * face->normal[2] - w * face->offset;
        memcpy(out, face->corner, sizeof face->corner);
        out += before >= least ? 3 : 0;
    }
    return (uint32_t)(out - begin);
}

void gtx_pick_faces(const gtx_draw_call *call, const gtx_lod_level *level, gtx_frame_draw *draw)
{
    gtx_planner *planner = call->planner;
    const gtx_frustum f =
        gtx_frustum_of(call, draw->model, &planner->instances[draw->first_instance]);
    uint32_t most = 3, count = 0, ranges = 0; /* the last one is written before it is dropped */
    for (uint32_t i = 0; i < draw->range_count; ++i)
        most += draw->ranges[i].count;
    uint16_t *indices =
        f.two ? NULL : gtx_scratch_reserve(&planner->allocator, &planner->picked, most, 2);
    if (!indices)
        return;
    float eye[4] = {0, 0, 0, (float)f.eye[3]};
    for (int k = 0; k < 3; ++k)
        eye[k] = (float)((f.eye[k] - f.eye[3] * (double)level->place[k]) / (double)level->place[3]);
    const float least = least_of(level, eye);
    for (uint32_t i = 0; i < draw->range_count; ++i) {
        gtx_range r = draw->ranges[i], *last = &planner->plan.ranges[ranges];
        const gtx_lod_face *first = level->faces + r.first / 3;
        const uint32_t base = base_of(r.base_vertex, r.vertex_count);
        r.vertex_count += r.base_vertex - base;
        r.base_vertex = base;
        r.first = count;
        r.count = pick(first, r.count / 3, eye, least, indices + count);
        count += r.count;
        if (ranges && last[-1].base_vertex == base) {
            last[-1].count += r.count;
            last[-1].vertex_count = r.vertex_count;
        } else if (r.count)
            planner->plan.ranges[ranges++] = r;
    }
    draw->range_count = ranges;
    draw->index_offset = 0;
    draw->index_data = indices;
    draw->index_bytes = count * sizeof *indices;
}
