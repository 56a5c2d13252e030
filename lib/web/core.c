/* What geotex.js calls: geotex with handles and rows of numbers, for JavaScript knows no structs.
 * Built by emscripten alone; see web.mk. */
#include "web/core.h"

#include "asset/read.h"
#include "base/alloc.h"
#include "frame/model.h"
#include "render/renderer.h"

#include <geotex/render.h>

#include <emscripten/emscripten.h>
#include <emscripten/html5_webgl.h>

#include <math.h>
#include <string.h>

#define WEB_API EMSCRIPTEN_KEEPALIVE

/* ---- errors ---- */

/* Of the last call that failed. A page's calls come from one thread. */
static gtx_error last_error;

WEB_API int gtxw_result(void)
{
    return (int)last_error.result;
}

WEB_API const char *gtxw_message(void)
{
    return last_error.message;
}

gtx_error *gtxw_begin(void)
{
    memset(&last_error, 0, sizeof last_error);
    return &last_error;
}

/* ---- the renderer ---- */

/* Every function by its name, so that the page's glue holds no table of all of WebGL. Those that
 * WebGL 2 has not are not asked for. */
#define DECLARE(result, name, parameters) extern result gl##name parameters;
GTX_GL(DECLARE)
extern void glMultiDrawElementsWEBGL(gl_enum mode, const gl_size *counts, gl_enum type,
                                     const void *const *offsets, gl_size draws);

static gtx_gl_proc load(const char *name, void *user)
{
#define ROW(result, name, parameters) {"gl" #name, (gtx_gl_proc)gl##name},
    static const struct {
        const char *name;
        gtx_gl_proc proc;
    } table[] = {GTX_GL(ROW){"glMultiDrawElementsWEBGL", (gtx_gl_proc)glMultiDrawElementsWEBGL}};
    (void)user;
    for (size_t i = 0; i < sizeof table / sizeof *table; ++i)
        if (!strcmp(table[i].name, name))
            return table[i].proc;
    return NULL;
}

EM_JS(void, report_line, (const char *line), { Module['onLog'](UTF8ToString(line)); })

static void report(const char *message, void *user)
{
    (void)user;
    report_line(message);
}

/* Of the current context. 0 on failure, here and in all that return a pointer. */
WEB_API gtx_renderer *gtxw_renderer_create(void)
{
    const gtx_renderer_desc desc = {.load = load, .log = report};
    gtx_renderer *renderer = NULL;
    emscripten_webgl_enable_WEBGL_multi_draw(emscripten_webgl_get_current_context());
    gtx_renderer_create(&desc, &renderer, gtxw_begin());
    return renderer;
}

WEB_API void gtxw_renderer_destroy(gtx_renderer *renderer)
{
    gtx_renderer_destroy(renderer);
}

/* With `later` its programs are compiled when something is first drawn by them. */
WEB_API gtx_shading *gtxw_shading_create(gtx_renderer *renderer, const char *text, int later)
{
    gtx_shading *shading = NULL;
    (later ? gtx_shading_begin : gtx_shading_create)(renderer, text, &shading, gtxw_begin());
    return shading;
}

WEB_API void gtxw_shading_destroy(gtx_renderer *renderer, gtx_shading *shading)
{
    gtx_shading_destroy(renderer, shading);
}

/* The name of one of the shading's programs, 0 behind the last. */
WEB_API uint32_t gtxw_shading_program(const gtx_shading *shading, uint32_t i)
{
    uint32_t programs[GTX_SHADING_PROGRAMS];
    return i < gtx_shading_programs(shading, programs) ? programs[i] : 0;
}

/* ---- assets ---- */

WEB_API gtx_asset *gtxw_open(const void *bytes, size_t size)
{
    gtx_asset *asset = NULL;
    gtx_open_memory(bytes, size, NULL, &asset, gtxw_begin());
    return asset;
}

/* Of a file's first bytes, and of two pieces behind them, or none, one after the other in `more`:
 * `places` has the number of the first byte of each, and its size. 0 without an error where they
 * show nothing yet. `told` gets how many show more, 0 for a whole file, and the file's size, 0
 * while that is not known. */
WEB_API gtx_asset *gtxw_open_prefix(const void *bytes, size_t size, const uint8_t *more,
                                    const double *places, double told[2])
{
    const gtx_read_options options = {.allocator = gtx_allocator_or_default(NULL)};
    gtx_file_part pieces[2] = {{NULL, 0, 0}};
    for (int i = 0; i < 2 && more; ++i) {
        pieces[i] = (gtx_file_part){more, (uint64_t)places[2 * i], (uint64_t)places[2 * i + 1]};
        more += pieces[i].size;
    }
    gtx_asset *asset = NULL;
    gtx_prefix prefix = {0};
    gtx_read_prefix(gtxw_begin(), &options, bytes, size, pieces, more ? 2 : 0, &prefix,
                    &asset);
    told[0] = (double)prefix.needed;
    told[1] = (double)prefix.file_size;
    return asset;
}

WEB_API void gtxw_close(gtx_asset *asset)
{
    gtx_close(asset);
}

