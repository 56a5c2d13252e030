/* Baked maps: valid as an asset, on the surface, whole, and the same for any thread count. */
#include "bake/baked.hpp"

static void a_bumpy_ball_lies_on_its_surface(void **)
{
    Mesh mesh = shapes::ball(48, shapes::bumps);
    Partition partition = shapes::split(mesh, shapes::by_axis(mesh), 96);
    for (unsigned bits : {8u, 16u}) {
        BakeOptions options;
        options.height_bits = bits;
        Maps maps = bake_valid(mesh, partition, options);
        assert_int_equal(maps.patches.size(), partition.charts.size());
        double inside = 0, outside = 0, sum = 0, count = 0;
        each_texel(maps, [&](const gtx_patch &, const Vec3d &p, double trim, size_t) {
            double &worst = trim <= 0.3 ? inside : outside;
            double off = std::fabs(length(p) - shapes::bumps(normalize(p)));
            worst = std::max(worst, off);
            sum += trim <= 0.3 ? off : 0;
            count += trim <= 0.3;
        });
        print_message("# %u bits: %.5f on the mean, %.5f shown, %.5f beyond\n", bits, sum / count,
                      inside, outside);
        assert_true(sum / count < 0.001);
        assert_true(inside < 0.017); /* a texel: as far as fitting may move a height at a crease */
        assert_true(outside < 0.06); /* continued by up to two texels of 0.017 */
    }
}

static void normals_are_those_of_the_source(void **)
{
    Mesh mesh = shapes::ball(48, [](const Vec3d &) { return 1.; });
    Maps maps = bake_valid(mesh, shapes::split(mesh, shapes::by_axis(mesh), 96));
    double worst = 1;
    each_texel(maps, [&](const gtx_patch &patch, const Vec3d &p, double trim, size_t at) {
        float rows[3][3], n[3];
        gtx_normal_frame(&patch, rows);
        gtx_decode_normal(&maps.normal[0][2 * at], n);
        Vec3d normal;
        for (int k = 0; k < 3; ++k)
            normal[k] = n[0] * rows[0][k] + n[1] * rows[1][k] + n[2] * rows[2][k];
        if (trim <= 0)
            worst = std::min(worst, dot(normal, normalize(p)));
    });
    print_message("# worst cosine %.6f\n", worst);
    assert_true(worst > 0.9998);
}

/* A floor, a wall and a roof, each as even as can be. */
static void walls_are_shaded_as_walls(void **)
{
    constexpr unsigned N = 41, BELOW = 20; /* columns; those of the floor */
    Mesh mesh = shapes::field(N, [](double u, double v) {
        const bool above = u * N > BELOW + 0.5;
        return Vec3d(std::floor(u * N + 0.5) - above, v * (N - 1), above ? 30 : 0);
    });
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (size_t k = 3 * t; k < 3 * t + 3; ++k)
            mesh.normals[k] = Vec3f(normalize(mesh.area_vector(t)));
    Partition partition = shapes::split(mesh, shapes::all_in_one(), N - 1);
    partition.charts[0].frame = shapes::frame_along(mesh, partition.charts[0].triangles, {0, 0, 1});
    Maps maps = bake_valid(mesh, partition);
    size_t beside = 0;
    each_texel(maps, [&](const gtx_patch &patch, const Vec3d &p, double trim, size_t at) {
        if (patch.axis_z[2] < 0.9f || trim > 0) /* the wall's own */
            return;
        float frame[3][3], n[3];
        gtx_normal_frame(&patch, frame);
        gtx_decode_normal(&maps.normal[0][2 * at], n);
        const double west = -(n[0] * frame[0][0] + n[1] * frame[1][0] + n[2] * frame[2][0]);
        const double away = std::fabs(p.x - BELOW);
        beside += west > 0.7;
        assert_true(away < 1.1 * partition.pitch || west < 0.01);
    });
    const double rows = (N - 1) / partition.pitch; /* one above and one below */
    assert_in_range(beside, 2 * (rows - 2), 2 * rows);
}

