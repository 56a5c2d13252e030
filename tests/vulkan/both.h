/* What the tests of Vulkan share: OpenGL's stage and a Vulkan device, an asset in both, and the
 * pictures of the two compared. */
#ifndef GTX_TESTS_VULKAN_BOTH_H
#define GTX_TESTS_VULKAN_BOTH_H

#include "render/renderer.h" /* before headers of OpenGL */

#include "host/vulkan.h"
#include "render/lods.h"
#include "vulkan/device.h"

#include <geotex/vulkan.h>

enum { COUNT = 5, COLORS = GTX_PICTURE_COLORS };

static gtx_host_vulkan the_device;
static gtx_vk *vk;
static gtx_picture shown;

/* Of the stage's size; so many colours of one format. */
static inline gtx_picture picture_of(const gtx_host_vulkan *d, uint32_t colors, VkFormat format,
                              uint32_t pixel_size, VkSampleCountFlagBits samples)
{
    gtx_error error = {0};
    gtx_picture out;
    gtx_picture_desc desc = {.width = STAGE_WIDTH, .height = STAGE_HEIGHT, .color_count = colors,
                             .pixel_size = pixel_size, .samples = samples};
    for (uint32_t i = 0; i < colors; ++i)
        desc.colors[i] = format;
    must(gtx_picture_create(d, &desc, &out, &error), &error);
    return out;
}

/* OpenGL draws in the same way as Vulkan, on a GPU or not, whatever its own driver is. */
static inline int follow_vulkan(stage *s, gtx_error *error)
{
    const gtx_renderer_desc desc = {
        .load = gtx_offscreen_load, .log = stage_log,
        .tiles = vk->planner->tiles.max_texels ? GTX_TILES_ALWAYS : GTX_TILES_NEVER};
    gtx_renderer_destroy(s->renderer);
    if (gtx_renderer_create(&desc, &s->renderer, error))
        return -1;
    s->renderer->planner.on_gpu = vk->planner->on_gpu;
    return 0;
}

static inline int open_both(void **state)
{
    gtx_error error = {0};
    if (stage_open(state))
        return -1;
    gtx_host_vulkan *d = &the_device;
    if (gtx_host_vulkan_create(true, d, &error)) {
        fprintf(stderr, "%s\n", error.message);
        return 0; /* the tests skip */
    }
    fprintf(stderr, "validation layer: %s\n", d->validated ? "on" : "not installed");
    const gtx_vk_desc desc = {.load = d->load, .instance = d->instance,
                              .physical_device = d->physical, .device = d->device};
    if (gtx_vk_create(&desc, &vk, &error) || follow_vulkan(*state, &error)) {
        fprintf(stderr, "%s\n", error.message);
        return -1;
    }
    shown = picture_of(d, 1, VK_FORMAT_R8G8B8A8_UNORM, 4, 1);
    return 0;
}

static inline int close_both(void **state)
{
    gtx_host_vulkan *d = &the_device;
    if (vk) {
        gtx_vk_destroy(vk);
        gtx_picture_destroy(d, &shown);
    }
    gtx_host_vulkan_destroy(d);
    return stage_close(state) || d->complaints ? -1 : 0;
}

#define BOTH_OR_SKIP(state)                                                                        \
    STAGE_OR_SKIP(state);                                                                          \
    gtx_host_vulkan *d = &the_device;                                                             \
    if (!vk)                                                                                       \
        skip()

/* An asset in both. */
typedef struct pair {
    subject gl;
    gtx_model *model;
    gtx_vk_model *uploaded;
} pair;

static inline pair pair_open_as(stage *s, gtx_host_vulkan *d, gtx_asset *asset,
                                gtx_compression compress)
{
    gtx_error error = {0};
    pair p = {.gl = {.asset = asset}};
    gtx_model_desc desc = {.compress = compress};
    must(gtx_model_prepare(asset, &desc, &p.gl.model, &error), &error);
    must(gtx_model_upload(s->renderer, p.gl.model, 0, NULL, &error), &error);
    p.gl.instance.model = p.gl.model;
    memcpy(p.gl.instance.transform, identity, sizeof identity);
    desc.first_provokes = 1;
    must(gtx_model_prepare(asset, &desc, &p.model, &error), &error);
    must(gtx_host_vulkan_begin(d, &error), &error);
    must(gtx_vk_upload(vk, d->commands, p.model, &p.uploaded, &error), &error);
    must(gtx_host_vulkan_run(d, &error), &error);
    gtx_vk_uploaded(vk, p.uploaded);
    return p;
}

