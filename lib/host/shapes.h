/* Boxes, cylinders and grids as one growing polygon mesh, for hosts that build a scene. */
#ifndef GTX_HOST_SHAPES_H
#define GTX_HOST_SHAPES_H

#include "host/polygons.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Start from zeros. Memory that cannot be had sets `failed`, and nothing more is added. */
typedef struct gtx_shapes {
    gtx_polygon_vertex *vertices;
    uint32_t *indices;
    uint32_t vertex_count, index_count, vertex_capacity, index_capacity;
    int failed;
} gtx_shapes;

typedef struct gtx_rgb {
    uint8_t r, g, b;          /* sRGB */
} gtx_rgb;

/* Adds to the mesh; triangles are counter-clockwise seen from outside. A quad's corners go around
 * it; `degrees` turn around +Y; a cylinder stands on its centre. */
void gtx_shapes_quad(gtx_shapes *shapes, const float corners[4][3], gtx_rgb color);
void gtx_shapes_box(gtx_shapes *shapes, const float center[3], const float size[3], float degrees,
                    gtx_rgb color);
void gtx_shapes_cylinder(gtx_shapes *shapes, const float foot[3], float radius_low,
                         float radius_high, float height, gtx_rgb color);

/* A round tube along at least two points, no two after one another the same, open at its ends. */
void gtx_shapes_tube(gtx_shapes *shapes, const float (*points)[3], uint32_t count, float radius,
                     gtx_rgb color);

/* A horizontal grid of cells x cells squares at height y, `side` long, centred on the origin, whose
 * vertices are unlit and get their colours from `color`. */
void gtx_shapes_grid(gtx_shapes *shapes, float y, float side, uint32_t cells,
                     gtx_rgb (*color)(float x, float z, void *user), void *user);

/* Uploads the mesh and frees the memory. Errors: MEMORY, GL. */
gtx_result gtx_shapes_finish(gtx_shapes *shapes, const gtx_host_gl *gl, gtx_polygons *out,
                             gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
