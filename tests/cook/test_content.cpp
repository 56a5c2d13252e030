/* Cooked content stays what it was: literal hashes, which only a change of the cooker may change,
 * knowingly and together with its revision. They hold for all processors, with Debian 12's
 * libraries. */
#include "cook/folder.hpp"

/* What has no LOD meshes shows that all else stays. */
constexpr uint32_t NONE = GTX_LOD_LEVELS_NONE;

struct Content {
    const char *model;            /* below GEOTEX_MODELS; of the ball, its own name */
    gtx_partition partition;
    uint32_t lod_levels;
    uint64_t hash;
};

/* Whether it is; says what else it has. */
static bool has_content(const std::string &path, const Content &expected)
{
    gtx_cook_desc desc = {};
    desc.partition = expected.partition;
    desc.lod_levels = expected.lod_levels;
    const std::string output = in_folder("content.gtx");
    gtx_error error = {};
    gtx_asset *asset = nullptr;
    if (gtx_cook_file(path.c_str(), output.c_str(), &desc, nullptr, &error) ||
        gtx_open_file(output.c_str(), nullptr, &asset, &error))
        fail_msg("%s", error.message);
    gtx_info info;
    gtx_get_info(asset, &info);
    gtx_close(asset);
    if (info.content_hash != expected.hash)
        print_message("# %s: 0x%016llx instead of 0x%016llx\n", expected.model,
                      (unsigned long long)info.content_hash, (unsigned long long)expected.hash);
    return info.content_hash == expected.hash;
}

static void a_ball_has_its_content(void **)
{
    int others = 0;
    for (const Content &ball : {Content{"ball", GTX_PARTITION_CUTS, 0, 0xb91921d6ccaebf77},
                                Content{"ball", GTX_PARTITION_VSA, NONE, 0xff6480fca129567b},
                                Content{"ball", GTX_PARTITION_PGP, NONE, 0xdb93daccf3025264},
                                Content{"ball", GTX_PARTITION_LAYERS, NONE, 0xae7ea69709e3ca4b},
                                Content{"ball", GTX_PARTITION_RELIEF, NONE, 0x5828e8c6bd317c33}})
        others += !has_content(ball_file(), ball);
    assert_int_equal(others, 0);
}

static void models_have_their_content(void **)
{
    const char *models = getenv("GEOTEX_MODELS");
    if (!models || !*models)
        skip();
    int others = 0;
    for (const Content &content : std::initializer_list<Content>{
             {"/scans/bunny.ply",
              GTX_PARTITION_DEFAULT, NONE, 0x32d3acb993ee9370},
             {"/scans/gargo_3dhop.ply.gz",
              GTX_PARTITION_DEFAULT, NONE, 0x443c8584ccec8d1c},
             {"/textured/spot/spot/spot_control_mesh.obj",
              GTX_PARTITION_DEFAULT, NONE, 0xeefddd3def1bfd34},
             {"/gltf/CesiumMilkTruck/glTF/CesiumMilkTruck.gltf",
              GTX_PARTITION_CUTS, NONE, 0x06ba08c576164066},
             {"/gltf/CesiumMilkTruck/glTF/CesiumMilkTruck.gltf",
              GTX_PARTITION_DEFAULT, NONE, 0x0ac2cd9834dbe046},
             {"/gltf/KhronosSampleModels/Duck/glTF_Binary/Duck.glb",
              GTX_PARTITION_DEFAULT, 0, 0x20f8c6e5b8696c04},
             {"/gltf/dragon_draco_119k.glb",
              GTX_PARTITION_DEFAULT, 0, 0xceb85958b17c58a9},
             {"/gltf/2CylinderEngine.glb",
              GTX_PARTITION_CUTS, NONE, 0x428ff19f04b6dcd5},
             {"/scans/horse.ply.gz",
              GTX_PARTITION_DEFAULT, NONE, 0x56161623081d4542},
             {"/scans/armadillo_86k.obj.gz",
              GTX_PARTITION_DEFAULT, NONE, 0xc4f58d43f4a5c91a},
             {"/nasty/gen_2000_tiny_components.ply",
              GTX_PARTITION_DEFAULT, NONE, 0x8cd8ea13b5efe51c},
             {"/scans/bunny.ply",
              GTX_PARTITION_VSA, NONE, 0xb2e51f82211213c8},
             {"/scans/bunny.ply",
              GTX_PARTITION_PGP, NONE, 0xf3cd58481d401699},
         })
        others += !has_content(std::string(models) + content.model, content);
    assert_int_equal(others, 0);
}

int main()
{
    const CMUnitTest tests[] = {cmocka_unit_test(a_ball_has_its_content),
                                cmocka_unit_test(models_have_their_content)};
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
