/* An engine's forward pass whole, by the main that geotex brings along: linear light of a sun with
 * the engine's shadow map, a lamp and a spot, fog and motion vectors, then a curve for the screen.
 *
 *   engine_lighting ASSET.gtx [--headless OUT.png] [--size WxH] */
#include "host/program.h"
#include "host/sample.h"
#include "host/target.h"

#include <geotex/render.h>
#include <string.h>

enum { INSTANCES = 3, SIZE = 1024, SHADOW_UNIT = 8, BLOCK = 1 };

/* Filmic (Hejl and Burgess-Dawson 2010), which ends in sRGB. */
static const char screen_main[] =
    "uniform highp sampler2D picture;\n"
    "layout(location = 0) out vec4 color;\n"
    "void main() {\n"
    "    vec3 x = max(texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb - 0.004, 0.0);\n"
    "    color = vec4((x * (6.2 * x + 0.5)) / (x * (6.2 * x + 1.7) + 0.06), 1.0); }\n";

typedef struct engine {
    const char *path;
    gtx_renderer *renderer;
    gtx_shading *shading;
    gtx_instance instances[INSTANCES];
    gtx_target picture;           /* linear light; motion */
    gtx_lighting lighting;
    GLuint block, screen;
} engine;

/* What the sun sees, as a texture that compares. */
static gtx_result draw_shadows(const gtx_host_gl *gl, engine *e, gtx_error *error)
{
    static const float to_map[] = {.5f, 0, 0, 0, 0, .5f, 0, 0, 0, 0, .5f, 0, .5f, .5f, .5f, 1};
    const gtx_camera sun = {.target = {0, 0.8f, 0}, .radius = 4, .azimuth = -52, .elevation = 38,
                            .distance = 2, .orthographic = 1};
    gtx_view v = {.pass = GTX_PASS_DEPTH, .viewport_height = SIZE};
    float clip[16], right[3], up[3];
    gtx_target map;
    gtx_camera_matrices(&sun, 1, v.view, v.projection);
    gtx_matrix_multiply(v.projection, v.view, clip);
    gtx_matrix_multiply(to_map, clip, e->lighting.shadow);
    gtx_camera_axes(&sun, right, up, e->lighting.lamps[0].place);
    e->lighting.options[1] = -v.projection[10] / v.projection[0] / SIZE;
    gtx_result result = gtx_target_create(gl, SIZE, SIZE, NULL, &map, error);
    if (result) return result;
    gtx_target_begin(gl, &map);
    result = gtx_draw(e->renderer, &v, e->instances, INSTANCES, error);
    gl->ActiveTexture(GL_TEXTURE0 + SHADOW_UNIT);
    gl->BindTexture(GL_TEXTURE_2D, map.depth);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->ActiveTexture(GL_TEXTURE0);
    return result;
}

#define LOADED(type, name) const type name = (type)loader("gl" #name, NULL)
/* Makes the block, and tells each program of the shading where it and textures are. */
static void bind_lighting(const gtx_host_gl *gl, engine *e, gtx_host_load loader)
{
    LOADED(PFNGLBINDBUFFERBASEPROC, BindBufferBase);
    LOADED(PFNGLGETUNIFORMBLOCKINDEXPROC, GetUniformBlockIndex);
    LOADED(PFNGLUNIFORMBLOCKBINDINGPROC, UniformBlockBinding);
    GLuint programs[GTX_SHADING_PROGRAMS];
    const uint32_t count = gtx_shading_programs(e->shading, programs);
    gl->GenBuffers(1, &e->block);
    BindBufferBase(GL_UNIFORM_BUFFER, BLOCK, e->block);
    for (uint32_t i = 0; i < count; ++i) {
        UniformBlockBinding(programs[i], GetUniformBlockIndex(programs[i], "gtx_lighting"), BLOCK);
        gl->UseProgram(programs[i]);
        gl->Uniform1i(gl->GetUniformLocation(programs[i], "gtx_shadow_map"), SHADOW_UNIT);
        gl->Uniform1i(gl->GetUniformLocation(programs[i], "gtx_before"), SHADOW_UNIT + 1);
    }
}

