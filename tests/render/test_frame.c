/* frame.h alone, submitted through the interface of samples/rhi.h, draws what render.h draws: bit
 * for bit, by every method and pass. */
#include "render/renderer.h"
#include "lods.h"

#include "../../samples/rhi_submit.h"

enum { COUNT = 5 };

static uint8_t expected_color[4 * STAGE_PIXELS];
static float expected_depth[STAGE_PIXELS];

/* The interface has no blocks that a GPU displaces. */
static int open_for_grids(void **state)
{
    const int result = stage_open(state);
    if (!result && the_stage.offscreen)
        the_stage.renderer->planner.on_gpu = false;
    return result;
}

/* What submits. */
typedef struct engine {
    gtx_planner *planner;
    gtx_model *model;
    rhi_model uploaded;
    rhi_frames frames;
    uint32_t draws[4];        /* by the buffer of their vertices; [1]: of several ranges */
} engine;

static void open_engine(engine *e, const gtx_asset *asset)
{
    gtx_error error = {0};
    memset(e, 0, sizeof *e);
    rhi_create(&e->frames.r, gtx_offscreen_load, NULL);
    must(gtx_planner_create(NULL, &e->planner, &error), &error);
    must(gtx_model_prepare(asset, NULL, &e->model, &error), &error);
    rhi_upload(&e->frames.r, e->model, &e->uploaded);
    e->frames.model = &e->uploaded;
}

static void close_engine(stage *s, engine *e)
{
    s->gl.DeleteTextures(GTX_SLOT_COUNT, e->uploaded.textures);
    s->gl.DeleteBuffers(GTX_BUFFER_GRID_VERTICES, e->uploaded.buffers);
    for (uint32_t i = 0; i < GTX_PIPELINE_COUNT; ++i)
        s->gl.DeleteProgram(e->frames.pipelines[i]);
    gtx_planner_destroy(e->planner);
    gtx_model_free(e->model);
}

static void submit(const gtx_frame_draw *draw, void *user)
{
    engine *e = user;
    gtx_pipeline pipeline;
    assert_true(gtx_pipeline_get(draw->pipeline, &pipeline));
    assert_int_equal(pipeline.vertices, draw->vertices);
    assert_false(pipeline.own_main);
    assert_ptr_equal(draw->model, e->model);
    ++e->draws[draw->vertices == GTX_BUFFER_GRID_VERTICES ? 3 : (int)draw->vertices];
    e->draws[1] += draw->range_count > 1;
    rhi_submit(draw, &e->frames);
}

static void draw_by(stage *s, engine *e, const gtx_view *view, const gtx_instance *instances,
                    uint32_t count)
{
    gtx_instance own[COUNT];
    gtx_frame frame;
    gtx_error error = {0};
    memcpy(own, instances, count * sizeof *own);
    for (uint32_t i = 0; i < count; ++i)
        own[i].model = e->model;
    must(gtx_frame_begin(e->planner, view, own, count, &frame, &error), &error);
    assert_int_equal(frame.instance_count, count);
    rhi_fill(&e->frames.r, &e->frames.instances, frame.instances,
             count * sizeof *frame.instances);
    stage_clear(s, view);
    s->gl.Enable(GL_DEPTH_TEST);
    s->gl.DepthFunc(frame.nearer_is_greater ? GL_GREATER : GL_LESS);
    gtx_frame_draws(e->planner, submit, e);
    assert_int_equal(s->gl.GetError(), GL_NO_ERROR);
    gtx_framebuffer_read_color(&s->gl, &s->framebuffer, s->color);
    gtx_framebuffer_read_depth(&s->gl, &s->framebuffer, s->depth);
}

static int covered(const stage *s)
{
    int count = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i)
        count += s->depth[i] != 1;
    return count;
}

