/* Boxes, cylinders and grids as one growing polygon mesh. */
#include "host/shapes.h"

#include "base/error.h"
#include "base/vec.h"

#include <stdlib.h>

static const float full_turn = 6.28318530717959f;

/* Room for more vertices and indices; false when there is none. */
static int reserve(gtx_shapes *s, uint32_t vertices, uint32_t indices)
{
    if (s->vertex_count + vertices > s->vertex_capacity) {
        const uint32_t capacity = 2 * (s->vertex_count + vertices);
        void *memory = realloc(s->vertices, capacity * sizeof *s->vertices);
        s->failed |= !memory;
        if (memory) {
            s->vertices = memory;
            s->vertex_capacity = capacity;
        }
    }
    if (s->index_count + indices > s->index_capacity) {
        const uint32_t capacity = 2 * (s->index_count + indices);
        void *memory = realloc(s->indices, capacity * sizeof *s->indices);
        s->failed |= !memory;
        if (memory) {
            s->indices = memory;
            s->index_capacity = capacity;
        }
    }
    return !s->failed;
}

static void add_vertex(gtx_shapes *s, gtx_vec3 position, gtx_vec3 normal, gtx_rgb color)
{
    gtx_polygon_vertex *v = &s->vertices[s->vertex_count++];
    gtx_v3_store(v->position, position);
    gtx_v3_store(v->normal, normal);
    v->color[0] = color.r;
    v->color[1] = color.g;
    v->color[2] = color.b;
    v->color[3] = 255;
}

static void add_triangle(gtx_shapes *s, uint32_t a, uint32_t b, uint32_t c)
{
    s->indices[s->index_count++] = a;
    s->indices[s->index_count++] = b;
    s->indices[s->index_count++] = c;
}

void gtx_shapes_quad(gtx_shapes *shapes, const float corners[4][3], gtx_rgb color)
{
    if (!reserve(shapes, 4, 6))
        return;
    const uint32_t first = shapes->vertex_count;
    const gtx_vec3 a = gtx_v3_load(corners[0]), b = gtx_v3_load(corners[1]);
    const gtx_vec3 d = gtx_v3_load(corners[3]);
    const gtx_vec3 normal =
        gtx_v3_normalize(gtx_v3_cross(gtx_v3_sub(b, a), gtx_v3_sub(d, a)));
    for (int i = 0; i < 4; ++i)
        add_vertex(shapes, gtx_v3_load(corners[i]), normal, color);
    add_triangle(shapes, first, first + 1, first + 2);
    add_triangle(shapes, first, first + 2, first + 3);
}

