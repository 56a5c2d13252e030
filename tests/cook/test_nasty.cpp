/* Models that break careless cookers, and how well an asset of each must follow its model. That
 * each cooks within limits of memory and time is tests/corpus. */
#include "cook/pixels.hpp"

static void nasty_models_give_sensible_assets(void **)
{
    static const struct {
        const char *name;
        double overlap;   /* least silhouette IoU, or 0: refused as empty */
        uint64_t holes;   /* most hole pixels, of some millions */
    } models[] = {
        {"gen_single_triangle.ply", 0.985, 0},
        {"gen_flat_z0.ply", 0.99, 0},
        {"gen_quads_ngons_ascii.ply", 0.98, 0},
        {"gen_ngon_concave.obj", 0.985, 0},
        {"gen_nonmanifold_edge_fan16.ply", 0.98, 0},
        {"gen_2000_tiny_components.ply", 0.88, 0},
        {"gen_coincident_spheres.ply", 0.999, 0},
        {"gen_duplicate_faces.ply", 0.999, 0},
        {"gen_winding_random_half.ply", 0.999, 0},
        {"gen_winding_all_inverted.ply", 0.999, 0},
        {"gen_offset_1e7_f64.ply", 0.999, 0},
        {"gen_offset_1e7_node.glb", 0.999, 0},
        {"gen_scale_1e-6.ply", 0.999, 0},
        {"gen_mirrored_negative_scale.glb", 0.999, 0},
        {"gen_moebius.ply", 0.99, 0},
        {"gen_klein_bottle_figure8.ply", 0.99, 4}, /* height fields that cross */
        {"gen_nan_vertices.ply", 0.999, 0},
        {"gen_hemisphere_open.ply", 0.99, 0},
        {"gen_self_intersecting_tori.ply", 0.99, 0},
        {"gen_all_nan.ply", 0, 0},
        {"gen_empty_0v_0f.ply", 0, 0},
        {"gen_line_collapsed.ply", 0, 0},
        {"gen_point_collapsed.ply", 0, 0},
    };
    const char *models_folder = getenv("GEOTEX_MODELS");
    if (!models_folder || !*models_folder)
        skip();
    unsigned faults = 0;
    for (const auto &model : models) {
        const std::string input = std::string(models_folder) + "/nasty/" + model.name;
        const std::string output = in_folder("nasty.gtx");
        gtx_error error = {};
        gtx_cook_desc desc = {};
        const gtx_result cooked =
            gtx_cook_file(input.c_str(), output.c_str(), &desc, nullptr, &error);
        gtx::CompareReport found;
        bool good = cooked == (model.overlap > 0 ? GTX_OK : GTX_ERROR_EMPTY);
        if (good && model.overlap > 0) {
            gtx::CompareOptions options;
            options.size = 512;
            options.details = false;
            found = compare_pixels(output, input, options);
            good = found.hole_pixels <= model.holes && found.silhouette_iou >= model.overlap;
        }
        if (!good)
            print_message("%s: result %d, %s; %d holes, silhouette IoU %g\n", model.name, cooked,
                          error.message, int(found.hole_pixels), found.silhouette_iou);
        faults += !good;
        fs::remove(output);
    }
    assert_int_equal(faults, 0);
}

int main()
{
    const CMUnitTest tests[] = {cmocka_unit_test(nasty_models_give_sensible_assets)};
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
