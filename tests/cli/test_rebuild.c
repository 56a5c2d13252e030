/* gtx pack --rebuild: near and far agree after maps were painted. */
#include "cli/command.h"

#include "image/image.h"

/* Changes every texel of an image: `change` gets its channels. */
static void paint(const char *name, void (*change)(uint8_t *texel))
{
    gtx_raw_image image;
    assert_int_equal(gtx_image_read_raw(in_folder(name), &image, NULL), GTX_OK);
    uint8_t *pixels = image.pixels;
    for (size_t i = 0; i < (size_t)image.width * image.height; ++i)
        change(pixels + i * image.channels);
    assert_int_equal(gtx_image_write_png(in_folder(name), image.width, image.height,
                                         image.channels, pixels, NULL), GTX_OK);
    free(image.pixels);
}

static void make_blue(uint8_t *texel)
{
    texel[0] = texel[1] = 0;
    texel[2] = 200;
}

/* A slope: the lower half of the codes stays. */
static void flatten(uint8_t *texel)
{
    *texel = *texel > 90 ? 90 : *texel;
}

static unsigned reds, blues;
static void count(uint8_t *texel)
{
    reds += texel[0] > 100 && texel[2] == 0;
    blues += texel[0] == 0 && texel[2] == 200;
}

/* Texels of each colour at a level of a packed asset. */
static void count_colors(const char *asset, unsigned level)
{
    char name[64];
    run_shell("rm -rf again");
    expect(gtx("unpack %s again", asset), 0);
    snprintf(name, sizeof name, "again/color-0-%u.png", level);
    reds = blues = 0;
    paint(name, count);
}

static void what_follows_is_rebuilt(void **state)
{
    (void)state;
    run_shell("rm -rf maps && "
              "{ echo 'mtllib m.mtl'; echo 'usemtl red'; cat sphere.obj; } >red.obj && "
          "printf 'newmtl red\nKd 0.5 0 0\n' >m.mtl");
    expect(gtx("cook red.obj -q -o red.gtx"), 0);
    expect(gtx("unpack red.gtx maps"), 0);
    expect(gtx("pack maps -o same.gtx --rebuild mips,normals,trim --strict"), 0);
    same_files("red.gtx", "same.gtx"); /* nothing was edited */
    count_colors("red.gtx", 0);
    assert_true(reds > 1000 && !blues);

    paint("maps/color-0-0.png", make_blue);
    expect(gtx("pack maps -o near.gtx"), 0);
    expect_text("maps: warning[maps-disagree]: in ");
    expect_text("maps were edited at level 0 alone: from afar the old ones show (--rebuild mips)");
    count_colors("near.gtx", 3);
    assert_true(reds > 10 && !blues);
    expect(gtx("pack maps -o no.gtx --strict"), 3);
    assert_false(exists("no.gtx"));
    expect(gtx("pack maps -o all.gtx --rebuild mips --strict"), 0);
    for (unsigned level = 0; level < 4; ++level) {
        count_colors("all.gtx", level);
        assert_true(blues > 10 && !reds);
    }

    paint("maps/height-0.png", flatten);
    expect(gtx("pack maps -o flat.gtx --rebuild mips"), 0);
    expect_text("heights were edited and normals were not (--rebuild normals)");
    expect(gtx("pack maps -o bent.gtx --rebuild mips,normals,trim"), 0);
    assert_null(strstr(output, "maps-disagree"));
    expect_text("warning[lod-dropped]");
    expect(gtx("validate bent.gtx"), 0);
    /* The old LOD mesh is no loss where a new one is made. */
    expect(gtx("pack maps -o lod.gtx --rebuild mips,normals,trim --lod-levels 2"), 0);
    assert_null(strstr(output, "lod-dropped"));
    run_shell("rm -rf again && \"$GTX\" unpack bent.gtx again && "
          "! cmp -s maps/normal-0-0.png again/normal-0-0.png && "
          "cmp -s maps/height-0.png again/height-0.png");
    expect(gtx("pack maps -o no.gtx --rebuild mips,all"), 1);
    expect_text("--rebuild takes some of mips, normals and trim");
}

/* A tilt to one side and to the other, a few texels wide. */
static void make_waves(uint8_t *texel)
{
    static unsigned at;
    const int tilted = texel[0] + (at++ / 3 % 2 ? 26 : -26);
    texel[0] = (uint8_t)(tilted < 0 ? 0 : tilted > 255 ? 255 : tilted);
}

static void normals_of_lod_meshes_follow_the_maps(void **state)
{
    (void)state;
    run_shell("rm -rf maps");
    write_sphere("fine.obj", 100);
    expect(gtx("cook fine.obj -q -o fine.gtx"), 0);
    expect(gtx("info fine.gtx"), 0);
    expect_text(", normals off by ");
    expect(gtx("unpack fine.gtx maps"), 0);
    expect(gtx("pack maps -o same.gtx"), 0);
    same_files("fine.gtx", "same.gtx");
    /* Fitted anew they are the same again, for the same maps. */
    run_shell("mv maps/asset.json kept.json && sed 's/\"0x[0-9a-f]*\"/\"0x0\"/' kept.json "
              ">maps/asset.json");
    expect(gtx("pack maps -o same.gtx"), 0);
    same_files("fine.gtx", "same.gtx");
    run_shell("mv kept.json maps/asset.json");
    /* What is in the maps alone no vertex tells. */
    paint("maps/normal-0-0.png", make_waves);
    expect(gtx("pack maps -o waves.gtx --rebuild mips"), 0);
    expect(gtx("validate waves.gtx"), 0);
    expect(gtx("info waves.gtx"), 0);
    expect_text("LOD meshes");
    assert_null(strstr(output, "normals off by"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_follows_is_rebuilt),
        cmocka_unit_test(normals_of_lod_meshes_follow_the_maps),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
