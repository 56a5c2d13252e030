/* A closed, clean model has no hole, whatever levels of detail are drawn. */
#include "cook/pixels.hpp"

#include <cmath>
#include <cstring>
#include <fstream>

static void assert_closed(const std::string &input, uint32_t size)
{
    const std::string output = in_folder("closed.gtx");
    gtx_error error = {};
    if (gtx_cook_file(input.c_str(), output.c_str(), nullptr, nullptr, &error))
        fail_msg("%s", error.message);
    gtx::CompareOptions options;
    options.size = size;
    const gtx::CompareReport found = compare_pixels(output, input, options);
    assert_true(found.surface_pixels > size * size);
    assert_int_equal(found.hole_pixels, 0);
    assert_int_equal(found.details.size(), 5);
    for (const gtx::DetailReport &detail : found.details)
        assert_int_equal(detail.hole_pixels, 0);
    fs::remove(output);
}

/* A ball of 224 triangles with long spikes and deep pits between them, as OBJ. */
static std::string write_star(uint32_t random)
{
    constexpr int ROWS = 8, COLUMNS = 16;
    constexpr double RADII[] = {0.5, 0.7, 1, 1, 1.3, 1.8}, PI = 3.14159265358979;
    const std::string path = in_folder("star.obj");
    std::ofstream out(path);
    out.precision(9);
    for (int j = 0; j <= ROWS; ++j)
        for (int i = 0; i < (j % ROWS ? COLUMNS : 1); ++i) {
            random = random * 1664525 + 1013904223;
            const double r = RADII[(random >> 16) % 6];
            const double down = PI * j / ROWS, around = 2 * PI * i / COLUMNS;
            out << "v " << r * std::sin(down) * std::cos(around) << ' ' << r * std::cos(down)
                << ' ' << r * std::sin(down) * std::sin(around) << '\n';
        }
    auto at = [](int i, int j) {
        return j ? 2 + (j - 1) * COLUMNS + (j < ROWS ? i % COLUMNS : 0) : 1;
    };
    for (int j = 0; j < ROWS; ++j)
        for (int i = 0; i < COLUMNS; ++i) {
            if (j)
                out << "f " << at(i, j) << ' ' << at(i + 1, j) << ' ' << at(i, j + 1) << '\n';
            if (j + 1 < ROWS)
                out << "f " << at(i + 1, j) << ' ' << at(i + 1, j + 1) << ' ' << at(i, j + 1)
                    << '\n';
        }
    return path;
}

static void stars_stay_closed(void **)
{
    for (uint32_t seed : {3u, 8u, 13u})
        assert_closed(write_star(seed), 256);
}

static void closed_models_stay_closed(void **)
{
    const char *models = getenv("GEOTEX_MODELS");
    if (!models || !*models)
        skip();
    static const char *const names[] = {
        "/gltf/venus.gltf", "/scans/armadillo_86k.obj.gz",
        "/scans/horse.ply.gz", "/scans/ogre.obj.gz",
        "/scans/gargo_3dhop.ply.gz", "/scans/nefertiti.obj.gz",
        "/gltf/bunny_draco.glb", "/scans/rocker-arm.obj",
        "/textured/spot/spot/spot_control_mesh.obj", "/textured/spot/spot/spot_triangulated.obj",
        "/gltf/KhronosSampleModels/Duck/glTF_Binary/Duck.glb",
        "/textured/spot/spot/spot_quadrangulated.obj"};
    const char *corpus = getenv("GTX_CORPUS"); /* all, or every second */
    const size_t step = corpus && !strcmp(corpus, "all") ? 1 : 2;
    for (size_t i = 0; i < sizeof names / sizeof *names; i += step)
        assert_closed(models + std::string(names[i]), 1024);
}

int main()
{
    const CMUnitTest tests[] = {cmocka_unit_test(stars_stay_closed),
                                cmocka_unit_test(closed_models_stay_closed)};
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