static gtx_result load(const gtx_host_gl *gl, gtx_host_load loader, void *user, gtx_error *error)
{
    static const float places[INSTANCES][5] = { /* x, y, z of the foot; turn; height */
        {0.3f, 0, 0, -15, 2.2f}, {-1.5f, 0, 1.2f, 60, 1.2f}, {1.7f, 0, -1.3f, 200, 1.5f}};
    engine *e = user;
    const gtx_renderer_desc desc = {.load = loader};
    gtx_asset *asset;
    gtx_model *model;
    gtx_info info;
    gtx_result result;
    if ((result = gtx_open_file(e->path, NULL, &asset, error)) ||
        (result = gtx_renderer_create(&desc, &e->renderer, error)) ||
        (result = gtx_model_create(e->renderer, asset, &model, error)) ||
        (result = gtx_shading_create(e->renderer, gtx_shader_source("geotex_lighting.frag"),
                                     &e->shading, error)) ||
        (result = gtx_host_program_create(gl, gtx_screen_vertex, screen_main, &e->screen, error)))
        return result;
    gtx_get_info(asset, &info);
    gtx_close(asset);
    for (int i = 0; i < INSTANCES; ++i) {
        e->instances[i].model = model;
        gtx_matrix_stand(info.bounds_min, info.bounds_max, places[i], places[i][3], places[i][4],
                         e->instances[i].transform);
    }
    bind_lighting(gl, e, loader);
    return draw_shadows(gl, e, error);
}

static gtx_result draw(const gtx_host_gl *gl, const float view[16], const float projection[16],
                       void *user, gtx_error *error)
{
    const GLenum formats[] = {GL_RGBA16F, GL_RGBA16F, 0};
    engine *e = user;
    gtx_lighting *l = &e->lighting;
    gtx_view v = {.shading = e->shading, .flags = GTX_VIEW_SHADING_BY_TILES};
    GLuint bound; /* the screen's framebuffer */
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, projection, sizeof v.projection);
    memcpy(l->clip_before, l->clip, sizeof l->clip);
    gtx_matrix_multiply(projection, view, l->clip);
    for (const float *c = view; c < view + 12; c += 4) /* the turned shift, negated */
        l->eye[(c - view) / 4] = -(c[0] * view[12] + c[1] * view[13] + c[2] * view[14]);
    gtx_result result = gtx_target_fit(gl, formats, &e->picture, &bound, error);
    if (result) return result;
    v.viewport_width = (uint32_t)e->picture.width;
    v.viewport_height = (uint32_t)e->picture.height;
    gl->BindBuffer(GL_UNIFORM_BUFFER, e->block);
    gl->BufferData(GL_UNIFORM_BUFFER, sizeof *l, l, GL_STREAM_DRAW);
    gtx_target_begin(gl, &e->picture);
    gl->ClearBufferfv(GL_COLOR, 0, l->fog);
    result = gtx_draw(e->renderer, &v, e->instances, INSTANCES, error);
    gl->Disable(GL_DEPTH_TEST);
    gl->BindFramebuffer(GL_FRAMEBUFFER, bound);
    gl->UseProgram(e->screen);
    gtx_set_texture(gl, e->screen, "picture", 0, e->picture.colors[0]);
    gtx_screen_draw(gl);
    return result;
}

int main(int argc, char **argv)
{
    engine e = {
        .lighting = {{0}, {0}, {0}, {0}, {0.10f, 0.12f, 0.16f, 3}, {.3f, .36f, .45f, .05f}, {1},
                     {{{0}, {2.4f, 2.2f, 1.9f, -1}, {0}}, /* a sun, a lamp, a spot */
                      {{-0.6f, 0.3f, 1.8f, 4}, {0.2f, 0.5f, 1.6f, -1}, {0}},
                      {{1.5f, 3, 1.5f, 9}, {9, 3, 1.5f, .93f}, {-.4f, -.8f, -.45f, .97f}}}}};
    gtx_show show = {.title = "engine_lighting", .width = 1280, .height = 720,
                     .camera = {{0.1f, 0.9f, 0}, .radius = 2.4f, .azimuth = 16, .elevation = 18,
                                .distance = 1.9f, .field = 40},
                     .load = load, .draw = draw, .user = &e};
    return gtx_sample_main(&show, argc, argv, &e.path);
}