/* In the order that inside.js names them in. Valid until the next call. */
WEB_API const double *gtxw_info(const gtx_asset *asset)
{
    static double out[24];
    gtx_info i;
    gtx_lod_mesh finest = {0};
    gtx_get_info(asset, &i);
    if (i.lod_levels)
        gtx_get_lod_mesh(asset, 0, &finest);
    const double numbers[] = {
        i.patch_count, i.page_count, i.page_width, i.page_height, i.mip_count, i.height_bits,
        i.has_color, i.has_material, i.has_emission, i.lod_levels, (double)i.source_triangles,
        (double)i.unit, (double)i.bounds_min[0], (double)i.bounds_min[1], (double)i.bounds_min[2],
        (double)i.bounds_max[0], (double)i.bounds_max[1], (double)i.bounds_max[2], i.anchor[0],
        i.anchor[1], i.anchor[2], (double)i.file_size, (double)finest.error,
        finest.normals ? (double)finest.normal_error : HUGE_VAL};
    _Static_assert(sizeof numbers == sizeof out, "one place each");
    memcpy(out, numbers, sizeof out);
    return out;
}

WEB_API gtx_caster *gtxw_caster_create(const gtx_asset *asset)
{
    gtx_caster *caster = NULL;
    gtx_caster_create(asset, NULL, &caster, gtxw_begin());
    return caster;
}

WEB_API void gtxw_caster_destroy(gtx_caster *caster)
{
    gtx_caster_destroy(caster);
}

/* `ray`: origin and least t, direction and greatest t, 0 for infinity. Gives t, normal, facet,
 * colour (rgba, linear); t is infinite where nothing is hit. Valid until the next call. */
WEB_API const float *gtxw_raycast(const gtx_caster *caster, const gtx_asset *asset,
                                  const float *ray, int two_sided)
{
    static float out[11];
    gtx_ray cast;
    gtx_hit hit;
    memcpy(&cast, ray, sizeof cast);
    gtx_raycast(caster, &cast, &hit, 1, two_sided ? GTX_RAY_TWO_SIDED : 0);
    out[0] = hit.t;
    memcpy(out + 1, hit.normal, sizeof hit.normal);
    memcpy(out + 4, hit.facet, sizeof hit.facet);
    gtx_hit_colors(asset, &hit, (float(*)[4])(out + 7), 1);
    return out;
}

/* ---- models ---- */

/* Maps are the asset's, which stays until all is sent: gtxw_model_sent. Of rasterizers in software
 * LOD meshes are lit at their vertices, and triangles that face away are left out. */
WEB_API gtx_model *gtxw_model_prepare(const gtx_asset *asset, int software)
{
    const gtx_model_desc desc = {.borrow = 1, .light_vertices = software != 0};
    gtx_model *model = NULL;
    gtx_model_prepare(asset, &desc, &model, gtxw_begin());
    if (model && software)
        gtx_lod_find_faces(&model->allocator, &model->lods);
    return model;
}

WEB_API void gtxw_model_destroy(gtx_renderer *renderer, gtx_model *model)
{
    gtx_model_destroy(renderer, model);
}

WEB_API double gtxw_model_gpu_bytes(const gtx_model *model)
{
    const gtx_model_size size = gtx_model_gpu_size(model);
    return (double)(size.geometry + size.color);
}

/* ---- drawing ---- */

enum { MAX_AT_ONCE = 256 };

/* `view`: both matrices, light and ambient, max_error. `whole`: method, flags, width, height, pass,
 * level. An instance has 20 numbers: its matrix and its tint. Returns a gtx_result, or -1 where
 * the shading has programs now that it lacked: then all is to be drawn again. */
WEB_API int gtxw_draw(gtx_renderer *renderer, const float *view, const uint32_t *whole,
                      gtx_shading *shading, gtx_model *const *models, const float *instances,
                      uint32_t count)
{
    static gtx_instance placed[MAX_AT_ONCE];
    gtx_view v = {.method = (gtx_method)whole[0], .flags = whole[1], .viewport_width = whole[2],
                  .viewport_height = whole[3], .pass = (gtx_pass)whole[4], .level = whole[5],
                  .shading = shading, .max_error = view[36], .ambient = view[35]};
    memcpy(v.view, view, sizeof v.view);
    memcpy(v.projection, view + 16, sizeof v.projection);
    memcpy(v.light_direction, view + 32, sizeof v.light_direction);
    uint32_t lacking = 0;
    for (uint32_t first = 0; first < count; first += MAX_AT_ONCE) {
        uint32_t n = count - first < MAX_AT_ONCE ? count - first : MAX_AT_ONCE;
        for (uint32_t i = 0; i < n; ++i) {
            const float *numbers = instances + 20 * (size_t)(first + i);
            placed[i] = (gtx_instance){.model = models[first + i], .id = first + i};
            memcpy(placed[i].transform, numbers, sizeof placed[i].transform);
            memcpy(placed[i].tint, numbers + 16, sizeof placed[i].tint);
        }
        if (gtx_draw(renderer, &v, placed, n, gtxw_begin()))
            return (int)last_error.result;
        lacking |= renderer->lacking;
    }
    if (lacking && gtx_shading_compile(renderer, shading, lacking, gtxw_begin()))
        return (int)last_error.result;
    return lacking ? -1 : 0;
}
