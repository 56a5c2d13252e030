/* Passes: depth alone, ids and a G-buffer, without a word from the context. */
#include "host/target.h"
#include "look.h"
#include "lods.h"
#include "witness.h"

enum { COUNT = 3, IDS_COUNT = 4 * STAGE_PIXELS };
static const uint32_t ids[COUNT] = {7, UINT32_MAX, 70000};

/* Three instances of an asset, one of them mirrored. */
static void place_three(const subject *shown, gtx_instance out[COUNT])
{
    for (int i = 0; i < COUNT; ++i) {
        const float size = 0.5f + 0.2f * (float)i;
        out[i] = shown->instance;
        out[i].id = ids[i];
        out[i].transform[0] = i == 1 ? -size : size;
        out[i].transform[5] = out[i].transform[10] = size;
        out[i].transform[12] = 1.6f * (float)i - 1.5f;
        out[i].transform[13] = 0.4f * (float)i;
    }
}

static gtx_view look_at_three(int i)
{
    const gtx_camera camera = {.radius = 3.4f, .azimuth = 25, .elevation = 20, .distance = 2.5f,
                               .orthographic = i & 1, .reversed_z = i >> 1 & 1};
    gtx_view view = view_of(&camera);
    view.viewport_height = STAGE_HEIGHT;
    view.max_error = i & 4 ? 8 : 0.5f;
    return view;
}

/* Rows of a target's colour from the top, as gtx_framebuffer_read_color has them. */
static void read_target(stage *s, GLenum attachment, GLenum format, GLenum type, void *out)
{
    const size_t row = (type == GL_UNSIGNED_INT ? 16u : 4u) * STAGE_WIDTH;
    s->gl.ReadBuffer(attachment);
    for (int y = 0; y < STAGE_HEIGHT; ++y)
        s->gl.ReadPixels(0, STAGE_HEIGHT - 1 - y, STAGE_WIDTH, 1, format, type,
                         (char *)out + (size_t)y * row);
}

static void depth_alone_is_the_same_depth(void **state)
{
    STAGE_OR_SKIP(state);
    static float expected[STAGE_PIXELS];
    static const gtx_method methods[] = {GTX_METHOD_CAST, GTX_METHOD_LOD, GTX_METHOD_CAST,
                                         GTX_METHOD_LOD, GTX_METHOD_CAST, GTX_METHOD_PAPER,
                                         GTX_METHOD_LOD, GTX_METHOD_AUTO};
    subject shown[2] = {subject_open(s, with_lod(fixture_sphere(2, 64, 8), 2, 2, 0)),
                        subject_open(s, fixture_bumpy(16, GTX_PATCH_TWO_SIDED))};
    for (int i = 0; i < 16; ++i) {
        gtx_instance three[COUNT];
        gtx_view view = look_at_three(i);
        place_three(&shown[i / 8], three);
        view.method = i < 8 ? methods[i] : i == 13 ? GTX_METHOD_PAPER : GTX_METHOD_CAST;
        stage_draw(s, &view, three, COUNT);
        memcpy(expected, s->depth, sizeof expected);
        view.pass = GTX_PASS_DEPTH;
        stage_draw(s, &view, three, COUNT);
        assert_memory_equal(expected, s->depth, sizeof expected);
        long drawn = 0;
        for (int p = 0; p < STAGE_PIXELS; ++p) {
            drawn += s->depth[p] > 0 && s->depth[p] < 1;
            assert_int_equal(s->color[4 * p + 3], 0);
        }
        assert_true(drawn > 1000);
    }
    subject_close(s, &shown[0]);
    subject_close(s, &shown[1]);
}

