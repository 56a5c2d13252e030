/* gtx filter: what it makes, and what it refuses without leaving a file. */
#include "cli/command.h"

#include "image/image.h"

static void write_image(const char *name, uint32_t width, uint32_t height)
{
    uint8_t pixels[8 * 8];
    assert_true(width <= 8 && height <= 8);
    for (uint32_t i = 0; i < width * height; ++i)
        pixels[i] = (uint8_t)(37 * i);
    gtx_error error = {0};
    if (gtx_image_write_png(in_folder(name), width, height, 1, pixels, &error))
        fail_msg("%s", error.message);
}

static void refused(int code, const char *text, const char *arguments)
{
    expect(gtx("filter %s", arguments), code);
    expect_text(text);
    assert_false(exists("no.gtx"));
    assert_int_equal(left_over(), 0);
}

static void misuse_leaves_nothing(void **state)
{
    (void)state;
    write_image("dot.png", 1, 1);
    refused(1, "-o OUT.gtx is missing", "sphere.gtx --gaussian 2");
    refused(1, "an operation is missing", "sphere.gtx -o no.gtx");
    refused(1, "--gaussian wants TEXELS", "sphere.gtx -o no.gtx --gaussian nan");
    refused(1, "--gaussian wants TEXELS", "sphere.gtx -o no.gtx --gaussian -3");
    refused(1, "finite and above 0", "sphere.gtx -o no.gtx --gaussian 0");
    refused(6, "larger than the largest patch", "sphere.gtx -o no.gtx --gaussian 5000");
    refused(6, "larger than the largest patch", "sphere.gtx -o no.gtx --gaussian-world 90");
    refused(1, "--high-boost wants AMOUNT", "sphere.gtx -o no.gtx --high-boost 99");
    refused(1, "not 1 x 1", "sphere.gtx -o no.gtx --pattern dot.png");
    refused(2, "none.png: error[read]", "sphere.gtx -o no.gtx --gaussian 1 --pattern none.png");
    refused(2, "none.gtx: error[read]", "none.gtx -o no.gtx --gaussian 1");
    refused(3, "error[100 identifier]", "sphere.obj -o no.gtx --gaussian 1");
    refused(2, "error[write]", "sphere.gtx -o nowhere/no.gtx --gaussian 1");
}

static void operations_run_in_order(void **state)
{
    (void)state;
    write_image("waves.png", 8, 8);
    expect(gtx("filter sphere.gtx -o a.gtx --gaussian 1.5 --pattern waves.png --pattern-size 0.4 "
               "--pattern-height 0.02"), 0);
    expect(gtx("filter sphere.gtx -o b.gtx --pattern waves.png --gaussian 1.5 --pattern-size 0.4 "
               "--pattern-height 0.02"), 0);
    expect(gtx("filter sphere.gtx -o c.gtx --gaussian 1.5 --pattern waves.png --pattern-size 0.4 "
               "--pattern-height 0.02"), 0);
    same_files("a.gtx", "c.gtx");
    size_t size[2];
    char *data[2] = {slurp("a.gtx", &size[0]), slurp("b.gtx", &size[1])};
    assert_true(size[0] != size[1] || memcmp(data[0], data[1], size[0]));
    free(data[0]);
    free(data[1]);
    expect(gtx("validate a.gtx"), 0);
    expect(gtx("filter a.gtx -o d.gtx --high-boost 0.5 --boost-radius 3 --zstd 0 "
               "--lod-levels 0"), 0);
    expect(gtx("validate d.gtx"), 0);
    expect(gtx("filter sphere.gtx -o e.gtx --gaussian 4 --naive --lod-levels 0"), 0);
    expect(gtx("validate e.gtx"), 0);
}

static void a_blurred_model_stays_closed(void **state)
{
    (void)state;
    expect(gtx("filter sphere.gtx -o soft.gtx --gaussian 8"), 0);
    expect(gtx("compare soft.gtx sphere.obj --size 256 --levels 1 --json"), 0);
    expect_text("\"leak_pixels\": 0,");
}

/* Pixels of 26 views where the inside is seen. */
static int leaks(const char *asset, const char *model)
{
    expect(gtx("compare %s %s --size 256 --levels 1 --json", asset, model), 0);
    const char *at = strstr(output, "\"leak_pixels\": ");
    assert_non_null(at);
    return atoi(at + strlen("\"leak_pixels\": "));
}

static void a_scan_stays_closed_where_patches_alone_come_apart(void **state)
{
    (void)state;
    char model[512];
    if (!getenv("GEOTEX_MODELS"))
        skip();
    snprintf(model, sizeof model, "%s/scans/horse.ply.gz", getenv("GEOTEX_MODELS"));
    expect(gtx("cook %s -o horse.gtx --lod-levels 0", model), 0);
    expect(gtx("filter horse.gtx -o soft.gtx --gaussian 8"), 0);
    expect(gtx("filter horse.gtx -o alone.gtx --gaussian 8 --naive"), 0);
    const int before = leaks("horse.gtx", model), after = leaks("soft.gtx", model);
    const int alone = leaks("alone.gtx", model);
    print_message("# leak pixels: %d before, %d after, %d alone\n", before, after, alone);
    assert_true(after <= before + 20);
    assert_true(alone > 100 * (after + 1));
}

static void lod_meshes_are_made_anew(void **state)
{
    (void)state;
    expect(gtx("cook sphere.obj -o lod.gtx --lod-levels 2"), 0);
    expect(gtx("filter lod.gtx -o soft_lod.gtx --gaussian 1 --lod-levels 1"), 0);
    expect(gtx("info soft_lod.gtx --json"), 0);
    expect_text("\"lod_meshes\": [\n    {");
    expect(gtx("filter lod.gtx -o bare.gtx --gaussian 1 --lod-levels 0"), 0);
    expect_text("warning[lod-dropped]: the LOD mesh");
    expect(gtx("info bare.gtx --json"), 0);
    expect_text("\"lod_meshes\": []");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(misuse_leaves_nothing),
        cmocka_unit_test(operations_run_in_order),
        cmocka_unit_test(a_blurred_model_stays_closed),
        cmocka_unit_test(a_scan_stays_closed_where_patches_alone_come_apart),
        cmocka_unit_test(lod_meshes_are_made_anew),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
