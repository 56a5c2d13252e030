/* Implicit surfaces in one z-buffer with patches and polygons: spherical holes, a torus, a ball.
 *
 *   implicit ASSET.gtx [--headless OUT.png] [--size WxH]
 *
 * Spheres are cut out of the asset. Where a ray enters the asset inside a sphere, the sphere's far
 * side is the wall of a hole, unless the ray has left the asset by then: the cast then goes on
 * behind. Torus and ball have the relief of a height map; fragments of their boxes find them. */
#include "host/program.h"
#include "host/sample.h"
#include "host/shapes.h"
#include "implicit_shaders.h"

#include <geotex/render.h>
#include <math.h>
#include <string.h>

enum { RELIEF = 64, UNIT = 8 };

typedef struct world {
    const char *path;
    gtx_polygon_program plain, implicit;
    gtx_polygons solids, boxes;
    gtx_renderer *renderer;
    gtx_shading *shading;
    gtx_instance instance;
    GLuint relief;
} world;

/* Round studs in a lattice. */
static void make_relief(const gtx_host_gl *gl, world *w)
{
    static uint8_t map[RELIEF * RELIEF];
    for (int i = 0; i < RELIEF * RELIEF; ++i) {
        const float x = (float)(i % RELIEF) / 32 - 1, y = (float)(i / RELIEF) / 32 - 1;
        map[i] = (uint8_t)(255 * sqrtf(fmaxf(0, 1 - 1.3f * (x * x + y * y))));
    }
    gl->GenTextures(1, &w->relief);
    gl->BindTexture(GL_TEXTURE_2D, w->relief);
    gl->TexImage2D(GL_TEXTURE_2D, 0, GL_R8, RELIEF, RELIEF, 0, GL_RED, GL_UNSIGNED_BYTE, map);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
}

