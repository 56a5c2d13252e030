/* Worlds of height grids: in degrees, and of depths. */
#include "worlds.hpp"

#include "world/compare.hpp"

#include <geotex/cook.h>

#include <cmath>
#include <cstring>

#include <unistd.h>

using namespace gtx;

static constexpr uint32_t SIZE = 96;

/* 21 x 21 nodes around 46 degrees north; those of 0 and 1 share a column. */
static std::string tile_in_degrees(int number)
{
    std::string text = "ncols 21\nnrows 21\nxllcorner " + std::to_string(8 + 0.02 * number) +
                       "\nyllcorner 46\ncellsize 0.001\n";
    for (int j = 0; j < 21; ++j)
        for (int i = 20 * number; i < 20 * number + 21; ++i)
            text += std::to_string(400 + i * j % 7 * 20) + (i == 20 * number + 20 ? "\n" : " ");
    const std::string path = in_folder(number ? "east.asc" : "west.asc");
    write_file(path, text);
    return path;
}

/* Where the module that reads them does not lie beside the program. */
static void skip_without_gdal()
{
    char self[4096] = "";
    assert_true(readlink("/proc/self/exe", self, sizeof self - 1) > 0);
    std::strcpy(std::strrchr(self, '/') + 1, "geotex-grid.so");
    if (access(self, F_OK) != 0)
        skip();
}

static void tiles_in_degrees_meet_in_metres(void **)
{
    skip_without_gdal();
    PlanOptions options;
    options.models = {tile_in_degrees(0), tile_in_degrees(1)};
    options.folder = in_folder("degrees");
    Task task(1, nullptr, nullptr, {"read", "cook", "simplify"}, {1, 1, 1});
    try {
        plan_world(options, task);
        fail();
    } catch (const Error &error) {
        assert_int_equal(error.result, GTX_ERROR_INPUT);
        assert_non_null(std::strstr(error.message.c_str(), "--local-metres"));
    }
    options.local_metres = true;
    make_world(options);
    Vec3d low(INFINITY, INFINITY, INFINITY), high = low * -1.0;
    const Plan plan = read_plan(options.folder, task);
    read_inputs(plan, task, [&](const Corners3 &corners) {
        for (const Corner &c : corners)
            for (int k = 0; k < 3; ++k) {
                low[k] = std::min(low[k], c.position[k]);
                high[k] = std::max(high[k], c.position[k]);
            }
    });
    assert_true(std::fabs(high.x - low.x - 0.04 * 77465) < 1); /* metres a degree at 46.01 */
    assert_true(std::fabs(high.z - low.z - 0.02 * 111148) < 1);

    const char *more = options.models[1].c_str();
    gtx_compare_desc desc = {};
    desc.size = SIZE;
    desc.more = &more;
    desc.more_count = desc.figures_only = desc.local_metres = 1;
    gtx_compare_result result;
    std::string about;
    compare_world(options.folder, options.models[0].c_str(), 0, desc, &result, nullptr, about);
    assert_int_equal(result.hole_pixels, 0);
    assert_true(result.silhouette_iou > 0.99);
}

/* Of depths 100 at the border and 150 in the middle. */
static void depths_are_downwards(void **)
{
    skip_without_gdal();
    std::string text = "ncols 21\nnrows 21\nxllcorner 0\nyllcorner 0\ncellsize 10\n";
    for (int j = -10; j <= 10; ++j)
        for (int i = -10; i <= 10; ++i)
            text += std::to_string(150 - (i * i + j * j) / 4) + (i == 10 ? "\n" : " ");
    PlanOptions options;
    options.models = {in_folder("depths.asc")};
    options.folder = in_folder("depths");
    write_file(options.models[0], text);
    options.depths = true;
    make_world(options);
    Task task(1, nullptr, nullptr, {"read", "cook", "simplify"}, {1, 1, 1});
    double least = INFINITY, greatest = -INFINITY;
    read_inputs(read_plan(options.folder, task), task, [&](const Corners3 &corners) {
        for (const Corner &c : corners) {
            least = std::min(least, c.position.y);
            greatest = std::max(greatest, c.position.y);
        }
    });
    assert_true(least == -150 && greatest == -100);

    gtx_compare_desc desc = {};
    desc.size = SIZE;
    desc.figures_only = desc.depths = 1;
    gtx_compare_result result;
    std::string about;
    compare_world(options.folder, options.models[0].c_str(), 0, desc, &result, nullptr, about);
    assert_int_equal(result.hole_pixels, 0);
    assert_true(result.silhouette_iou > 0.99 && result.forward_rms < 1e-3);
    desc.depths = 0; /* upside down */
    compare_world(options.folder, options.models[0].c_str(), 0, desc, &result, nullptr, about);
    assert_true(result.hole_pixels > 0 && result.forward_rms > 0.1);
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tiles_in_degrees_meet_in_metres),
        cmocka_unit_test(depths_are_downwards),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
