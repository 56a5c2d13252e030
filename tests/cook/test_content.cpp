/* Cooked content stays what it was: literal hashes, which only a change of the cooker may change,
 * knowingly and together with its revision. They hold for x86-64 and Debian 12's libraries. */
#include "cook/folder.hpp"

/* What has no LOD meshes shows that all else stays. */
constexpr uint32_t NONE = GTX_LOD_LEVELS_NONE;

struct Content {
    const char *model;            /* below GEOTEX_MODELS; of the ball, its own name */
    gtx_partition partition;
    uint32_t lod_levels;
    uint64_t hash;
};

static void assert_content(const std::string &path, const Content &expected)
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
        fail_msg("%s: 0x%016llx", expected.model, (unsigned long long)info.content_hash);
}

static void a_ball_has_its_content(void **)
{
#ifndef __x86_64__
    skip();
#endif
    for (const Content &ball : {Content{"ball", GTX_PARTITION_CUTS, 0, 0x1d4a74ca137452a9},
                                Content{"ball", GTX_PARTITION_VSA, NONE, 0xff6480fca129567b},
                                Content{"ball", GTX_PARTITION_PGP, NONE, 0xdb93daccf3025264},
                                Content{"ball", GTX_PARTITION_LAYERS, NONE, 0xae7ea69709e3ca4b},
                                Content{"ball", GTX_PARTITION_RELIEF, NONE, 0x5828e8c6bd317c33}})
        assert_content(ball_file(), ball);
}

static void models_have_their_content(void **)
{
    const char *models = getenv("GEOTEX_MODELS");
#ifndef __x86_64__
    models = nullptr;
#endif
    if (!models || !*models)
        skip();
    for (const Content &content : std::initializer_list<Content>{
             {"/scans/bunny.ply",
              GTX_PARTITION_CUTS, NONE, 0x32d3acb993ee9370},
             {"/scans/gargo_3dhop.ply.gz",
              GTX_PARTITION_CUTS, NONE, 0x2db20155052fae71},
             {"/textured/spot/spot/spot_control_mesh.obj",
              GTX_PARTITION_CUTS, NONE, 0xde293bf3a615b550},
             {"/gltf/CesiumMilkTruck/glTF/CesiumMilkTruck.gltf",
              GTX_PARTITION_CUTS, NONE, 0xbfd3b4f42ee15bb3},
             {"/gltf/KhronosSampleModels/Duck/glTF_Binary/Duck.glb",
              GTX_PARTITION_CUTS, 0, 0xe9d131c05c0cc817},
             {"/gltf/dragon_draco_119k.glb",
              GTX_PARTITION_CUTS, 0, 0xcf314123272600f7},
             {"/gltf/2CylinderEngine.glb",
              GTX_PARTITION_CUTS, NONE, 0xfb96d88b2c2cae11},
             {"/scans/horse.ply.gz",
              GTX_PARTITION_CUTS, NONE, 0x9b61dee445967f3f},
             {"/scans/armadillo_86k.obj.gz",
              GTX_PARTITION_CUTS, NONE, 0x5d10edeff3ba8636},
             {"/nasty/gen_2000_tiny_components.ply",
              GTX_PARTITION_CUTS, NONE, 0x5335e6c0598a80bd},
             {"/scans/bunny.ply",
              GTX_PARTITION_VSA, NONE, 0xb2e51f82211213c8},
             {"/scans/bunny.ply",
              GTX_PARTITION_PGP, NONE, 0x1df8c7280af265f9},
         })
        assert_content(std::string(models) + content.model, content);
}

int main()
{
    const CMUnitTest tests[] = {cmocka_unit_test(a_ball_has_its_content),
                                cmocka_unit_test(models_have_their_content)};
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
