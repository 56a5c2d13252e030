/* Texels follow textures where these show more than relief needs, and not where they do not. */
#include "cook/build.hpp"

static constexpr unsigned PIXELS = 256;

/* A bumpy square, its texture's colours by pixel(x, y), repeated so many times along a side. */
template <class Pixel>
static std::string square_file(const char *name, unsigned times, Pixel pixel)
{
    constexpr unsigned SIDE = 24;
    std::string text = "mtllib " + std::string(name) + ".mtl\nusemtl m\n", image;
    for (unsigned j = 0; j <= SIDE; ++j)
        for (unsigned i = 0; i <= SIDE; ++i) {
            char line[160];
            snprintf(line, sizeof line, "v %u %.3f %u\nvt %.6f %.6f\n", i,
                     std::sin(0.4 * i) * std::cos(0.3 * j), j, double(times) * i / SIDE,
                     double(times) * j / SIDE);
            text += line;
        }
    for (unsigned j = 0; j < SIDE; ++j)
        for (unsigned i = 0; i < SIDE; ++i) {
            const unsigned a = j * (SIDE + 1) + i + 1, b = a + 1, c = a + SIDE + 1, d = c + 1;
            char line[160];
            snprintf(line, sizeof line, "f %u/%u %u/%u %u/%u\nf %u/%u %u/%u %u/%u\n", a, a, d, d, b,
                     b, a, a, c, c, d, d);
            text += line;
        }
    for (unsigned y = 0; y < PIXELS; ++y)
        for (unsigned x = 0; x < PIXELS; ++x)
            image += std::string(3, char(pixel(x, y)));
    const std::string base = in_folder(name);
    write_file(base + ".ppm", "P6\n256 256\n255\n" + image);
    write_file(base + ".mtl", "newmtl m\nmap_Kd " + std::string(name) + ".ppm\n");
    write_file(base + ".obj", text);
    return base + ".obj";
}

static double texels_of(const std::string &model, float density)
{
    gtx_cook_desc desc = {};
    desc.charts = 4;
    desc.texel_density = density;
    const std::string output = in_folder("texels.gtx");
    const Cooked cooked = cook(model, output, desc);
    fs::remove(output);
    return cooked.json["texels_total"];
}

static void what_is_drawn_sharply_gets_texels(void **)
{
    const std::string bars = square_file("bars", 1, [](unsigned x, unsigned y) {
        return x / 6 % 4 == 0 || y / 6 % 5 == 0 ? 20 : 240;
    });
    const double relief = texels_of(bars, GTX_TEXEL_DENSITY_RELIEF), fine = texels_of(bars, 0);
    assert_true(fine > 2 * relief);
    assert_true(fine < 1.5 * PIXELS * PIXELS);
    const double half = texels_of(bars, 0.5f), all = texels_of(bars, 1);
    assert_true(half > 0.2 * PIXELS * PIXELS && half < 0.4 * PIXELS * PIXELS);
    assert_true(all > 0.9 * PIXELS * PIXELS && all < 1.4 * PIXELS * PIXELS);
    assert_true(texels_of(bars, 1e-3f) == relief); /* never coarser than relief needs */
}

static void what_is_smooth_gets_none(void **)
{
    const std::string smooth = square_file("smooth", 1, [](unsigned x, unsigned y) {
        return 128 + 100 * std::sin(x / 40.) * std::cos(y / 50.);
    });
    assert_true(texels_of(smooth, 0) == texels_of(smooth, GTX_TEXEL_DENSITY_RELIEF));
}

/* No patch could have as many texels as it takes. */
static void what_stays_noise_gets_none(void **)
{
    uint32_t state = 1;
    const std::string noise = square_file("noise", 32, [&](unsigned, unsigned) {
        state = state * 1664525 + 1013904223;
        return state >> 24;
    });
    assert_true(texels_of(noise, 0) == texels_of(noise, GTX_TEXEL_DENSITY_RELIEF));
}

static void a_model_without_textures_stays_as_it_is(void **)
{
    assert_true(texels_of(ball_file(), 4) == texels_of(ball_file(), GTX_TEXEL_DENSITY_RELIEF));
}

static void any_thread_count_gives_the_same_texels(void **)
{
    const std::string bars = in_folder("bars.obj");
    std::set<std::string> hashes;
    for (uint32_t threads : {1u, 3u}) {
        gtx_cook_desc desc = {};
        desc.threads = threads;
        hashes.insert(cook(bars, in_folder("texels.gtx"), desc).json["content_hash"]);
    }
    assert_int_equal(hashes.size(), 1);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(what_is_drawn_sharply_gets_texels),
        cmocka_unit_test(what_is_smooth_gets_none),
        cmocka_unit_test(what_stays_noise_gets_none),
        cmocka_unit_test(a_model_without_textures_stays_as_it_is),
        cmocka_unit_test(any_thread_count_gives_the_same_texels),
    };
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