/* Holes where rays from the front and from above meet the asset. */
static gtx_result drill(const gtx_host_gl *gl, world *w, const gtx_asset *asset, gtx_error *error)
{
    static const gtx_ray rays[HOLES] = {{{0.2f, 0.6f, 9}, 0, {0, 0, -1}, 0},
                                        {{-0.3f, 1.1f, 9}, 0, {0, 0, -1}, 0},
                                        {{0.15f, 1.5f, 9}, 0, {0, 0, -1}, 0},
                                        {{0.5f, 9, 0.2f}, 0, {0, -1, 0}, 0}};
    const gtx_rays_desc desc = {.assets = &asset, .asset_count = 1, .max_instances = 1};
    uint32_t programs[GTX_SHADING_PROGRAMS];
    const uint32_t count = gtx_shading_programs(w->shading, programs);
    gtx_scene_instance known = {0};
    gtx_ray_instance placed = {0};
    gtx_caster *caster = NULL;
    gtx_scene *scene;
    gtx_rays *cast;
    gtx_hit hits[HOLES];
    float holes[HOLES][4];
    gtx_result result = gtx_caster_create(asset, NULL, &caster, error);
    known.caster = caster;
    memcpy(known.transform, w->instance.transform, sizeof known.transform);
    memcpy(placed.transform, w->instance.transform, sizeof placed.transform);
    if (result || (result = gtx_scene_create(&known, 1, NULL, &scene, error)) ||
        (result = gtx_rays_create(w->renderer, &desc, &cast, error)) ||
        (result = gtx_rays_place(w->renderer, cast, &placed, 1, error)))
        return result;
    gtx_scene_raycast(scene, rays, hits, NULL, HOLES, 0);
    for (int i = 0; i < 4 * HOLES; ++i) /* the radius, or a coordinate of the centre */
        holes[i / 4][i % 4] = i % 4 == 3 ? 0.3f : rays[i / 4].origin[i % 4] +
            fminf(hits[i / 4].t, 99) * rays[i / 4].direction[i % 4];
    for (uint32_t i = 0; i < count; ++i) {
        gtx_rays_bind(w->renderer, cast, programs[i]);
        gl->UseProgram(programs[i]);
        gl->Uniform4fv(gl->GetUniformLocation(programs[i], "holes"), HOLES, holes[0]);
    }
    gtx_scene_destroy(scene);
    gtx_caster_destroy(caster);
    return result;
}

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    world *w = user;
    const gtx_renderer_desc desc = {.load = loader};
    const gtx_rgb stone = {206, 198, 184}, wood = {150, 104, 62}, any = {0, 0, 0};
    gtx_shapes s = {0}, b = {0};
    gtx_asset *asset;
    gtx_model *model;
    gtx_info info;
    gtx_result result;
    gtx_shapes_box(&s, (float[3]){0, -0.1f, 0}, (float[3]){30, 0.2f, 30}, 0, stone);
    gtx_shapes_cylinder(&s, (float[3]){2, 0.5f, 0.7f}, 0.85f, 0.85f, 0.06f, wood);
    gtx_shapes_cylinder(&s, (float[3]){-1.25f, 0, 0}, 0.2f, 0.14f, 1.2f, wood);
    gtx_shapes_box(&b, (float[3]){0, 0.3f, 0}, (float[3]){4, 2, 4}, 0, any);
    gtx_shapes_box(&b, (float[3]){2, 0.5f, 0.7f}, (float[3]){1.4f, 1.4f, 1.4f}, 0, any);
    if ((result = gtx_open_file(w->path, NULL, &asset, error)) ||
        (result = gtx_renderer_create(&desc, &w->renderer, error)) ||
        (result = gtx_model_create(w->renderer, asset, &model, error)) ||
        (result = gtx_shading_create(w->renderer, patch_main, &w->shading, error)) ||
        (result = gtx_polygon_program_create(gl, &w->plain, error)) ||
        (result = gtx_polygon_program_create_with(gl, relief_main, &w->implicit, error)) ||
        (result = gtx_shapes_finish(&b, gl, &w->boxes, error)) ||
        (result = gtx_shapes_finish(&s, gl, &w->solids, error)))
        return result;
    gtx_get_info(asset, &info);
    w->instance.model = model;
    const float foot[3] = {0};
    gtx_matrix_stand(info.bounds_min, info.bounds_max, foot, -15, 2, w->instance.transform);
    make_relief(gl, w);
    result = drill(gl, w, asset, error);
    gtx_close(asset);
    return result;
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    const world *w = user;
    gtx_view v = {.shading = w->shading, .method = GTX_METHOD_CAST, .ambient = 0.25f};
    const float light[4] = {0.42f, 0.74f, 0.52f};
    float clip[16], eye[4] = {0};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    memcpy(v.light_direction, light, sizeof v.light_direction);
    gl->ClearColor(0.62f, 0.72f, 0.82f, 1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl->Enable(GL_DEPTH_TEST);
    gtx_polygons_draw(gl, &w->plain, &w->solids, NULL, &v);
    for (int k = 0; k < 12; ++k) /* a view turns and moves: its inverse is its transpose */
        eye[k / 4] -= view[k / 4 * 4 + k % 4] * (k % 4 < 3 ? view[12 + k % 4] : 0);
    gtx_matrix_multiply(projection, view, clip);
    gl->UseProgram(w->implicit.program);
    gtx_set_matrix(gl, w->implicit.program, "clip", clip);
    gtx_set_vector(gl, w->implicit.program, "eye", eye);
    gtx_set_vector(gl, w->implicit.program, "light", light);
    gtx_set_texture(gl, w->implicit.program, "relief", UNIT, w->relief);
    gl->Enable(GL_CULL_FACE);
    gl->CullFace(GL_FRONT); /* the backs of the boxes: the camera may stand in them */
    gtx_polygons_draw(gl, &w->implicit, &w->boxes, NULL, &v);
    gl->CullFace(GL_BACK);
    gl->Disable(GL_CULL_FACE);
    return gtx_draw(w->renderer, &v, &w->instance, 1, error);
}

int main(int argc, char **argv)
{
    world w = {.path = NULL};
    gtx_show show = {.title = "implicit", .width = 1280, .height = 720, .load = load, .draw = draw,
                     .user = &w, .camera = {.target = {0.75f, 0.72f, 0}, .radius = 2.6f,
                     .azimuth = 12, .elevation = 22, .distance = 2, .field = 36}};
    return gtx_sample_main(&show, argc, argv, &w.path);
}
