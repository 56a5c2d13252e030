/* A sky and a tiled floor with baked soft shadows: the surroundings of a model in a picture. */
#ifndef GTX_HOST_BACKDROP_H
#define GTX_HOST_BACKDROP_H

#include "host/camera.h"
#include "host/polygons.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gtx_backdrop {
    gtx_polygons floor, sky;
} gtx_backdrop;

/* Draws what stands on the floor, into the bound framebuffer. */
typedef gtx_result (*gtx_draw_standing)(const float view[16], const float projection[16],
                                        void *user, gtx_error *error);

typedef struct gtx_backdrop_desc {
    float side;               /* of the floor */
    const float *light;       /* three: towards the light, unit */
    gtx_draw_standing draw;
    void *user;
} gtx_backdrop_desc;

/* A floor at height 0, centred on the origin. Its shadows are those of what `draw` draws within
 * half of it, in parallel light. Unbinds the framebuffer. Errors: MEMORY, GL, and what `draw`
 * returns. */
gtx_result gtx_backdrop_create(const gtx_host_gl *gl, const gtx_backdrop_desc *desc,
                               gtx_backdrop *out, gtx_error *error);
void gtx_backdrop_destroy(const gtx_host_gl *gl, gtx_backdrop *backdrop);

/* Clears the framebuffer and draws sky and floor; leaves the depth test on. */
void gtx_backdrop_draw(const gtx_host_gl *gl, const gtx_polygon_program *program,
                       const gtx_backdrop *backdrop, const float view[16],
                       const float projection[16]);

#ifdef __cplusplus
}
#endif
#endif
