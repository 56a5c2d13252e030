/* gtx view: what was dropped is saved, and shown as the model that it was. */
#include "cli/window.h"

static void what_was_cooked_is_kept(void **state)
{
    (void)state;
    if (!server)
        skip();
    expect(gtx("cook sphere.obj -o cooked.gtx -q"), 0);
    assert_int_equal(rename(in_folder("sphere.gtx"), in_folder("other.gtx")), 0);
    expect(gtx("view --drop sphere.obj --size 320x240 --frames 2 --keys ..."), 0);
    assert_false(exists("sphere.gtx"));
    expect(gtx("view --drop sphere.obj --size 320x240 --frames 2 --keys '~kk'"), 0);
    same_files("sphere.gtx", "cooked.gtx");
    assert_true(exists("sphere-1.gtx")); /* nothing is written over */
    expect(gtx("view other.gtx --size 32x32 --frames 2 --keys k"), 0); /* nothing to save */
    assert_false(exists("other-1.gtx"));
}

static void the_source_takes_turns_with_its_asset(void **state)
{
    (void)state;
    if (!server)
        skip();
    gtx_image asset = view("cooked.gtx --source box.obj", "t");
    gtx_image source = view("cooked.gtx --source box.obj", "tx");
    gtx_image back = view("cooked.gtx --source box.obj", "txx");
    gtx_image dropped = view("--drop sphere.obj", "~tx"), mesh = view("sphere.obj", "t");
    assert_true(difference(&dropped, &mesh, false) < 500); /* it is where the asset's bounds are */
    gtx_image none = view("cooked.gtx", "tx"); /* no source is known */
    gtx_image wrong = view("cooked.gtx --source none.obj", "tx");
    assert_true(difference(&asset, &source, false) > 1000);
    assert_int_equal(difference(&asset, &back, false), 0);
    assert_int_equal(difference(&asset, &none, false), 0);
    assert_int_equal(difference(&asset, &wrong, false), 0);
    expect(gtx("render cooked.gtx --beside box.obj --size 640x240 --camera 30,20,5 -q -o b.png"),
           0);
    gtx_image both = picture("b.png"); /* the same scene beside it */
    const uint8_t *p = pixel(&both, 480, 120), *q = pixel(&source, 160, 120);
    for (int k = 0; k < 3; ++k)
        assert_true(abs(p[k] - q[k]) < 4);
    gtx_image_free(&asset);
    gtx_image_free(&source);
    gtx_image_free(&back);
    gtx_image_free(&dropped);
    gtx_image_free(&mesh);
    gtx_image_free(&none);
    gtx_image_free(&wrong);
    gtx_image_free(&both);
}

static int open_both(void **state)
{
    static const char box[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    if (open_stage(state))
        return 1;
    write_file("box.obj", box, sizeof box - 1);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_cooked_is_kept),
        cmocka_unit_test(the_source_takes_turns_with_its_asset),
    };
    return cmocka_run_group_tests(tests, open_both, close_stage);
}
