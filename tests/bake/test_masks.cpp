/* Masks: what a material cuts away has no surface. */
#include "bake/materials.hpp"

/* Whether the height field is hit where a grid of side x side vertical rays meets the unit
 * square. */
static gtx::Vector<bool> look_down(const Maps &maps, unsigned side)
{
    gtx::Vector<const uint8_t *> levels;
    gtx_asset_desc desc = shapes::describe(maps, levels);
    gtx_asset *asset = nullptr;
    gtx_caster *caster = nullptr;
    gtx_error error = {};
    if (gtx_create(&desc, &asset, &error) || gtx_caster_create(asset, nullptr, &caster, &error))
        fail_msg("%s (rule %u)", error.message, error.rule);
    gtx::Vector<gtx_ray> rays;
    for (unsigned j = 0; j < side; ++j)
        for (unsigned i = 0; i < side; ++i)
            rays.push_back({{float((i + 0.5) / side - maps.anchor[0]),
                             float((j + 0.5) / side - maps.anchor[1]), 1}, 0, {0, 0, -1}, 0});
    gtx::Vector<gtx_hit> hits(rays.size());
    gtx_raycast(caster, rays.data(), hits.data(), rays.size(), 0);
    gtx_caster_destroy(caster);
    gtx_close(asset);
    gtx::Vector<bool> seen;
    for (const gtx_hit &hit : hits)
        seen.push_back(hit.patch != UINT32_MAX);
    return seen;
}

/* Rays that see the height field where `off`, the distance to it in object units, is more than
 * `more`, or miss it where it is less than -`less`. */
static int wrong_rays(const Maps &maps, double less, double more,
                      const std::function<double(double, double)> &off)
{
    constexpr unsigned SIDE = 200;
    gtx::Vector<bool> seen = look_down(maps, SIDE);
    int wrong = 0;
    for (unsigned j = 0; j < SIDE; ++j) {
        for (unsigned i = 0; i < SIDE; ++i) {
            double d = off((i + 0.5) / SIDE, (j + 0.5) / SIDE);
            wrong += seen[j * SIDE + i] ? d > more : d < -less;
        }
    }
    return wrong;
}

static double outside_of_disc(double x, double y)
{
    return 0.3 - std::hypot(x - 0.5, y - 0.5);
}

static void a_disc_is_cut_out(void **)
{
    for (uint32_t size : {32u, 256u}) { /* a coarse texture and a fine one */
        HeightField field(6, 64);
        field.mask(size, [](double x, double y) { return outside_of_disc(x, y) < 0; });
        Maps maps = bake_with(field.mesh, field.partition);
        double blur = size < 64 ? 0.5 / size : 0;
        assert_int_equal(wrong_rays(maps, 0.15 / 64 + blur, 0.15 / 64 + blur, outside_of_disc), 0);
        int empty = 0;
        each_texel(maps, [&](double x, double y, size_t at, bool coded) {
            double off = outside_of_disc(x, y);
            assert_true(off < 2. / 64 + blur || !coded); /* no cell that shows needs it */
            empty += off > 2. / 64 + blur && !coded;
            assert_true(!coded || maps.color[0][4 * at + 1] < 195); /* half of the light is 188 */
        });
        assert_true(empty > 800);
    }
}

static double outside_of_fence(double x, double y)
{
    auto bar = [](double s) {
        double at = s * 5 - std::floor(s * 5);
        return (std::fabs(at - 0.5) - 0.2) / 5;
    };
    return std::min(bar(x), bar(y));
}

/* Five by five bars of 0.08, which is five texels; cut into four charts right across the bars. */
static void a_fence_stays_open_across_charts(void **)
{
    HeightField field(8, 64);
    field.mask(512, [](double x, double y) { return outside_of_fence(x, y) < 0; });
    for (int charts : {1, 4}) {
        field.divide(64, [&](size_t t) {
            Vec3d m = field.middle(t);
            return charts == 1 ? 0 : 2 * (m.x > 0.5) + (m.y > 0.5);
        });
        Maps maps = bake_with(field.mesh, field.partition);
        assert_int_equal(maps.patches.size(), charts);
        /* Where two outlines cross, a corner is rounded. */
        assert_int_equal(wrong_rays(maps, 0.25 / 64, 0.5 / 64, outside_of_fence), 0);
    }
}

static void what_is_cut_away_whole_has_no_patch(void **)
{
    HeightField field(4, 32, 2);
    auto right = [&](size_t t) { return int(field.middle(t).x > 0.5); };
    for (size_t t = 0; t < field.mesh.triangle_count(); ++t)
        field.mesh.appearance.material[t] = uint32_t(right(t));
    Material &gone = field.mesh.appearance.materials[1];
    gone.color[3] = 0.2f;
    gone.alpha_cutoff = 0.5f;
    field.divide(32, right);
    Maps maps = bake_with(field.mesh, field.partition);
    assert_int_equal(maps.patches.size(), 1);
    assert_int_equal(wrong_rays(maps, 0.3 / 32, 0.6 / 32,
                                [](double x, double) { return x - 0.5; }), 0);

    std::fill(field.mesh.appearance.material.begin(), field.mesh.appearance.material.end(), 1u);
    gtx_result result = GTX_OK;
    try {
        bake_with(field.mesh, field.partition);
    } catch (const Error &error) {
        result = error.result;
    }
    assert_int_equal(result, GTX_ERROR_EMPTY);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_disc_is_cut_out),
        cmocka_unit_test(a_fence_stays_open_across_charts),
        cmocka_unit_test(what_is_cut_away_whole_has_no_patch),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