/* What the caster sees at a window position: id, patch and cell, or an id that is nobody's. */
static void expect_id(const gtx_caster *caster, const gtx_asset *asset, const gtx_view *view,
                      const gtx_instance *instances, double x, double y, uint32_t out[4])
{
    double nearest = 2;
    out[0] = 5;
    for (int i = 0; i < COUNT; ++i) {
        const matrix clip = matrix_mul(
            matrix_mul(matrix_of(view->projection), matrix_of(view->view)),
            matrix_of(instances[i].transform));
        const matrix back = matrix_inverse(clip);
        double a[3], b[3], at[3], ndc[3];
        matrix_point(back, (double[3]){2 * x / STAGE_WIDTH - 1, 1 - 2 * y / STAGE_HEIGHT, -1}, a);
        matrix_point(back, (double[3]){2 * x / STAGE_WIDTH - 1, 1 - 2 * y / STAGE_HEIGHT, 1}, b);
        gtx_ray ray = {.t_max = 1};
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = (float)a[k];
            ray.direction[k] = (float)(b[k] - a[k]);
        }
        gtx_hit hit;
        assert_int_equal(gtx_raycast(caster, &ray, &hit, 1, 0), GTX_OK);
        if (hit.patch == UINT32_MAX)
            continue;
        for (int k = 0; k < 3; ++k)
            at[k] = ray.origin[k] + hit.t * (double)ray.direction[k];
        matrix_point(clip, at, ndc);
        if (ndc[2] >= nearest)
            continue;
        nearest = ndc[2];
        const uint16_t *rect = gtx_patches(asset)[hit.patch].rect;
        out[0] = instances[i].id;
        out[1] = hit.patch;
        out[2] = (uint32_t)fminf(hit.x, (float)rect[2] - 2);
        out[3] = (uint32_t)fminf(hit.y, (float)rect[3] - 2);
    }
}

/* At random pixels. One is excluded when a ray less than 1/70 pixel away agrees, as where cells or
 * patches meet. */
static void ids_are_those_of_the_caster(void **state)
{
    STAGE_OR_SKIP(state);
    static uint32_t drawn[IDS_COUNT];
    const GLuint nothing[4] = {5, 5, 5, 5};
    gtx_error error = {0};
    gtx_target target;
    gtx_caster *caster;
    gtx_instance three[COUNT];
    subject shown = subject_open(s, fixture_sphere(2, 64, 8));
    place_three(&shown, three);
    must(gtx_caster_create(shown.asset, NULL, &caster, &error), &error);
    must(gtx_target_create(&s->gl, STAGE_WIDTH, STAGE_HEIGHT, (GLenum[]){GL_RGBA32UI, 0}, &target,
                           &error), &error);
    long hits = 0, excluded = 0;
    for (int i = 0; i < 2; ++i) {
        gtx_view view = look_at_three(i);
        view.viewport_height = 0; /* level 0, as the caster's */
        view.pass = GTX_PASS_ID;
        s->gl.ClearDepthf(1);
        s->gl.Clear(GL_DEPTH_BUFFER_BIT);
        s->gl.ClearBufferuiv(GL_COLOR, 0, nothing);
        must(gtx_draw(s->renderer, &view, three, COUNT, &error), &error);
        read_target(s, GL_COLOR_ATTACHMENT0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, drawn);
        uint32_t random = 1;
        for (int n = 0; n < 3000; ++n) {
            random = random * 1664525 + 1013904223;
            const int p = (int)((random >> 8) % STAGE_PIXELS);
            const double x = p % STAGE_WIDTH + 0.5, y = p / STAGE_WIDTH + 0.5;
            uint32_t expected[4] = {5, 5, 5, 5};
            int agrees_here = 0, k = 0;
            for (; k < 10 && !agrees_here; ++k) {
                const double dx = k ? 0.01 * ((k - 1) % 3 - 1) : 0;
                const double dy = k ? 0.01 * ((k - 1) / 3 - 1) : 0;
                expected[1] = expected[2] = expected[3] = 5;
                expect_id(caster, shown.asset, &view, three, x + dx, y + dy, expected);
                agrees_here = !memcmp(expected, &drawn[4 * p], sizeof expected);
            }
            hits += drawn[4 * p] != 5;
            excluded += k > 1;
            if (!agrees_here)
                fail_msg("pixel %d: %u %u %u %u, not %u %u %u %u", p, drawn[4 * p],
                         drawn[4 * p + 1], drawn[4 * p + 2], drawn[4 * p + 3], expected[0],
                         expected[1], expected[2], expected[3]);
        }
    }
    assert_true(hits > 1000 && excluded * 20 < hits);
    gtx_target_destroy(&s->gl, &target);
    gtx_caster_destroy(caster);
    subject_close(s, &shown);
}

