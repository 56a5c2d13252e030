/* An engine's own main by Vulkan: the picture is OpenGL's, by casting, tiles, LOD meshes and grids,
 * with constants of the engine's own, and the validation layer silent. */
#include "compile.h"

/* Where a point is, and the light of a lamp in it. */
static const char own_main[] =
    "#pragma geotex tiles\n"
    "#ifdef VULKAN\n"
    "layout(push_constant) uniform own { vec4 scale; };\n"
    "#else\n"
    "uniform vec4 scale;\n"
    "#endif\n"
    "layout(location = 0) out vec4 color;\n"
    "void main()\n"
    "{\n"
    "    gtx_surface s;\n"
    "    if (!gtx_find(s))\n"
    "        discard;\n"
    "    float light = max(dot(gtx_world_normal(s), vec3(0.6, 0.0, 0.8)), 0.0);\n"
    "    vec3 at = gtx_object_point(s) * scale.x + 0.5;\n"
    "    color = vec4(at * scale.y + light * scale.z * gtx_albedo(s).rgb, 1.0);\n"
    "    gtx_write_depth(s);\n"
    "}\n";

static const float scale[4] = {0.2f, 0.5f, 0.4f, 0};

static const VkPushConstantRange constants = {VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof scale};

/* A frame by the shading, in the order of for_vulkan's view. */
static void draw_shaded(gtx_host_vulkan *d, const pair *p, const gtx_vk_shading *shading,
                        const gtx_view *view, const gtx_instance *instances, uint32_t count)
{
    gtx_error error = {0};
    gtx_vk_instance placed[COUNT] = {{0}};
    const gtx_picture_clear clear = {.depth = 1};
    const PFN_vkGetDeviceProcAddr of =
        (PFN_vkGetDeviceProcAddr)d->load(d->instance, "vkGetDeviceProcAddr");
    const PFN_vkCmdPushConstants push =
        (PFN_vkCmdPushConstants)of(d->device, "vkCmdPushConstants");
    const gtx_vk_target target = {.render_pass = shown.pass, .color_count = 1,
                                  .color_formats = {shown.desc.colors[0]},
                                  .depth_format = VK_FORMAT_D32_SFLOAT, .y_up = 1};
    for (uint32_t i = 0; i < count; ++i)
        placed[i] = (gtx_vk_instance){p->uploaded, instances[i]};
    gtx_vk_next_frame(vk);
    must(gtx_host_vulkan_begin(d, &error), &error);
    gtx_picture_begin(d, &shown, true, true, &clear);
    push(d->commands, gtx_vk_shading_layout(shading), VK_SHADER_STAGE_FRAGMENT_BIT, 0,
         sizeof scale, scale);
    must(gtx_vk_draw_shaded(vk, d->commands, &target, view, shading, placed, count, &error),
         &error);
    gtx_picture_end(d, &shown, true);
    gtx_picture_read(d, &shown);
    must(gtx_host_vulkan_run(d, &error), &error);
}

static void expect_same(stage *s)
{
    const uint8_t *found = gtx_picture_bytes(&shown, 0);
    int far = 0, covered = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        int most = 0;
        for (int c = 0; c < 4; ++c) {
            const int difference = abs(found[4 * i + c] - s->color[4 * i + c]);
            most = difference > most ? difference : most;
        }
        far += most > 2;
        covered += s->color[4 * i + 3] == 255;
    }
    assert_true(covered > 1000);
    if (far * 10000 > STAGE_PIXELS)
        fail_msg("%d of %d pixels are more than 2 codes away", far, STAGE_PIXELS);
}

static void use(stage *s, const gtx_shading *shading)
{
    uint32_t programs[GTX_SHADING_PROGRAMS];
    const uint32_t count = gtx_shading_programs(shading, programs);
    for (uint32_t i = 0; i < count; ++i) {
        s->gl.UseProgram(programs[i]);
        s->gl.Uniform4fv(s->gl.GetUniformLocation(programs[i], "scale"), 1, scale);
    }
}