static inline pair pair_open(stage *s, gtx_host_vulkan *d, gtx_asset *asset)
{
    return pair_open_as(s, d, asset, GTX_COMPRESS_NONE);
}

static inline void pair_close(stage *s, pair *p)
{
    gtx_vk_model_destroy(vk, p->uploaded);
    gtx_model_free(p->model);
    subject_close(s, &p->gl);
}

/* How Vulkan draws it. */
typedef struct way {
    bool by_pass, y_up;
} way;

static inline void draw_by(gtx_host_vulkan *d, const gtx_picture *in, const pair *p,
                           const gtx_view *view, const gtx_instance *instances, uint32_t count,
                           way w)
{
    gtx_error error = {0};
    gtx_vk_instance placed[COUNT];
    gtx_vk_target target = {.render_pass = w.by_pass ? in->pass : VK_NULL_HANDLE,
                            .color_count = in->desc.color_count,
                            .depth_format = VK_FORMAT_D32_SFLOAT, .y_up = w.y_up,
                            .samples = in->desc.samples,
                            .view_mask = in->desc.views > 1 ? 3 : 0};
    const gtx_picture_clear clear = {.depth = view->flags & GTX_VIEW_REVERSED_Z ? 0.0f : 1.0f};
    memcpy(target.color_formats, in->desc.colors, sizeof target.color_formats);
    memset(placed, 0, sizeof placed);
    for (uint32_t i = 0; i < count; ++i)
        placed[i] = (gtx_vk_instance){p->uploaded, instances[i]};
    gtx_vk_next_frame(vk);
    must(gtx_host_vulkan_begin(d, &error), &error);
    gtx_picture_begin(d, in, w.by_pass, w.y_up, &clear);
    must(gtx_vk_draw(vk, d->commands, &target, view, placed, count, &error), &error);
    gtx_picture_end(d, in, w.by_pass);
    gtx_picture_read(d, in);
    must(gtx_host_vulkan_run(d, &error), &error);
}

/* The view, with clip z and y as Vulkan has them. */
static inline gtx_view for_vulkan(gtx_view view, gtx_camera camera, bool y_up)
{
    camera.zero_to_one = 1;
    const gtx_view clip = view_of(&camera);
    memcpy(view.projection, clip.projection, sizeof view.projection);
    view.flags |= GTX_VIEW_DEPTH_ZERO_TO_ONE;
    for (int k = 1; k < 16 && !y_up; k += 4)
        view.projection[k] = -view.projection[k];
    return view;
}

/* OpenGL's picture, with its own clip z, in the stage; then Vulkan's. */
static inline void expect_alike(stage *s, gtx_host_vulkan *d, const pair *p, gtx_camera camera,
                                gtx_view view, const gtx_instance *instances, uint32_t count,
                                way w, int one_in)
{
    size_t far = 0, apart = 0, covered = 0;
    stage_draw(s, &view, instances, count);
    const gtx_view own = for_vulkan(view, camera, w.y_up);
    const uint8_t *found = gtx_picture_bytes(&shown, 0);
    const float *depth = gtx_picture_bytes(&shown, GTX_PICTURE_DEPTH);
    draw_by(d, &shown, p, &own, instances, count, w);
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        int most = 0;
        for (int c = 0; c < 4; ++c) {
            const int difference = abs(found[4 * i + c] - s->color[4 * i + c]);
            most = difference > most ? difference : most;
        }
        far += view.pass == GTX_PASS_FORWARD && most > 2;
        apart += fabsf(depth[i] - s->depth[i]) > 1e-4f;
        covered += s->depth[i] > 0 && s->depth[i] < 1;
    }
    assert_true(covered > 1000);
    if (far * (size_t)one_in > STAGE_PIXELS || apart * 10000 > STAGE_PIXELS)
        fail_msg("%zu of %d pixels are more than 2 codes away, %zu in depth", far, STAGE_PIXELS,
                 apart);
}

/* Several, near and far, one mirrored. */
static inline void place(const gtx_model *model, float radius, gtx_instance instances[COUNT])
{
    static const float across[COUNT] = {0, -0.8f, 0.8f, -0.4f, 0.4f};
    memset(instances, 0, COUNT * sizeof *instances);
    for (int i = 0; i < COUNT; ++i) {
        instances[i].model = model;
        memcpy(instances[i].transform, identity, sizeof identity);
        instances[i].transform[0] = i == 2 ? -1.0f : 1.0f;
        instances[i].transform[12] = radius * across[i];
        instances[i].transform[14] = -1.2f * radius * (float)i;
        instances[i].tint[i % 3] = instances[i].tint[3] = 1;
        instances[i].tint[(i + 1) % 3] = 0.6f;
    }
}

#endif