static void the_whole_core_is_shown(void **)
{
    Mesh mesh = shapes::ball(32, shapes::bumps);
    Partition partition = shapes::split(mesh, shapes::by_axis(mesh), 64);
    Maps maps = bake_with(mesh, partition);
    for (size_t c = 0; c < partition.charts.size(); ++c) {
        const gtx_patch &p = maps.patches[c];
        Vec3d x(p.axis_x[0], p.axis_x[1], p.axis_x[2]), y(p.axis_y[0], p.axis_y[1], p.axis_y[2]);
        Vec3d origin(p.origin[0] + maps.anchor[0], p.origin[1] + maps.anchor[1],
                     p.origin[2] + maps.anchor[2]);
        for (uint32_t t : partition.charts[c].triangles) {
            for (int k = 0; k < 3; ++k) { /* hand-made frames are orthogonal */
                Vec3d q = mesh.position(t, k) - origin;
                double u = dot(q, x) / p.extent_x * p.rect[2] - 0.5;
                double v = dot(q, y) / p.extent_y * p.rect[3] - 0.5;
                int i = int(std::floor(u)), j = int(std::floor(v));
                assert_true(i >= 0 && j >= 0 && i + 1 < p.rect[2] && j + 1 < p.rect[3]);
                double trim = 0;
                for (int n = 0; n < 4; ++n) {
                    int a = i + n % 2, b = j + n / 2;
                    size_t at = (size_t(p.page) * maps.page_height + p.rect[1] + b) *
                                    maps.page_width + p.rect[0] + a;
                    assert_true(maps.height[at] != 0);
                    double weight = (1 - std::fabs(u - a)) * (1 - std::fabs(v - b));
                    trim += weight * (maps.trim[at] - 128) / 16.;
                }
                assert_true(trim <= 0.3);
            }
        }
    }
}

static void any_thread_count_gives_the_same_bytes(void **)
{
    Mesh mesh = shapes::ball(24, shapes::bumps);
    mesh.colors.resize(3 * mesh.triangle_count());
    for (size_t i = 0; i < mesh.colors.size(); ++i)
        mesh.colors[i] = {uint8_t(i), uint8_t(i / 7), uint8_t(i / 31), 255};
    Partition partition = shapes::split(mesh, shapes::by_axis(mesh), 40);
    Maps one = bake_with(mesh, partition);
    for (unsigned threads : {2u, 5u}) {
        Maps many = bake_with(mesh, partition, {}, threads);
        assert_true(one.height == many.height && one.trim == many.trim);
        assert_true(one.normal == many.normal && one.color == many.color);
        assert_memory_equal(one.patches.data(), many.patches.data(),
                            one.patches.size() * sizeof(gtx_patch));
        assert_memory_equal(one.bounds_min, many.bounds_min, sizeof one.bounds_min);
    }
}

static void far_away_keeps_its_precision(void **)
{
    Vec3d far(1e7, -2e7, 3e7);
    Mesh mesh = shapes::field(16, [&](double u, double v) {
        return far + Vec3d(u, v, 0.1 * std::sin(6 * u) * std::cos(5 * v));
    });
    Maps maps = bake_valid(mesh, shapes::split(mesh, shapes::all_in_one(), 64));
    assert_true(std::fabs(maps.anchor[0] - far.x) <= 2);
    double worst = 0;
    each_texel(maps, [&](const gtx_patch &, const Vec3d &p, double trim, size_t) {
        Vec3d q = p - far;
        if (trim <= 0)
            worst = std::max(worst, std::fabs(q.z - 0.1 * std::sin(6 * q.x) * std::cos(5 * q.y)));
    });
    assert_true(worst < 5e-3);
}

static void a_tilted_frame_is_followed(void **)
{
    Mesh mesh = shapes::field(16, [](double u, double v) { return Vec3d(u, v, 0.5 * u); });
    Partition partition = shapes::split(mesh, shapes::all_in_one(), 64);
    Frame &frame = partition.charts[0].frame;
    frame.origin = {0, 0, 0};
    frame.x = normalize(Vec3d(1, 0, 0.5));
    frame.y = {0, 1, 0};
    frame.z = {0, 0, 1};
    Maps maps = bake_valid(mesh, partition);
    assert_true(maps.patches[0].extent_z < 1e-3f); /* the slope is in the axis */
    each_texel(maps, [&](const gtx_patch &, const Vec3d &p, double, size_t) {
        assert_true(std::fabs(p.z - 0.5 * p.x) < 1e-3);
    });
}

static void colours_stay_and_are_averaged_in_light(void **)
{
    Mesh mesh = shapes::field(8, [](double u, double v) { return Vec3d(u, v, 0); });
    Partition partition = shapes::split(mesh, shapes::all_in_one(), 32);
    mesh.colors.assign(3 * mesh.triangle_count(), Rgba8{10, 100, 200, 77});
    Maps maps = bake_valid(mesh, partition);
    assert_int_equal(maps.color.size(), 4);
    const uint8_t expected[4] = {10, 100, 200, 77};
    each_texel(maps, [&](const gtx_patch &, const Vec3d &, double, size_t at) {
        assert_memory_equal(&maps.color[0][4 * at], expected, 4);
    });
    size_t middle = size_t(maps.page_height / 8 / 2) * (maps.page_width / 8) + maps.page_width / 16;
    assert_memory_equal(&maps.color[3][4 * middle], expected, 4);

    for (size_t t = 0; t < mesh.triangle_count(); ++t) /* black left half, white right half */
        for (int k = 0; k < 3; ++k)
            mesh.colors[3 * t + k] = mesh.position(t, 0).x + mesh.position(t, 1).x +
                                                 mesh.position(t, 2).x < 1.5
                                         ? Rgba8{0, 0, 0, 255}
                                         : Rgba8{255, 255, 255, 255};
    BakeOptions options;
    options.mips = 7; /* one texel in the end */
    maps = bake_valid(mesh, partition, options);
    uint8_t grey = maps.color[6][0];
    assert_true(grey > 175 && grey < 200); /* half the light is 188, half the code 128 */
}