/* By the LOD mesh the instance is the same, and but for the rims of patches the patch and its
 * cell. */
static void ids_of_the_lod(void **state)
{
    STAGE_OR_SKIP(state);
    static uint32_t drawn[2][IDS_COUNT];
    const GLuint nothing[4] = {5, 5, 5, 5};
    gtx_error error = {0};
    gtx_target target;
    gtx_instance three[COUNT];
    subject shown = subject_open(s, with_lod(fixture_sphere(2, 64, 8), 2, 2, 0));
    place_three(&shown, three);
    gtx_view view = look_at_three(0);
    view.pass = GTX_PASS_ID;
    must(gtx_target_create(&s->gl, STAGE_WIDTH, STAGE_HEIGHT, (GLenum[]){GL_RGBA32UI, 0}, &target,
                           &error), &error);
    for (int i = 0; i < 2; ++i) {
        view.method = i ? GTX_METHOD_LOD : GTX_METHOD_CAST;
        s->gl.Clear(GL_DEPTH_BUFFER_BIT);
        s->gl.ClearBufferuiv(GL_COLOR, 0, nothing);
        must(gtx_draw(s->renderer, &view, three, COUNT, &error), &error);
        read_target(s, GL_COLOR_ATTACHMENT0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, drawn[i]);
    }
    long both = 0, instances = 0, patches = 0, cells = 0;
    for (int p = 0; p < IDS_COUNT; p += 4) {
        const uint32_t *a = &drawn[0][p], *b = &drawn[1][p];
        if (a[0] == 5 || b[0] == 5)
            continue;
        const int same = a[0] == b[0] && a[1] == b[1];
        ++both;
        instances += a[0] == b[0];
        patches += same;
        cells += same && abs((int)(a[2] - b[2])) < 3 && abs((int)(a[3] - b[3])) < 3;
    }
    assert_true(both > 5000 && instances * 100 > both * 98);
    assert_true(patches * 100 > both * 85 && cells * 100 > patches * 85);
    gtx_target_destroy(&s->gl, &target);
    subject_close(s, &shown);
}

static double to_linear(double srgb)
{
    return srgb <= 0.04045 ? srgb / 12.92 : pow((srgb + 0.055) / 1.055, 2.4);
}

static double to_srgb(double c)
{
    return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055;
}

static void g_buffer_shades_as_forward(stage *s, gtx_method method)
{
    static uint8_t albedo[4 * STAGE_PIXELS];
    static uint32_t normal[STAGE_PIXELS];
    gtx_error error = {0};
    gtx_target target;
    gtx_instance three[COUNT];
    subject shown = subject_open(s, with_lod(fixture_sphere(2, 64, 8), 2, 2, 0));
    place_three(&shown, three);
    gtx_view view = look_at_three(0);
    view.method = method;
    memcpy(view.light_direction, (float[3]){0.6f, 0, 0.8f}, sizeof view.light_direction);
    view.ambient = 0.25f;
    stage_draw(s, &view, three, COUNT);
    const GLenum formats[] = {GL_RGBA8, GL_RGB10_A2, GL_RGBA8, 0};
    must(gtx_target_create(&s->gl, STAGE_WIDTH, STAGE_HEIGHT, formats, &target, &error), &error);
    s->gl.ClearColor(0, 0, 0, 0);
    s->gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    view.pass = GTX_PASS_GBUFFER;
    must(gtx_draw(s->renderer, &view, three, COUNT, &error), &error);
    read_target(s, GL_COLOR_ATTACHMENT0, GL_RGBA, GL_UNSIGNED_BYTE, albedo);
    read_target(s, GL_COLOR_ATTACHMENT1, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV, normal);
    long checked = 0, stray = 0;
    for (int p = 0; p < STAGE_PIXELS; ++p) {
        assert_int_equal(albedo[4 * p + 3] > 0, s->color[4 * p + 3] > 0);
        if (!albedo[4 * p + 3])
            continue;
        double n[3];
        for (int k = 0; k < 3; ++k)
            n[k] = (normal[p] >> 10 * k & 1023) / 1023.0 * 2 - 1;
        assert_true(fabs(sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) - 1) < 0.004);
        const double share = 0.25 + 0.75 * fmax(0.6 * n[0] + 0.8 * n[2], 0);
        double off = 0;
        for (int k = 0; k < 3; ++k) {
            const double lit = 255 * to_srgb(share * to_linear(albedo[4 * p + k] / 255.0));
            off = fmax(off, fabs(lit - s->color[4 * p + k]));
        }
        assert_true(off < 16);
        stray += off >= 2; /* along the outline, where a mip level has lost the sphere's bend */
        ++checked;
    }
    assert_true(checked > 1000);
    assert_true(stray < checked / 100);
    gtx_target_destroy(&s->gl, &target);
    subject_close(s, &shown);
}

