/* Closed models of few triangles have no hole, and nothing that stands out of them. */
#include "cook/coarse.hpp"
#include "cook/pixels.hpp"

/* Pixels of 512 x 512 that may be wrong, in 26 fixed and 24 random views. */
struct Bounds {
    uint32_t holes, walls;
};

static void measure_coarse(const Coarse &model, const char *name, const Bounds &most)
{
    const std::string input = in_folder("coarse.obj"), output = in_folder("coarse.gtx");
    model.write(input);
    gtx_error error = {};
    gtx_cook_desc cook = {};
    cook.lod_levels = GTX_LOD_LEVELS_NONE;
    if (gtx_cook_file(input.c_str(), output.c_str(), &cook, nullptr, &error))
        fail_msg("%s: %s", name, error.message);
    gtx::CompareOptions options;
    options.size = 512;
    options.random_views = 24;
    options.seed = 7;
    options.details = false;
    const gtx::CompareReport found = compare_pixels(output, input, options);
    print_message("# %s, %zu triangles: %d holes, %d walls\n", name, model.triangles.size(),
                  int(found.hole_pixels), int(found.wall_pixels));
    assert_true(found.surface_pixels > 500000);
    assert_true(found.hole_pixels <= most.holes);
    assert_true(found.wall_pixels <= most.walls);
}

static void round_ones(void **)
{
    measure_coarse(bottle(30), "bottle", {0, 40});
    measure_coarse(bottle(9), "bottle of few sides", {0, 60});
    measure_coarse(bolts(), "bolts", {0, 4});
}

static void animals(void **)
{
    measure_coarse(ears(), "ears", {0, 4});
    measure_coarse(fox(), "fox", {0, 4});
}

/* Their texels are 0.4 to 1 % of the diagonal, two to four pixels: height fields that went on past
 * their edges as far as others do would stand there in the air, 996 pixels of the roof. */
static void thin_ones(void **)
{
    measure_coarse(bars(), "bars", {0, 4});
    measure_coarse(city_tile(), "tile of a city", {1, 4});
    measure_coarse(roof(), "roof", {0, 4});
}

int main()
{
    const CMUnitTest tests[] = {cmocka_unit_test(round_ones), cmocka_unit_test(animals),
                                cmocka_unit_test(thin_ones)};
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