static void maps_around_the_surface_are_dilated(void **)
{
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    mesh.colors.assign(3, Rgba8{200, 200, 200, 255});
    shapes::add_normals(mesh);
    Maps maps = bake_valid(mesh, shapes::split(mesh, shapes::all_in_one(), 64));
    const gtx_patch &p = maps.patches[0];
    assert_int_equal(p.dilation, 8);
    auto coded = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < p.rect[2] && y < p.rect[3] &&
               maps.height[size_t(p.rect[1] + y) * maps.page_width + p.rect[0] + x] != 0;
    };
    for (int y = 0; y < p.rect[3]; ++y) {
        for (int x = 0; x < p.rect[2]; ++x) {
            bool near = false;
            for (int b = -8; b <= 8 && !near; ++b)
                for (int a = -8; a <= 8 && !near; ++a)
                    near = coded(x + a, y + b);
            size_t at = size_t(p.rect[1] + y) * maps.page_width + p.rect[0] + x;
            assert_int_equal(maps.color[0][4 * at], near ? 200 : 0);
        }
    }
}

static void every_option_gives_a_valid_asset(void **)
{
    Mesh mesh = shapes::ball(10, shapes::bumps);
    mesh.colors.assign(3 * mesh.triangle_count(), Rgba8{1, 2, 3, 4});
    Partition partition = shapes::split(mesh, shapes::by_axis(mesh), 20);
    partition.charts[1].two_sided = true;
    for (unsigned mips = 1; mips <= 8; ++mips) {
        BakeOptions options;
        options.mips = mips;
        options.height_bits = mips % 2 ? 8 : 16;
        options.dilation = mips * 3;
        Maps maps = bake_valid(mesh, partition, options);
        assert_int_equal(maps.normal.size(), mips);
        assert_int_equal(maps.patches[1].flags, GTX_PATCH_TWO_SIDED);
        assert_int_equal(maps.patches[0].flags, 0);
    }
}

static gtx_result failure(const Mesh &mesh, Partition partition, BakeOptions options)
{
    try {
        bake_with(mesh, partition, options);
    } catch (const Error &error) {
        return error.result;
    }
    return GTX_OK;
}

static void nonsense_is_refused(void **)
{
    Mesh mesh = shapes::field(2, [](double u, double v) { return Vec3d(u, v, 0); });
    Partition partition = shapes::split(mesh, shapes::all_in_one(), 8);
    BakeOptions options;
    options.mips = 9;
    assert_int_equal(failure(mesh, partition, options), GTX_ERROR_ARGUMENT);
    options.mips = 4;
    options.height_bits = 9;
    assert_int_equal(failure(mesh, partition, options), GTX_ERROR_ARGUMENT);
    assert_int_equal(failure(mesh, Partition(), {}), GTX_ERROR_EMPTY);
    Mesh huge = mesh;
    for (Vec3d &p : huge.positions)
        p *= 1e30;
    assert_int_equal(failure(huge, partition, {}), GTX_ERROR_INPUT);
    partition.pitch = 0;
    assert_int_equal(failure(mesh, partition, {}), GTX_ERROR_INTERNAL);
    partition.pitch = 0.1;
    mesh.normals.clear();
    assert_int_equal(failure(mesh, partition, {}), GTX_ERROR_INTERNAL);
}

static void cancelling_stops_the_bake(void **)
{
    Mesh mesh = shapes::ball(10, shapes::bumps);
    Partition partition = shapes::split(mesh, shapes::by_axis(mesh), 20);
    auto stop = [](const gtx_progress *progress, void *) { return int(progress->fraction > 0.2f); };
    Task task(2, stop, nullptr, {"bake", "pack"});
    gtx_result result = GTX_OK;
    try {
        bake(mesh, partition, {}, task);
    } catch (const Error &error) {
        result = error.result;
    }
    assert_int_equal(result, GTX_CANCELLED);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_bumpy_ball_lies_on_its_surface),
        cmocka_unit_test(normals_are_those_of_the_source),
        cmocka_unit_test(walls_are_shaded_as_walls),
        cmocka_unit_test(the_whole_core_is_shown),
        cmocka_unit_test(any_thread_count_gives_the_same_bytes),
        cmocka_unit_test(far_away_keeps_its_precision),
        cmocka_unit_test(a_tilted_frame_is_followed),
        cmocka_unit_test(colours_stay_and_are_averaged_in_light),
        cmocka_unit_test(maps_around_the_surface_are_dilated),
        cmocka_unit_test(every_option_gives_a_valid_asset),
        cmocka_unit_test(nonsense_is_refused),
        cmocka_unit_test(cancelling_stops_the_bake),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