/* Several, far and near, one of them mirrored. */
static void place_instances(const gtx_model *model, float radius, gtx_instance instances[COUNT])
{
    static const float across[COUNT] = {0, -0.8f, 0.8f, -0.4f, 0.4f};
    memset(instances, 0, COUNT * sizeof *instances);
    for (int i = 0; i < COUNT; ++i) {
        instances[i].model = model;
        instances[i].id = (uint32_t)i;
        memcpy(instances[i].transform, identity, sizeof identity);
        instances[i].transform[0] = i == 2 ? -1.0f : 1.0f;
        instances[i].transform[12] = radius * across[i];
        instances[i].transform[14] = -1.2f * radius * (float)i;
    }
}

static void expect_the_same(stage *s, gtx_asset *asset, uint32_t ways)
{
    gtx_instance instances[COUNT];
    subject shown = subject_open(s, asset);
    engine e;
    open_engine(&e, asset);
    gtx_camera camera = camera_around(asset);
    place_instances(shown.model, camera.radius, instances);
    for (int i = 0; i < 2 * (GTX_METHOD_GRID + 1) * 2; ++i) {
        camera.reversed_z = camera.zero_to_one = 0;
        camera.distance = i & 1 ? 0.8f : 3.1f; /* so near that much is out of view */
        gtx_view view = view_of(&camera);
        view.pass = i & 2 ? GTX_PASS_DEPTH : GTX_PASS_FORWARD;
        view.method = (gtx_method)(i / 4);
        view.viewport_height = STAGE_HEIGHT;
        view.max_error = i & 1 ? 0.02f : 0; /* the finest LOD mesh, which has several runs */
        if (view.method == GTX_METHOD_LOD && !(ways & 1u << GTX_BUFFER_LOD_VERTICES))
            continue;
        for (uint32_t count = 1; count <= COUNT; count += COUNT - 1) {
            stage_draw(s, &view, instances, count);
            memcpy(expected_color, s->color, sizeof s->color);
            memcpy(expected_depth, s->depth, sizeof s->depth);
            draw_by(s, &e, &view, instances, count);
            assert_in_range(covered(s), i & 1 ? 20000 : 2000, STAGE_PIXELS);
            assert_memory_equal(expected_depth, s->depth, sizeof s->depth);
            if (view.pass == GTX_PASS_FORWARD)
                assert_memory_equal(expected_color, s->color, sizeof s->color);
        }
    }
    for (int k = 0; k < 4; ++k)
        assert_true(!(ways & 1u << k) || e.draws[k]);
    close_engine(s, &e);
    subject_close(s, &shown);
}

static void an_engine_of_its_own_draws_the_same(void **state)
{
    STAGE_OR_SKIP(state);
    if (getenv("GEOTEX_ES"))
        skip(); /* the interface is of OpenGL */
    expect_the_same(s, fixture_sphere(2, 64, 16), 8 + 2 + 1);
    expect_the_same(s, with_lod(fixture_sphere(2, 64, 8), 2, 3, 0), 8 + 4 + 2 + 1);
    expect_the_same(s, with_lod(fixture_sphere(2, 64, 8), 2, 3, GTX_PATCH_TWO_SIDED),
                    8 + 4 + 2 + 1);
}

/* Every draw stays within the bytes that the model, or the draw, has. */
static void check(const gtx_frame_draw *d, void *user)
{
    const uint64_t *sizes = user;
    const bool grid = d->vertices == GTX_BUFFER_GRID_VERTICES;
    if (d->indices == GTX_BUFFER_PROXY_INDICES && d->index_size)
        assert_int_equal(d->index_size, sizes[GTX_BUFFER_PROXY_VERTICES] / 16 < 65535 ? 2 : 4);
    const uint64_t indices = grid ? d->index_bytes : sizes[d->indices];
    assert_in_range(d->first_instance + d->instance_count, 1, COUNT);
    for (uint32_t i = 0; i < d->range_count; ++i) {
        const gtx_range *r = &d->ranges[i];
        assert_true(r->count > 0 && r->count % 3 == 0);
        assert_true(d->index_offset + (r->first + (uint64_t)r->count) * d->index_size <= indices);
        if (d->vertices == GTX_BUFFER_LOD_VERTICES)
            assert_true(d->vertex_offset +
                            d->vertex_size * (r->base_vertex + (uint64_t)r->vertex_count) <=
                        sizes[d->vertices]);
    }
}