void gtx_shapes_box(gtx_shapes *shapes, const float center[3], const float size[3], float degrees,
                    gtx_rgb color)
{
    /* Corner k is on the far side along axis a where bit a of k is set. */
    static const uint8_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                        {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    const float c = cosf(degrees * full_turn / 360), s = sinf(degrees * full_turn / 360);
    for (int f = 0; f < 6; ++f) {
        float corners[4][3];
        for (int i = 0; i < 4; ++i) {
            const int k = faces[f][i];
            const float x = (k & 1 ? 0.5f : -0.5f) * size[0], z = (k & 4 ? 0.5f : -0.5f) * size[2];
            corners[i][0] = center[0] + c * x + s * z;
            corners[i][1] = center[1] + (k & 2 ? 0.5f : -0.5f) * size[1];
            corners[i][2] = center[2] - s * x + c * z;
        }
        gtx_shapes_quad(shapes, (const float(*)[3])corners, color);
    }
}

void gtx_shapes_cylinder(gtx_shapes *shapes, const float foot[3], float radius_low,
                         float radius_high, float height, gtx_rgb color)
{
    enum { SIDES = 48 };
    if (!reserve(shapes, 3 * SIDES + 1, 9 * SIDES))
        return;
    const uint32_t first = shapes->vertex_count, top = first + 2 * SIDES, middle = top + SIDES;
    const gtx_vec3 base = gtx_v3_load(foot), up = gtx_v3(0, 1, 0);
    for (int part = 0; part < 3; ++part) /* the rims of the side, and the lid's */
        for (int i = 0; i < SIDES; ++i) {
            const float angle = full_turn * (float)i / SIDES;
            const gtx_vec3 out = gtx_v3(cosf(angle), 0, -sinf(angle));
            const gtx_vec3 slope = gtx_v3_mad(out, up, (radius_low - radius_high) / height);
            const gtx_vec3 rim = gtx_v3_mad(base, out, part ? radius_high : radius_low);
            add_vertex(shapes, part ? gtx_v3_mad(rim, up, height) : rim,
                       part < 2 ? gtx_v3_normalize(slope) : up, color);
        }
    add_vertex(shapes, gtx_v3_mad(base, up, height), up, color);
    for (uint32_t i = 0; i < SIDES; ++i) {
        const uint32_t next = (i + 1) % SIDES;
        add_triangle(shapes, first + i, first + next, first + SIDES + next);
        add_triangle(shapes, first + i, first + SIDES + next, first + SIDES + i);
        add_triangle(shapes, top + i, top + next, middle);
    }
}

void gtx_shapes_tube(gtx_shapes *shapes, const float (*points)[3], uint32_t count, float radius,
                     gtx_rgb color)
{
    enum { SIDES = 16 };
    if (count < 2 || !reserve(shapes, SIDES * count, 6 * SIDES * (count - 1)))
        return;
    const uint32_t first = shapes->vertex_count;
    gtx_vec3 side = gtx_v3(0, 0, 0);
    for (uint32_t p = 0; p < count; ++p) {
        const gtx_vec3 here = gtx_v3_load(points[p]);
        const gtx_vec3 way = gtx_v3_normalize(gtx_v3_sub(gtx_v3_load(points[p + (p + 1 < count)]),
                                                         gtx_v3_load(points[p - (p > 0)])));
        if (!p) /* then carried along, so that the tube does not twist */
            side = fabsf(way.y) < 0.9f ? gtx_v3(0, 1, 0) : gtx_v3(1, 0, 0);
        side = gtx_v3_normalize(gtx_v3_mad(side, way, -gtx_v3_dot(side, way)));
        const gtx_vec3 other = gtx_v3_cross(way, side);
        for (uint32_t i = 0; i < SIDES; ++i) {
            const float angle = full_turn * (float)i / SIDES;
            const gtx_vec3 out = gtx_v3_add(gtx_v3_scale(side, cosf(angle)),
                                            gtx_v3_scale(other, sinf(angle)));
            add_vertex(shapes, gtx_v3_mad(here, out, radius), out, color);
            if (!p)
                continue;
            const uint32_t a = first + p * SIDES + i, b = first + p * SIDES + (i + 1) % SIDES;
            add_triangle(shapes, a - SIDES, b - SIDES, b);
            add_triangle(shapes, a - SIDES, b, a);
        }
    }
}

void gtx_shapes_grid(gtx_shapes *shapes, float y, float side, uint32_t cells,
                     gtx_rgb (*color)(float x, float z, void *user), void *user)
{
    const uint32_t first = shapes->vertex_count, row = cells + 1;
    if (!reserve(shapes, row * row, 6 * cells * cells))
        return;
    for (uint32_t j = 0; j < row; ++j)
        for (uint32_t i = 0; i < row; ++i) {
            const float x = side * ((float)i / (float)cells - 0.5f);
            const float z = side * ((float)j / (float)cells - 0.5f);
            add_vertex(shapes, gtx_v3(x, y, z), gtx_v3(0, 1, 0), color(x, z, user));
            shapes->vertices[shapes->vertex_count - 1].color[3] = 0;
        }
    for (uint32_t j = 0; j < cells; ++j)
        for (uint32_t i = 0; i < cells; ++i) {
            const uint32_t a = first + j * row + i, b = a + row;
            add_triangle(shapes, a, b, b + 1);
            add_triangle(shapes, a, b + 1, a + 1);
        }
}

gtx_result gtx_shapes_finish(gtx_shapes *shapes, const gtx_host_gl *gl, gtx_polygons *out,
                             gtx_error *error)
{
    const gtx_polygon_data data = {shapes->vertices, shapes->indices, shapes->vertex_count,
                                   shapes->index_count};
    gtx_result result =
        shapes->failed ? gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the polygons")
                       : gtx_polygons_create(gl, &data, out, error);
    free(shapes->vertices);
    free(shapes->indices);
    *shapes = (gtx_shapes){0};
    return result;
}