static void a_main_of_the_engines_own(void **state)
{
    BOTH_OR_SKIP(state);
    if (system("command -v glslangValidator >/dev/null"))
        skip();
    static const gtx_method methods[] = {GTX_METHOD_CAST, GTX_METHOD_CAST, GTX_METHOD_LOD,
                                         GTX_METHOD_GRID};
    gtx_error error = {0};
    gtx_shading *by_gl;
    gtx_instance instances[COUNT];
    compiled c = {.main = own_main};
    begin_compiling(&c);
    for (int without = 0; without < 2; ++without) {
        gtx_vk_shading *shading = NULL;
        c.no_tiles = without;
        const gtx_vk_shading_desc desc = {.fragment = compile, .user = &c,
                                          .push_constants = &constants,
                                          .push_constant_count = 1};
        pair p = pair_open(s, d, with_lod(fixture_sphere(2, 64, 8), 2, 3, 0));
        const gtx_camera camera = camera_around(p.gl.asset);
        place(p.gl.model, camera.radius, instances);
        s->renderer->planner.on_gpu = without; /* blocks, or grids */
        must(gtx_shading_create(s->renderer, own_main, &by_gl, &error), &error);
        must(gtx_vk_shading_create(vk, &desc, &shading, &error), &error);
        vk->own_planner->on_gpu = without;
        for (int i = 0; i < 8; ++i) {
            gtx_view view = view_of(&camera);
            view.method = methods[i / 2];
            view.viewport_height = STAGE_HEIGHT;
            view.viewport_width = i / 2 == 1 ? STAGE_WIDTH : 0;
            view.flags |= GTX_VIEW_SHADING_BY_TILES;
            view.shading = by_gl;
            use(s, by_gl);
            stage_draw(s, &view, instances, i % 2 ? COUNT : 1);
            view.shading = NULL;
            const gtx_view own = for_vulkan(view, camera, true);
            draw_shaded(d, &p, shading, &own, instances, i % 2 ? COUNT : 1);
            expect_same(s);
        }
        gtx_vk_shading_destroy(vk, shading);
        gtx_shading_destroy(s->renderer, by_gl);
        pair_close(s, &p);
    }
    s->renderer->planner.on_gpu = vk->own_planner->on_gpu = false;
    assert_int_equal(c.asked, 2 * 7);
    end_compiling(&c);
}

/* Beside it the stock main is drawn as before. */
static void misuse_is_refused(void **state)
{
    BOTH_OR_SKIP(state);
    if (system("command -v glslangValidator >/dev/null"))
        skip();
    gtx_error error = {0};
    gtx_vk_shading *shading = NULL;
    compiled c = {.main = own_main, .broken = true};
    gtx_vk_shading_desc desc = {.fragment = compile, .user = &c};
    assert_int_equal(gtx_vk_shading_create(vk, &desc, &shading, &error), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_vk_shading_create(vk, NULL, &shading, &error), GTX_ERROR_ARGUMENT);
    desc.set_layout_count = 1;
    assert_int_equal(gtx_vk_shading_create(vk, &desc, &shading, &error), GTX_ERROR_ARGUMENT);
    desc.set_layout_count = 0;
    desc.reserved[3] = 1;
    assert_int_equal(gtx_vk_shading_create(vk, &desc, &shading, &error), GTX_ERROR_NOT_ZEROED);
    desc.reserved[3] = 0;
    assert_null(shading);
    assert_null(gtx_vk_shading_layout(NULL));
    gtx_vk_shading_destroy(vk, NULL);
    c.broken = false;
    desc.push_constants = &constants;
    desc.push_constant_count = 1;
    begin_compiling(&c);
    must(gtx_vk_shading_create(vk, &desc, &shading, &error), &error);
    gtx_asset *asset = fixture_sphere(2, 64, 8);
    const gtx_camera camera = camera_around(asset);
    gtx_view view = for_vulkan(view_of(&camera), camera, true);
    const gtx_vk_target target = {.color_count = 1};
    view.pass = GTX_PASS_DEPTH;
    assert_int_equal(gtx_vk_draw_shaded(vk, d->commands, &target, &view, shading, NULL, 0, &error),
                     GTX_ERROR_ARGUMENT);
    view.pass = GTX_PASS_FORWARD;
    assert_int_equal(gtx_vk_draw_shaded(vk, d->commands, &target, &view, NULL, NULL, 0, &error),
                     GTX_ERROR_ARGUMENT);
    view.method = GTX_METHOD_PAPER;
    assert_int_equal(gtx_vk_draw_shaded(vk, d->commands, &target, &view, shading, NULL, 0, &error),
                     GTX_ERROR_ARGUMENT);
    view.method = GTX_METHOD_CAST;
    view.flags |= GTX_VIEW_BY_SAMPLES;
    assert_int_equal(gtx_vk_draw_shaded(vk, d->commands, &target, &view, shading, NULL, 0, &error),
                     GTX_ERROR_UNSUPPORTED);
    gtx_vk_shading_destroy(vk, shading);
    end_compiling(&c);
    gtx_close(asset);
}

static void the_layer_is_silent(void **state)
{
    BOTH_OR_SKIP(state);
    (void)s;
    assert_int_equal(d->complaints, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_main_of_the_engines_own),
        cmocka_unit_test(misuse_is_refused),
        cmocka_unit_test(the_layer_is_silent),
    };
    return cmocka_run_group_tests(tests, open_both, close_both);
}
