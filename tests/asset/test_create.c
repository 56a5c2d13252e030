/* Creating an asset: the rules hold, whatever its maps. */
#include "asset/specimen.h"

static uint32_t broken_rule(const specimen *s)
{
    gtx_asset *asset = NULL;
    gtx_error error = {0};
    gtx_result result = gtx_create(&s->desc, &asset, &error);
    assert_int_equal(!asset, result != GTX_OK);
    gtx_close(asset);
    if (result == GTX_OK)
        return 0;
    assert_int_equal(result, GTX_ERROR_CORRUPT);
    assert_int_equal(error.offset, 0);
    return error.rule;
}

#define EXPECT_RULE(number, change)           \
    do {                                      \
        specimen s;                              \
        make_specimen(&s);                       \
        change;                               \
        assert_int_equal(broken_rule(&s), number); \
    } while (0)

static void test_create_rules(void **state)
{
    (void)state;
    EXPECT_RULE(0, (void)0);
    EXPECT_RULE(108, s.desc.patch_count = 0);
    EXPECT_RULE(108, s.desc.patch_count = (1u << 20) + 1);
    EXPECT_RULE(109, s.desc.page_count = 0);
    EXPECT_RULE(110, s.desc.page_width = 4);
    EXPECT_RULE(110, s.desc.page_height = 16385);
    EXPECT_RULE(111, s.desc.mip_count = 0);
    EXPECT_RULE(111, s.desc.mip_count = 9);
    EXPECT_RULE(112, s.desc.bounds_min[1] = NAN);
    EXPECT_RULE(112, s.desc.bounds_min[1] = 2);
    EXPECT_RULE(113, s.desc.unit = -1);
    EXPECT_RULE(113, s.desc.unit = INFINITY);
    EXPECT_RULE(115, s.desc.anchor[2] = NAN);
    EXPECT_RULE(300, s.patches[1].origin[0] = NAN);
    EXPECT_RULE(300, s.patches[1].sphere[3] = INFINITY);
    EXPECT_RULE(301, s.patches[0].extent_y = 0);
    EXPECT_RULE(301, s.patches[0].extent_z = 0.0002f);
    EXPECT_RULE(302, s.patches[0].axis_y[1] = 1.002f);
    EXPECT_RULE(303, s.patches[0].axis_x[0] = -1);
    EXPECT_RULE(304, s.patches[0].coverage = 0.99f);
    EXPECT_RULE(304, s.height[0] = 0);
    EXPECT_RULE(305, s.patches[1].page = 1);
    EXPECT_RULE(306, s.patches[1].rect[0] = 9);
    EXPECT_RULE(306, s.patches[1].rect[2] = 65535);
    EXPECT_RULE(307, s.patches[1].flags = 1u << 9);
    EXPECT_RULE(308, s.patches[1].sphere[0] = 2);
    EXPECT_RULE(308, s.patches[1].sphere[3] = -1);
    EXPECT_RULE(309, s.patches[1].reserved[6] = 1);
    EXPECT_RULE(310, s.patches[1].rect[0] = 7);
    EXPECT_RULE(311, s.desc.bounds_max[2] = 0.25f);
    EXPECT_RULE(400, s.height[255] = 1);
    EXPECT_RULE(600, (s.desc.meta = "\xC3", s.desc.meta_size = 1));
    EXPECT_RULE(600, (s.desc.meta = "x", s.desc.meta_size = (1u << 20) + 1));
}