static void models_and_draws_fit(void **state)
{
    (void)state;
    gtx_error error = {0};
    gtx_asset *asset = with_lod(fixture_sphere(2, 64, 8), 2, 3, 0);
    gtx_planner *planner;
    gtx_model *model;
    gtx_texture t;
    gtx_frame frame;
    gtx_instance instances[COUNT];
    uint64_t sizes[GTX_BUFFER_GRID_VERTICES], all = 0;
    must(gtx_planner_create(NULL, &planner, &error), &error);
    must(gtx_model_prepare(asset, NULL, &model, &error), &error);
    for (int b = 0; b < GTX_BUFFER_GRID_VERTICES; ++b) {
        assert_non_null(gtx_model_buffer(model, (gtx_buffer)b, &sizes[b]));
        all += sizes[b];
    }
    for (int slot = 0; slot < GTX_SLOT_COUNT; ++slot) {
        const uint32_t has = gtx_model_texture(model, (gtx_slot)slot, &t);
        assert_int_equal(has, t.levels > 0);
        for (uint32_t k = 0; k < t.levels; ++k) {
            assert_non_null(t.texels[k]);
            const uint64_t width = t.width >> k, height = t.height >> k;
            all += t.layers * (t.block_size
                                   ? (width + 3) / 4 * ((height + 3) / 4) * t.block_size
                                   : width * height * t.texel_size);
        }
    }
    const gtx_model_size size = gtx_model_gpu_size(model);
    assert_int_equal(all, size.geometry + size.color);
    gtx_model_uploaded(model);
    assert_true(gtx_model_texture(model, GTX_SLOT_CELLS, &t) && !t.texels[0]);
    assert_null(gtx_model_buffer(model, GTX_BUFFER_LOD_VERTICES, NULL));

    gtx_camera camera = camera_around(asset);
    gtx_view view = view_of(&camera);
    view.viewport_height = STAGE_HEIGHT;
    place_instances(model, camera.radius, instances);
    for (int method = 0; method <= GTX_METHOD_GRID; ++method) {
        view.method = (gtx_method)method;
        must(gtx_frame_begin(planner, &view, instances, COUNT, &frame, &error), &error);
        gtx_frame_draws(planner, check, sizes);
    }
    instances[2].transform[3] = 1;
    assert_int_equal(gtx_frame_begin(planner, &view, instances, COUNT, &frame, &error),
                     GTX_ERROR_ARGUMENT);
    gtx_frame_draws(planner, check, NULL); /* there is no frame */
    assert_int_equal(gtx_frame_begin(NULL, &view, instances, 1, &frame, &error),
                     GTX_ERROR_ARGUMENT);
    gtx_planner_destroy(planner);
    gtx_model_free(model);
    gtx_close(asset);
}

static void pipelines_have_shaders(void **state)
{
    (void)state;
    const char *texts[GTX_MAX_SHADER_TEXTS];
    gtx_pipeline p;
    uint32_t found = 0, own = 0;
    for (uint32_t i = 0; i < GTX_PIPELINE_COUNT + 5; ++i) {
        if (!gtx_pipeline_get(i, &p))
            continue;
        ++found;
        own += p.own_main;
        for (int k = 0; k < 2; ++k) {
            assert_true(gtx_pipeline_source(i, (gtx_stage)k, "void main() {}", texts) > 4);
            assert_int_equal(gtx_pipeline_source(i, (gtx_stage)k, NULL, texts) > 0,
                             !p.own_main);
        }
    }
    assert_int_equal(own, 7);
    assert_in_range(found, 40, 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_engine_of_its_own_draws_the_same),
        cmocka_unit_test(models_and_draws_fit),
        cmocka_unit_test(pipelines_have_shaders),
    };
    return cmocka_run_group_tests(tests, open_for_grids, stage_close);
}
