/* A slow zoom, frame by frame: where levels change, nobody sees it. */
#include "pictures.h"

/* From frame to frame, and how wide the sphere is in the end: pixels. */
static const float step = 1.01f, smallest = 6;
/* What a level may add to the change from frame to frame is a part of the error allowed, all along
 * the outline: where it is farthest off, it is by the whole of it. */
static const float allowed = 0.5f, visible = 6;
static const double share = 0.7;

/* A sphere whose coarsest levels are far from it. */
static subject coarse_sphere(stage *s)
{
    enum { COARSEST = 1 };
    static lod_level made[LOD_LEVELS];
    gtx_lod_mesh lods[LOD_LEVELS];
    gtx_asset *sphere = fixture_sphere(radius, TEXELS, 8);
    for (int k = 0; k < LOD_LEVELS; ++k) {
        make_lod_level(gtx_patches(sphere), 6, radius, COARSEST << (LOD_LEVELS - 1 - k),
                       &made[k]);
        lods[k] = made[k].lod;
    }
    return subject_open(s, with_lod_meshes(sphere, lods, LOD_LEVELS, 0, LOD_COLORED));
}

/* How much brightness changes from one picture to the next, in white pixels. */
static double change_of(const picture *a, const picture *b)
{
    double sum = 0;
    for (size_t i = 0; i < sizeof a->color; i += 4)
        for (size_t k = 0; k < 3; ++k)
            sum += fabs((double)a->color[i + k] - b->color[i + k]) / (3 * 255);
    return sum;
}

static double outline_of(const picture *p)
{
    double length = 0;
    for (int i = 0; i < STAGE_PIXELS; ++i) {
        const int x = i % STAGE_WIDTH, y = i / STAGE_WIDTH;
        length += covers(p, x, y) && !(covers(p, x - 1, y) && covers(p, x + 1, y) &&
                                       covers(p, x, y - 1) && covers(p, x, y + 1));
    }
    return length;
}

/* The greatest change from frame to frame beyond that of what is cast at its finest level: pixels
 * by which all of the outline would have to jump. */
static double zoom_out(stage *s, const subject *shown, gtx_method method, float max_error)
{
    static picture before, fine_before;
    const picture *now = &first, *fine = &second;
    gtx_camera camera = camera_around(shown->asset);
    const double wide = STAGE_HEIGHT / tan(atan(1) / 2); /* of a radius at a distance of one */
    double greatest = 0;
    camera.distance = 1.6f;
    for (int frame = 0; camera.distance * smallest < wide; ++frame) {
        gtx_view view = view_of(&camera);
        view.level = 1;
        draw(s, &view, GTX_METHOD_CAST, &shown->instance, 1, &second);
        view.level = 0;
        view.viewport_height = STAGE_HEIGHT;
        view.max_error = max_error;
        draw(s, &view, method, &shown->instance, 1, &first);
        const double more = change_of(&before, now) - change_of(&fine_before, fine);
        if (frame)
            greatest = fmax(greatest, more / outline_of(fine));
        before = *now;
        fine_before = *fine;
        camera.distance *= step;
    }
    return greatest;
}

static void levels_change_unseen(void **state)
{
    STAGE_OR_SKIP(state);
    static const gtx_method methods[] = {GTX_METHOD_CAST, GTX_METHOD_LOD, GTX_METHOD_AUTO};
    subject shown = coarse_sphere(s);
    for (size_t m = 0; m < sizeof methods / sizeof *methods; ++m) {
        const double jump = zoom_out(s, &shown, methods[m], allowed);
        if (jump > share * allowed)
            fail_msg("method %zu: from a frame to the next the outline jumps by %g pixels", m,
                     jump);
    }
    /* What is to be seen, this sees. */
    assert_true(zoom_out(s, &shown, GTX_METHOD_LOD, visible) > 2 * share * allowed);
    subject_close(s, &shown);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(levels_change_unseen)};
    return cmocka_run_group_tests_name("zoom", tests, open_stage, stage_close);
}