/* Maps that may be absent: what is asked for is what is there. */
static void test_material_and_emission(void **state)
{
    (void)state;
    specimen s;
    make_specimen(&s);
    uint8_t material[1024], emission[768];
    for (size_t i = 0; i < sizeof material; ++i)
        material[i] = (uint8_t)(i * 7);
    for (size_t i = 0; i < sizeof emission; ++i)
        emission[i] = (uint8_t)(i * 11);
    const uint8_t *materials[] = {material}, *emissions[] = {emission};
    s.desc.material = materials;
    s.desc.emission = emissions;
    gtx_asset *asset;
    gtx_info info;
    size_t size;
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_OK);
    gtx_get_info(asset, &info);
    assert_true(info.emission_scale == 1); /* the default */
    assert_true(!info.has_color && info.has_material && info.has_emission);
    const void *map = gtx_map_data(asset, GTX_MAP_MATERIAL, 0, &size);
    assert_int_equal(size, sizeof material);
    assert_memory_equal(map, material, size);
    map = gtx_map_data(asset, GTX_MAP_EMISSION, 0, &size);
    assert_int_equal(size, sizeof emission);
    assert_memory_equal(map, emission, size);
    assert_null(gtx_map_data(asset, GTX_MAP_EMISSION, 1, NULL));
    assert_null(gtx_map_data(asset, GTX_MAP_COLOR, 0, NULL));
    gtx_close(asset);

    /* The two are part of the content. */
    uint64_t hash = info.content_hash;
    material[5] ^= 1;
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_OK);
    gtx_get_info(asset, &info);
    assert_true(info.content_hash != hash);
    gtx_close(asset);

    s.desc.emission_scale = NAN;
    assert_int_equal(broken_rule(&s), 119);
    s.desc.emission_scale = -1;
    assert_int_equal(broken_rule(&s), 119);
    s.desc.emission_scale = 3;
    assert_int_equal(broken_rule(&s), 0);
    s.desc.emission = NULL;
    assert_int_equal(broken_rule(&s), 119);
    s.desc.emission_scale = -0.0f; /* asks for the default: none */
    assert_int_equal(broken_rule(&s), 0);
    materials[0] = NULL;
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_ERROR_ARGUMENT);
}

/* Values at the edge of what floats hold: results, never faults. */
static void test_huge_values(void **state)
{
    (void)state;
    EXPECT_RULE(308, s.patches[0].origin[0] = 3e38f);
    EXPECT_RULE(301, s.patches[0].extent_x = 3e38f);
    EXPECT_RULE(0, (s.desc.bounds_min[0] = -3e38f, s.desc.bounds_max[0] = 3e38f));
}

/* Two levels of one triangle each, the coarser on the second patch. */
static void test_lod(void **state)
{
    (void)state;
    specimen s;
    make_specimen(&s);
    const uint32_t on_first[] = {0, 1, 1}, on_second[] = {0, 0, 1};
    uint32_t indices[] = {0, 1, 2};
    uint16_t positions[] = {0, 0, 0, 4, 0, 1, 0, 4, 2};
    gtx_lod_mesh levels[2] = {{.step = 0.125f, .error = 0.5f,
                               .vertex_count = 3, .triangle_count = 1, .first = on_first,
                               .indices = indices, .positions = positions}};
    levels[1] = levels[0];
    levels[1].first = on_second;
    for (int k = 0; k < 3; ++k)
        levels[1].origin[k] = s.patches[1].origin[k];
    s.desc.lod = levels;
    s.desc.lod_levels = 2;
    gtx_asset *asset = NULL;
    gtx_info info;
    gtx_lod_mesh shown;
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_OK);
    gtx_get_info(asset, &info);
    assert_int_equal(info.lod_levels, 2);
    assert_int_equal(gtx_get_lod_mesh(asset, 1, &shown), GTX_OK);
    assert_memory_equal(shown.first, on_second, sizeof on_second);
    assert_memory_equal(shown.indices, indices, sizeof indices);
    assert_memory_equal(shown.positions, positions, sizeof positions);
    assert_true(shown.step == 0.125f && shown.error == 0.5f);
    assert_int_equal(gtx_get_lod_mesh(asset, 2, &shown), GTX_ERROR_ARGUMENT);
    assert_int_equal(gtx_get_lod_mesh(asset, 0, NULL), GTX_ERROR_ARGUMENT);
    gtx_close(asset);

    levels[1].error = 0.25f;
    assert_int_equal(broken_rule(&s), 502);
    levels[1].error = 0.5f;
    positions[3] = 4000;
    assert_int_equal(broken_rule(&s), 505);
    levels[0].flags = levels[1].flags = GTX_LOD_FAR; /* corners may lie anywhere */
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_OK);
    assert_int_equal(gtx_get_lod_mesh(asset, 1, &shown), GTX_OK);
    assert_int_equal(shown.flags, GTX_LOD_FAR);
    gtx_close(asset);
    levels[0].flags = levels[1].flags = 4;
    assert_int_equal(broken_rule(&s), 501);
    levels[0].flags = levels[1].flags = 0;
    positions[3] = 4;
    indices[1] = 7;
    assert_int_equal(broken_rule(&s), 504);
    indices[1] = 1;
    levels[0].triangle_count = 0;
    assert_int_equal(broken_rule(&s), 500);
    levels[0].triangle_count = 1;
    levels[0].indices = NULL;
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_ERROR_ARGUMENT);
    s.desc.lod_levels = 9;
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_ERROR_ARGUMENT);
    s.desc.lod = NULL;
    s.desc.lod_levels = 1;
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_ERROR_ARGUMENT);
}

