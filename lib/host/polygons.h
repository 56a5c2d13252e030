/* A small lit polygon renderer: what an engine draws beside geotex, and what tests compare with. */
#ifndef GTX_HOST_POLYGONS_H
#define GTX_HOST_POLYGONS_H

#include "host/gl.h"

#include <geotex/render.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gtx_polygon_vertex {
    float position[3], normal[3];
    uint8_t color[4];         /* sRGB; alpha 0: unlit */
    uint8_t material[4];      /* occlusion, roughness, metallic: for shaders of the caller's */
} gtx_polygon_vertex;

/* Triangles in memory. */
typedef struct gtx_polygon_data {
    const gtx_polygon_vertex *vertices;
    const uint32_t *indices;
    uint32_t vertex_count, index_count;
} gtx_polygon_data;

/* Triangles in buffers on the GPU; or, after a host set `mode` to GL_LINES, pairs of ends. */
typedef struct gtx_polygons {
    GLuint vertex_array, vertices, indices;
    GLsizei index_count;
    GLenum mode;
} gtx_polygons;

/* Errors: GL (out of memory). */
gtx_result gtx_polygons_create(const gtx_host_gl *gl, const gtx_polygon_data *data,
                               gtx_polygons *out, gtx_error *error);
void gtx_polygons_destroy(const gtx_host_gl *gl, gtx_polygons *polygons);

/* The program. */
typedef struct gtx_polygon_program {
    GLuint program;
    GLint model, view_projection, light, ambient;
} gtx_polygon_program;

/* Errors: SHADER. */
gtx_result gtx_polygon_program_create(const gtx_host_gl *gl, gtx_polygon_program *out,
                                      gtx_error *error);
/* The same with a fragment shader of the caller's, without #version: in vec3 world_point,
 * world_normal (not normalised), in vec4 srgb, material (0..1). */
gtx_result gtx_polygon_program_create_with(const gtx_host_gl *gl, const char *fragment,
                                           gtx_polygon_program *out, gtx_error *error);
void gtx_polygon_program_destroy(const gtx_host_gl *gl, gtx_polygon_program *program);

/* Draws with the state as it is (depth test, culling), by the shading of gtx_draw: Lambert with the
 * light direction and ambient share of the view, where zeros are no light and no ambient share.
 * `model` NULL is the identity. Leaves program 0 and vertex array 0. */
void gtx_polygons_draw(const gtx_host_gl *gl, const gtx_polygon_program *program,
                       const gtx_polygons *polygons, const float *model, const gtx_view *view);

#ifdef __cplusplus
}
#endif
#endif
