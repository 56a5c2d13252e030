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
    for (const Content &ball : {Content{"ball", GTX_PARTITION_CUTS, 0, 0x5611446c64adb485},
                                Content{"ball", GTX_PARTITION_VSA, NONE, 0x8a1670d692fba1aa},
                                Content{"ball", GTX_PARTITION_PGP, NONE, 0xf6936329671a7910},
                                Content{"ball", GTX_PARTITION_LAYERS, NONE, 0x186cb3a3e820de33},
                                Content{"ball", GTX_PARTITION_RELIEF, NONE, 0x40e28dd33e35afad}})
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
              GTX_PARTITION_DEFAULT, NONE, 0x694556518efef652},
             {"/scans/gargo_3dhop.ply.gz",
              GTX_PARTITION_DEFAULT, NONE, 0x948edb230a6fcf50},
             {"/textured/spot/spot/spot_control_mesh.obj",
              GTX_PARTITION_DEFAULT, NONE, 0x48957ef3ddf9cde7},
             {"/gltf/CesiumMilkTruck/glTF/CesiumMilkTruck.gltf",
              GTX_PARTITION_CUTS, NONE, 0xe7a5c15454dc35f3},
             {"/gltf/CesiumMilkTruck/glTF/CesiumMilkTruck.gltf",
              GTX_PARTITION_DEFAULT, NONE, 0x7b1fdfc751919dc2},
             {"/gltf/KhronosSampleModels/Duck/glTF_Binary/Duck.glb",
              GTX_PARTITION_DEFAULT, 0, 0x07cbd003293296c4},
             {"/gltf/dragon_draco_119k.glb",
              GTX_PARTITION_DEFAULT, 0, 0xe4fe983c4962d012},
             {"/gltf/2CylinderEngine.glb",
              GTX_PARTITION_CUTS, NONE, 0xfaa8c18e4a19ebf5},
             {"/scans/horse.ply.gz",
              GTX_PARTITION_DEFAULT, NONE, 0x10cee783d1e2ee4a},
             {"/scans/armadillo_86k.obj.gz",
              GTX_PARTITION_DEFAULT, NONE, 0x2d572a5099ec778b},
             {"/nasty/gen_2000_tiny_components.ply",
              GTX_PARTITION_DEFAULT, NONE, 0xfc72bb05921b498c},
             {"/scans/bunny.ply",
              GTX_PARTITION_VSA, NONE, 0x9eadb517c930bf94},
             {"/scans/bunny.ply",
              GTX_PARTITION_PGP, NONE, 0x6b2d282f133768bb},
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