/* Normals of vertices: with their flag alone, and of no more vertices than can be coded. */
static void test_lod_normals(void **state)
{
    (void)state;
    specimen s;
    make_specimen(&s);
    const uint32_t first[] = {0, 2, 2}, indices[] = {0, 1, 2, 0, 2, 3, 3, 4, 5};
    const uint16_t positions[] = {0, 0, 0, 4, 0, 1, 0, 4, 2, 1, 4, 2, 2, 4, 2, 3, 4, 2};
    const uint8_t normals[] = {128, 128, 0, 255, 7, 9, 128, 200, 1, 2, 3, 4};
    gtx_lod_mesh level = {.step = 0.125f, .vertex_count = 4, .triangle_count = 2,
                          .flags = GTX_LOD_NORMALS, .first = first, .indices = indices,
                          .positions = positions, .normals = normals, .normal_error = 0.5f};
    s.desc.lod = &level;
    s.desc.lod_levels = 1;
    gtx_asset *asset = NULL;
    gtx_lod_mesh shown;
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_OK);
    assert_int_equal(gtx_get_lod_mesh(asset, 0, &shown), GTX_OK);
    assert_int_equal(shown.flags, GTX_LOD_NORMALS);
    assert_memory_equal(shown.normals, normals, 8);
    assert_true(shown.normal_error == 0.5f);
    gtx_close(asset);
    for (float error = -1; error < 4; error += 4) {
        level.normal_error = error;
        assert_int_equal(broken_rule(&s), 506);
    }
    level.normal_error = 2;
    assert_int_equal(broken_rule(&s), 0);
    level.flags = 0;
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_ERROR_ARGUMENT);
    level.normals = NULL;
    level.flags = GTX_LOD_NORMALS;
    assert_int_equal(gtx_create(&s.desc, &asset, NULL), GTX_ERROR_ARGUMENT);
    /* A triangle alone has more vertices than may have normals. */
    const uint32_t one[] = {0, 1, 1};
    level.first = one;
    level.normals = normals;
    level.triangle_count = 1;
    level.vertex_count = 3;
    assert_int_equal(broken_rule(&s), 506);
}

/* ---- size ---- */

/* As many patches as a file may have, one overlap among them. */
static void test_many_patches(void **state)
{
    (void)state;
    const uint32_t side = 2048, count = 1u << 20;
    gtx_patch *patches = need(calloc(count, sizeof *patches));
    uint8_t *maps = need(calloc((size_t)side * side, 2));
    for (uint32_t i = 0; i < count; ++i)
        patches[i] = (gtx_patch){.extent_x = 1, .axis_x = {1, 0, 0}, .extent_y = 1,
                                 .axis_y = {0, 1, 0}, .extent_z = 1, .axis_z = {0, 0, 1},
                                 .rect = {(uint16_t)(i % 1024 * 2), (uint16_t)(i / 1024 * 2), 2, 2},
                                 .sphere = {0, 0, 0, 1}};
    const uint8_t *levels[] = {maps};
    gtx_asset_desc desc = {.patches = patches, .patch_count = count, .page_count = 1,
                           .page_width = side, .page_height = side, .mip_count = 1,
                           .height_bits = 8, .height = maps, .trim = maps, .normal = levels};
    gtx_asset *asset;
    gtx_error error = {0};
    assert_int_equal(gtx_create(&desc, &asset, &error), GTX_OK);
    gtx_close(asset);
    patches[count - 1].rect[0] -= 1;
    assert_int_equal(gtx_create(&desc, &asset, &error), GTX_ERROR_CORRUPT);
    assert_int_equal(error.rule, 310);
    for (uint32_t i = 0; i < count; ++i) /* all of them on one another */
        memcpy(patches[i].rect, (uint16_t[]){0, 0, 2048, 2048}, 8);
    assert_int_equal(gtx_create(&desc, &asset, &error), GTX_ERROR_CORRUPT);
    assert_int_equal(error.rule, 310);
    free(patches);
    free(maps);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_create_rules),
        cmocka_unit_test(test_material_and_emission),
        cmocka_unit_test(test_huge_values),
        cmocka_unit_test(test_lod),
        cmocka_unit_test(test_lod_normals),
        cmocka_unit_test(test_many_patches),
    };
    return cmocka_run_group_tests_name("api", tests, NULL, NULL);
}
