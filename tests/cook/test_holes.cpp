/* A closed, clean model has no hole, whatever levels of detail are drawn. */
#include "common/schema.hpp"

#include "cook/folder.hpp"

static void closed_models_stay_closed(void **)
{
    const char *models = getenv("GEOTEX_MODELS");
    if (!models || !*models)
        skip();
    for (const char *name :
         {"/gltf/venus.gltf", "/scans/armadillo_86k.obj.gz", "/scans/horse.ply.gz",
          "/scans/gargo_3dhop.ply.gz", "/scans/ogre.obj.gz", "/scans/rocker-arm.obj",
          "/scans/nefertiti.obj.gz", "/gltf/bunny_draco.glb",
          "/textured/spot/spot/spot_triangulated.obj",
          "/textured/spot/spot/spot_quadrangulated.obj",
          "/textured/spot/spot/spot_control_mesh.obj",
          "/gltf/KhronosSampleModels/Duck/glTF_Binary/Duck.glb"}) {
        const std::string input = models + std::string(name), output = in_folder("closed.gtx");
        gtx_error error = {};
        if (gtx_cook_file(input.c_str(), output.c_str(), nullptr, nullptr, &error))
            fail_msg("%s", error.message);
        gtx_compare_desc desc = {};
        desc.levels = 1;
        gtx_report report = {};
        if (gtx_compare_files(output.c_str(), input.c_str(), &desc, nullptr, &report, &error))
            fail_msg("%s", error.message);
        const schema::json json = schema::json::parse(report.json);
        assert_true(json["surface_pixels"] > 1000000);
        assert_int_equal(json["hole_pixels"], 0);
        assert_int_equal(json["details"].size(), 5);
        for (const schema::json &detail : json["details"])
            assert_int_equal(detail["hole_pixels"], 0);
        gtx_report_free(&report);
        fs::remove(output);
    }
}

int main()
{
    const CMUnitTest tests[] = {cmocka_unit_test(closed_models_stay_closed)};
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