static void g_buffer_by_casting(void **state)
{
    STAGE_OR_SKIP(state);
    g_buffer_shades_as_forward(s, GTX_METHOD_CAST);
}

static void g_buffer_by_the_lod(void **state)
{
    STAGE_OR_SKIP(state);
    g_buffer_shades_as_forward(s, GTX_METHOD_LOD);
}

static void g_buffer_holds_the_material(void **state)
{
    STAGE_OR_SKIP(state);
    static const look enamel = {{180, 120, 60, 255}, {200, 90, 30, 255}, {20, 200, 90}};
    static uint8_t map[2][4 * STAGE_PIXELS];
    gtx_error error = {0};
    gtx_target target;
    subject shown = subject_open(s, repaint(fixture_sphere(2, 48, 8), &enamel));
    const gtx_camera camera = camera_around(shown.asset);
    gtx_view view = view_of(&camera);
    const GLenum formats[] = {GL_RGBA8, GL_RGBA8, GL_RGBA8, GL_RGBA8};
    must(gtx_target_create(&s->gl, STAGE_WIDTH, STAGE_HEIGHT, formats, &target, &error), &error);
    s->gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    view.pass = GTX_PASS_GBUFFER;
    must(gtx_draw(s->renderer, &view, &shown.instance, 1, &error), &error);
    read_target(s, GL_COLOR_ATTACHMENT2, GL_RGBA, GL_UNSIGNED_BYTE, map[0]);
    read_target(s, GL_COLOR_ATTACHMENT3, GL_RGBA, GL_UNSIGNED_BYTE, map[1]);
    const int middle = 4 * (STAGE_HEIGHT / 2 * STAGE_WIDTH + STAGE_WIDTH / 2);
    for (int k = 0; k < 3; ++k) {
        assert_int_equal(map[0][middle + k], enamel.material[k]);
        assert_in_range(map[1][middle + k] + 1, 255 * to_linear(enamel.emission[k] / 255.0) - 1,
                        255 * to_linear(enamel.emission[k] / 255.0) + 3);
    }
    assert_int_equal(map[0][middle + 3], 255);
    gtx_target_destroy(&s->gl, &target);
    subject_close(s, &shown);
}

static void nobody_complained(void **state)
{
    STAGE_OR_SKIP(state);
    expect_no_complaint(s, 31);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(depth_alone_is_the_same_depth),
        cmocka_unit_test(ids_are_those_of_the_caster),
        cmocka_unit_test(ids_of_the_lod),
        cmocka_unit_test(g_buffer_by_casting),
        cmocka_unit_test(g_buffer_by_the_lod),
        cmocka_unit_test(g_buffer_holds_the_material),
        cmocka_unit_test(nobody_complained),
    };
    return cmocka_run_group_tests(tests, open_watched, stage_close);
}
