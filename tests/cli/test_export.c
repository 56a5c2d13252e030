/* gtx export: options, outputs, and the verbs that read a GLB back as its asset. */
#include "cli/command.h"

static void comes_back_as_the_same_file(void **state)
{
    (void)state;
    expect(gtx("export sphere.gtx -o out.glb"), 0);
    expect_text("out.glb: LOD mesh 0, ");
    expect(gtx("cook out.glb -o back.gtx"), 0);
    expect_text("back.gtx: the asset that the GLB holds");
    same_files("sphere.gtx", "back.gtx");
    expect(gtx("cook out.glb -o - > piped.gtx"), 0);
    same_files("sphere.gtx", "piped.gtx");
    expect(gtx("cook - --name x.glb -o back2.gtx < out.glb"), 0);
    same_files("sphere.gtx", "back2.gtx");
    expect(gtx("cook out.glb -o back.gtx --if-changed"), 0);
    expect_text("back.gtx: unchanged");
    expect(gtx("cook sphere.obj -o back.gtx --resolution 64"), 0);
    expect(gtx("cook out.glb -o back.gtx --if-changed --report r.json"), 0);
    same_files("sphere.gtx", "back.gtx");
    expect(gtx("cook out.glb -o other.gtx --resolution 64"), 1);
    expect_text("taken as it is");
    assert_false(exists("other.gtx"));
    expect(gtx("cook out.glb sphere.obj -o other.gtx"), 1);
    expect(gtx("export sphere.gtx --textures ktx2 -o ktx2.glb"), 0);
    expect(gtx("cook ktx2.glb -o back3.gtx"), 0);
    same_files("sphere.gtx", "back3.gtx");
}

static void verbs_open_it(void **state)
{
    (void)state;
    expect(gtx("export sphere.gtx -o out.glb"), 0);
    expect(gtx("info sphere.gtx --json"), 0);
    char asset[sizeof output];
    strcpy(asset, output);
    expect(gtx("info out.glb --json"), 0);
    assert_string_equal(output, asset);
    expect(gtx("validate out.glb"), 0);
    expect(gtx("compare out.glb sphere.obj --size 64"), 0);
    expect(gtx("unpack out.glb maps"), 0);
    expect(gtx("pack maps -o packed.gtx"), 0);
    same_files("sphere.gtx", "packed.gtx");
    expect(gtx("pack out.glb -o packed.gtx"), 0);
    same_files("sphere.gtx", "packed.gtx");
    expect(gtx("export out.glb -o again.glb"), 0);
    same_files("out.glb", "again.glb");
    expect(gtx("export sphere.gtx -o plain.glb --without-asset"), 0);
    expect(gtx("info plain.glb"), 3);
    expect_text("the GLB holds no asset");
    expect(gtx("validate plain.glb"), 3);
}

static void outputs_and_options_are_checked(void **state)
{
    (void)state;
    expect(gtx("export sphere.gtx"), 1);
    expect_text("-o OUT.glb is missing");
    expect(gtx("export sphere.gtx -o sphere.gtx"), 1);
    expect(gtx("export sphere.gtx -o x.glb --report x.glb"), 1);
    expect(gtx("export sphere.gtx -o x.glb --level 1 --max-error 0.1"), 1);
    expect(gtx("export sphere.gtx -o x.glb --lods --collision"), 1);
    expect(gtx("export sphere.gtx -o x.glb --level 7"), 1);
    expect_text("there is no LOD mesh 7");
    expect(gtx("export sphere.gtx -o x.glb --max-error 1e-9"), 6);
    expect(gtx("export sphere.gtx -o x.glb --max-memory 1M"), 6);
    expect_text("--max-memory allows more");
    expect(gtx("export sphere.obj -o x.glb"), 3);
    expect(gtx("export missing.gtx -o x.glb"), 2);
    expect(gtx("export sphere.gtx -o missing/x.glb"), 2);
    expect(gtx("cook sphere.obj -o bare.gtx --lod-levels 0"), 0);
    expect(gtx("export bare.gtx -o x.glb"), 3);
    expect_text("no LOD mesh to export");
    assert_false(exists("x.glb"));
    assert_int_equal(left_over(), 0);
    expect(gtx("export sphere.gtx -o - > x.glb"), 0);
    expect(gtx("export sphere.gtx -o y.glb -q --report y.json"), 0);
    assert_string_equal(output, "");
    same_files("x.glb", "y.glb");
    expect(gtx("export sphere.gtx -o c.glb --collision --level 1"), 0);
    expect(gtx("export - -o z.glb < sphere.gtx"), 0);
    same_files("z.glb", "y.glb");
}

/* Other readers of meshes: the command's own. */
static void its_mesh_is_a_model(void **state)
{
    (void)state;
    expect(gtx("export sphere.gtx -o out.glb --lods"), 0);
    expect(gtx("render out.glb -o mesh.png --size 64x64"), 0);
    assert_null(strstr(output, "ignored"));
    expect(gtx("compare sphere.gtx out.glb --any-model --size 64 --min-iou 0.98"), 0);
}

/* A scene that places an asset's anchor where the asset has it shows the asset alone. */
static void scenes_place_assets(void **state)
{
    (void)state;
    expect(gtx("cook sphere.obj -o moved.gtx --charts 40"), 0);
    expect(gtx("info moved.gtx --json"), 0);
    double anchor[3];
    const char *at = strstr(output, "\"anchor\": [");
    assert_non_null(at);
    assert_int_equal(sscanf(at + 11, "%lf , %lf , %lf", &anchor[0], &anchor[1], &anchor[2]), 3);
    char scene[512];
    const int size = snprintf(
        scene, sizeof scene,
        "{\"asset\": {\"version\": \"2.0\"}, \"extensions\": {\"GTX_geometry_texture\": "
        "{\"assets\": [{\"uri\": \"moved.gtx\"}]}}, \"scenes\": [{\"nodes\": [0]}], \"nodes\": "
        "[{\"translation\": [%.17g, %.17g, %.17g], \"extensions\": {\"GTX_geometry_texture\": "
        "{\"asset\": 0}}}]}", anchor[0], anchor[1], anchor[2]);
    write_file("placed.gltf", scene, (size_t)size);
    expect(gtx("render placed.gltf -o placed.png --size 64x64"), 0);
    expect(gtx("render moved.gtx -o alone.png --size 64x64"), 0);
    same_files("placed.png", "alone.png");
}

static void scenes_are_cooked_mesh_by_mesh(void **state)
{
    (void)state;
    expect(gtx("export sphere.gtx -o mesh.glb --without-asset"), 0);
    expect(gtx("cook mesh.glb --per-mesh -o parts --report parts.json"), 0);
    expect_text("parts: ");
    expect_text(" of 1 meshes are assets");
    assert_true(exists("parts/mesh.glb") && exists("parts.json"));
    expect(gtx("render parts/mesh.glb -o parts.png --size 64x64"), 0);
    expect(gtx("cook sphere.obj --per-mesh -o parts2"), 5);
    expect(gtx("cook mesh.glb mesh.glb --per-mesh -o parts2"), 1);
    expect(gtx("cook mesh.glb --per-mesh --if-changed -o parts2"), 1);
    expect(gtx("cook mesh.glb --per-mesh -o sphere.obj"), 2);
    assert_false(exists("parts2"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(comes_back_as_the_same_file),
        cmocka_unit_test(verbs_open_it),
        cmocka_unit_test(outputs_and_options_are_checked),
        cmocka_unit_test(its_mesh_is_a_model),
        cmocka_unit_test(scenes_place_assets),
        cmocka_unit_test(scenes_are_cooked_mesh_by_mesh),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
