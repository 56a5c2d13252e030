/* Distinct objects from distinct threads, and one object read from many, as geotex.h promises.
 * `make config=thread test-threads` runs this under the thread sanitizer. */
#include <geotex/cook.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h> /* last: it defines fail() */
}

static constexpr unsigned THREADS = 4;
static std::string folder;

static std::string path_of(const std::string &name)
{
    return folder + "/" + name;
}

static std::string read_file(const std::string &path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/* A bumpy ball as an OBJ of about 2 n^2 triangles. */
static void write_ball(const std::string &path, int n)
{
    std::ofstream out(path);
    for (int j = 0; j <= n; ++j) {
        for (int i = 0; i < n; ++i) {
            double a = 2 * M_PI * i / n, b = M_PI * j / n;
            double r = 1 + 0.05 * std::sin(6 * a) * std::sin(b) * std::sin(5 * b);
            out << "v " << r * std::sin(b) * std::cos(a) << ' ' << r * std::cos(b) << ' '
                << r * std::sin(b) * std::sin(a) << '\n';
        }
    }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            out << "f " << j * n + i + 1 << ' ' << j * n + (i + 1) % n + 1 << ' '
                << (j + 1) * n + (i + 1) % n + 1 << ' ' << (j + 1) * n + i + 1 << '\n';
}

/* Runs body(0..THREADS-1), each on a thread of its own, all at once. cmocka's assertions belong to
 * the main thread, so a body says whether it succeeded. */
static bool in_threads(const std::function<bool(unsigned)> &body)
{
    std::atomic<unsigned> ready{0}, good{0};
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < THREADS; ++i)
        threads.emplace_back([&, i] {
            for (++ready; ready < THREADS;)
                std::this_thread::yield();
            good += body(i);
        });
    for (std::thread &thread : threads)
        thread.join();
    return good == THREADS;
}

static void cooks_run_side_by_side(void **)
{
    std::string one = read_file(path_of("ball.gtx"));
    assert_false(one.empty());
    assert_true(in_threads([](unsigned i) {
        std::string out = path_of("side" + std::to_string(i) + ".gtx");
        gtx_cook_desc desc = {};
        desc.threads = 1 + i;
        desc.measure = i == 0;
        gtx_report report = {};
        bool good = gtx_cook_file(path_of("ball.obj").c_str(), out.c_str(), &desc, &report,
                                  nullptr) == GTX_OK;
        gtx_report_free(&report);
        return good;
    }));
    for (unsigned i = 0; i < THREADS; ++i) {
        std::string path = path_of("side" + std::to_string(i) + ".gtx");
        assert_true(read_file(path) == one);
        unlink(path.c_str());
    }
}

static void assets_open_side_by_side(void **)
{
    const std::string bytes = read_file(path_of("ball.gtx"));
    assert_true(in_threads([&](unsigned) {
        gtx_asset *asset = nullptr;
        if (gtx_open_memory(bytes.data(), bytes.size(), nullptr, &asset, nullptr) != GTX_OK)
            return false;
        const gtx_encode_desc desc = {};
        void *again = nullptr;
        size_t size = 0;
        bool good = gtx_encode(asset, &desc, &again, &size, nullptr) == GTX_OK &&
                    std::string(static_cast<char *>(again), size) == bytes &&
                    gtx_validate(again, size, nullptr, nullptr, nullptr, nullptr) == GTX_OK;
        std::free(again);
        gtx_close(asset);
        return good;
    }));
}

static std::vector<gtx_ray> make_rays()
{
    std::vector<gtx_ray> rays;
    for (int i = 0; i < 4000; ++i) {
        float a = float(i) * 2.4f, z = 1 - float(i) / 2000;
        float r = std::sqrt(1 - z * z);
        rays.push_back({{3 * r * std::cos(a), 3 * r * std::sin(a), 3 * z},
                        0,
                        {-r * std::cos(a) + 0.1f, -r * std::sin(a), -z},
                        0});
    }
    return rays;
}

static void one_asset_and_caster_serve_all(void **)
{
    gtx_asset *asset = nullptr;
    gtx_caster *caster = nullptr;
    assert_int_equal(gtx_open_file(path_of("ball.gtx").c_str(), nullptr, &asset, nullptr), GTX_OK);
    assert_int_equal(gtx_caster_create(asset, nullptr, &caster, nullptr), GTX_OK);
    const std::vector<gtx_ray> rays = make_rays();
    std::vector<gtx_hit> expected(rays.size());
    assert_int_equal(gtx_raycast(caster, rays.data(), expected.data(), rays.size(), 0), GTX_OK);
    assert_true(std::isfinite(expected[0].t));
    assert_true(in_threads([&](unsigned) {
        std::vector<gtx_hit> hits(rays.size());
        gtx_info info;
        gtx_get_info(asset, &info);
        bool good = gtx_raycast(caster, rays.data(), hits.data(), rays.size(), 0) == GTX_OK &&
                    gtx_patches(asset)[info.patch_count - 1].rect[2] > 0 &&
                    gtx_map_data(asset, GTX_MAP_HEIGHT, 0, nullptr) != nullptr;
        for (size_t i = 0; i < rays.size(); ++i)
            good = good && hits[i].t == expected[i].t && hits[i].patch == expected[i].patch;
        gtx_caster *own = nullptr; /* derived from the shared asset */
        good = good && gtx_caster_create(asset, nullptr, &own, nullptr) == GTX_OK;
        gtx_caster_destroy(own);
        return good;
    }));
    gtx_caster_destroy(caster);
    gtx_close(asset);
}

static int set_up(void **)
{
    char name[] = "/tmp/gtx-threads-XXXXXX";
    if (!mkdtemp(name))
        return -1;
    folder = name;
    write_ball(path_of("ball.obj"), 60);
    return gtx_cook_file(path_of("ball.obj").c_str(), path_of("ball.gtx").c_str(), nullptr,
                         nullptr, nullptr);
}

static int tear_down(void **)
{
    unlink(path_of("ball.obj").c_str());
    unlink(path_of("ball.gtx").c_str());
    return rmdir(folder.c_str());
}

int main(void)
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(cooks_run_side_by_side),
        cmocka_unit_test(assets_open_side_by_side),
        cmocka_unit_test(one_asset_and_caster_serve_all),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
