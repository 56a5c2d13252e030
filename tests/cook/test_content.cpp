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
                                Content{"ball", GTX_PARTITION_LAYERS, NONE, 0xdf99126ec1f125cc},
                                Content{"ball", GTX_PARTITION_RELIEF, NONE, 0x22000cb317cf32a0}})
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
              GTX_PARTITION_CUTS, NONE, 0x23117d2b10d176c3},
             {"/scans/gargo_3dhop.ply.gz",
              GTX_PARTITION_CUTS, NONE, 0x6511b80fc03d31f2},
             {"/textured/spot/spot/spot_control_mesh.obj",
              GTX_PARTITION_CUTS, NONE, 0xf9168f5cbf597483},
             {"/gltf/CesiumMilkTruck/glTF/CesiumMilkTruck.gltf",
              GTX_PARTITION_CUTS, NONE, 0xd496c8137e43e4af},
             {"/gltf/KhronosSampleModels/Duck/glTF_Binary/Duck.glb",
              GTX_PARTITION_CUTS, 0, 0xe2248fb839bf1443},
             {"/gltf/dragon_draco_119k.glb",
              GTX_PARTITION_CUTS, 0, 0xf2f0a0f5eec392f6},
             {"/gltf/2CylinderEngine.glb",
              GTX_PARTITION_CUTS, NONE, 0xa62c046734483d6c},
             {"/scans/horse.ply.gz",
              GTX_PARTITION_CUTS, NONE, 0xeb09493ec949e6b5},
             {"/scans/armadillo_86k.obj.gz",
              GTX_PARTITION_CUTS, NONE, 0x8b5b839c0aa42af0},
             {"/nasty/gen_2000_tiny_components.ply",
              GTX_PARTITION_CUTS, NONE, 0x5335e6c0598a80bd},
             {"/scans/bunny.ply",
              GTX_PARTITION_VSA, NONE, 0xc2da9d191d72c418},
             {"/scans/bunny.ply",
              GTX_PARTITION_PGP, NONE, 0xcf14b5d75dbd30c5},
         })
        assert_content(std::string(models) + content.model, content);
}

int main()
{
    const CMUnitTest tests[] = {cmocka_unit_test(a_ball_has_its_content),
                                cmocka_unit_test(models_have_their_content)};
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
