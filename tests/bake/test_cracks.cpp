/* Seams: rays at points all over a surface must be stopped by the patches baked from it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

#include "bake/shapes.hpp"
#include "measure/measure.hpp"

#include <random>

using namespace gtx;

struct Shot {
    gtx_ray ray;
    float target; /* t of the source point aimed at */
};

/* Rays at points spread evenly over the triangles, from directions that see their front. */
static Vector<Shot> aim(const Mesh &mesh, const double anchor[3], size_t count)
{
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0, 1);
    Vector<Shot> shots;
    while (shots.size() < count) {
        size_t t = random() % mesh.triangle_count();
        double a = unit(random), b = unit(random);
        if (a + b > 1) {
            a = 1 - a;
            b = 1 - b;
        }
        Vec3d p = mesh.position(t, 0) * (1 - a - b) + mesh.position(t, 1) * a +
                  mesh.position(t, 2) * b;
        Vec3d d(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
        if (length(d) > 0.5 || length(d) < 1e-3)
            continue;
        d = normalize(d);
        if (dot(d, normalize(mesh.area_vector(t))) > -0.15)
            continue;
        Vec3d from = p - d * 3. - Vec3d(anchor[0], anchor[1], anchor[2]);
        Shot shot = {};
        for (int k = 0; k < 3; ++k) {
            shot.ray.origin[k] = float(from[k]);
            shot.ray.direction[k] = float(d[k]);
        }
        shot.target = 3;
        shots.push_back(shot);
    }
    return shots;
}

/* Where a ray first meets the mesh, infinity when that is nowhere or from behind. */
static double front_depth(const Mesh &mesh, const Vec3d &from, const Vec3d &d)
{
    double nearest = INFINITY;
    bool front = false;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        Vec3d e = mesh.position(t, 1) - mesh.position(t, 0);
        Vec3d f = mesh.position(t, 2) - mesh.position(t, 0), to = from - mesh.position(t, 0);
        Vec3d n = cross(e, f), q = cross(to, d);
        double det = -dot(n, d), u = dot(f, q) / det, v = -dot(e, q) / det, at = dot(n, to) / det;
        if (det != 0 && u >= 0 && v >= 0 && u + v <= 1 && at > 0 && at < nearest) {
            nearest = at;
            front = det > 0;
        }
    }
    return front ? nearest : INFINITY;
}

/* Whether the source lies nearer than `depth` all around a ray: on eight rays a texel aside. Past a
 * silhouette a ray may slip by what sampling rounds off, and that is no crack. */
static bool nearer_all_around(const Mesh &mesh, const double anchor[3], const gtx_ray &ray,
                              double pitch, double depth)
{
    Vec3d from, d;
    for (int k = 0; k < 3; ++k) {
        from[k] = ray.origin[k] + anchor[k];
        d[k] = ray.direction[k];
    }
    Vec3d x = normalize(cross(d, std::fabs(d.x) < 0.5 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0)));
    Vec3d y = cross(d, x);
    for (int i = 0; i < 8; ++i) {
        double turn = i * M_PI / 4;
        Vec3d aside = (x * std::cos(turn) + y * std::sin(turn)) * pitch;
        if (front_depth(mesh, from + aside, d) >= depth)
            return false;
    }
    return true;
}

static gtx_asset *asset_of(const Maps &maps)
{
    Vector<const uint8_t *> levels;
    gtx_asset_desc desc = shapes::describe(maps, levels);
    gtx_asset *asset = nullptr;
    gtx_error error = {};
    if (gtx_create(&desc, &asset, &error))
        fail_msg("%s (rule %u)", error.message, error.rule);
    return asset;
}

/* Rays that pass where the surface is: nothing hit, or only something behind it. `erode` moves all
 * outlines inwards, in sixteenths of a texel. */
static size_t holes(const Mesh &mesh, Partition partition, size_t count, int erode = 0)
{
    Task task(2, nullptr, nullptr, {"bake", "pack"});
    Maps maps = bake(mesh, partition, {}, task);
    for (uint8_t &code : maps.trim)
        code = uint8_t(std::min(code + erode, 255));
    gtx_asset *asset = asset_of(maps);
    gtx_error error = {};
    gtx_caster *caster = nullptr;
    assert_int_equal(gtx_caster_create(asset, nullptr, &caster, &error), GTX_OK);

    Vector<Shot> shots = aim(mesh, maps.anchor, count);
    Vector<gtx_ray> rays;
    for (const Shot &shot : shots)
        rays.push_back(shot.ray);
    Vector<gtx_hit> hits(rays.size());
    assert_int_equal(gtx_raycast(caster, rays.data(), hits.data(), rays.size(), 0), GTX_OK);
    size_t found = 0;
    for (size_t i = 0; i < hits.size(); ++i) {
        double depth = hits[i].t - 2 * partition.pitch;
        found += depth > shots[i].target &&
                 nearer_all_around(mesh, maps.anchor, rays[i], partition.pitch, depth);
    }
    gtx_caster_destroy(caster);
    gtx_close(asset);
    print_message("# %zu patches, %zu rays, %zu holes\n", maps.patches.size(), rays.size(), found);
    return found;
}

/* Ragged charts: each triangle goes to the nearest of `count` scattered seeds whose normal
 * agrees. */
static std::function<int(size_t)> scattered(const Mesh &mesh, int count)
{
    std::mt19937 random(5);
    Vector<size_t> seeds;
    for (int i = 0; i < count; ++i)
        seeds.push_back(random() % mesh.triangle_count());
    auto centre = [&mesh](size_t t) {
        return (mesh.position(t, 0) + mesh.position(t, 1) + mesh.position(t, 2)) * (1 / 3.);
    };
    return [=, &mesh](size_t t) {
        int best = 0;
        double least = 1e300;
        for (int i = 0; i < count; ++i) {
            Vec3d d = centre(t) - centre(seeds[i]);
            double bend = 1 - dot(normalize(mesh.area_vector(t)),
                                  normalize(mesh.area_vector(seeds[i])));
            double cost = dot(d, d) + bend * bend;
            if (cost < least) {
                least = cost;
                best = i;
            }
        }
        return best;
    };
}

static void a_bumpy_ball_of_six_patches(void **)
{
    Mesh mesh = shapes::ball(64, shapes::bumps);
    for (double resolution : {32., 96., 200.})
        assert_int_equal(
            holes(mesh, shapes::split(mesh, shapes::by_axis(mesh), resolution), 100000), 0);
}

static void a_ball_of_ragged_patches(void **)
{
    Mesh mesh = shapes::ball(64, shapes::bumps);
    for (int count : {20, 60, 200})
        assert_int_equal(holes(mesh, shapes::split(mesh, scattered(mesh, count), 64), 100000), 0);
}

static void a_coarse_ball_with_long_triangles(void **)
{
    Mesh mesh = shapes::ball(6, shapes::bumps);
    assert_int_equal(holes(mesh, shapes::split(mesh, scattered(mesh, 40), 64), 100000), 0);
}

static void a_torus_of_ragged_patches(void **)
{
    Mesh mesh = shapes::field(
        96,
        [](double u, double v) {
            double a = 2 * M_PI * u, b = 2 * M_PI * v, r = 0.35 + 0.03 * std::sin(5 * a + 3 * b);
            double ring = 1 + r * std::cos(b);
            return Vec3d(ring * std::cos(a), ring * std::sin(a), r * std::sin(b));
        },
        true);
    for (int count : {40, 120})
        assert_int_equal(holes(mesh, shapes::split(mesh, scattered(mesh, count), 64), 100000), 0);
}

static void a_cube_closes_at_its_edges(void **)
{
    Mesh mesh = shapes::ball(8, [](const Vec3d &d) {
        return 1 / std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
    });
    for (double resolution : {20., 64.})
        assert_int_equal(
            holes(mesh, shapes::split(mesh, shapes::by_axis(mesh), resolution), 100000), 0);
}

static void an_open_field_is_whole_up_to_its_border(void **)
{
    Mesh mesh = shapes::field(40, [](double u, double v) {
        return Vec3d(u, v, 0.1 * std::sin(9 * u) * std::cos(7 * v));
    });
    assert_int_equal(holes(mesh, shapes::split(mesh, scattered(mesh, 12), 48), 100000), 0);
}

/* A wall of six texels, too steep by a third of one for the chart that it is in. */
static void a_wall_that_leans_back_is_whole(void **)
{
    const double texel = 1 / 48., height = 6 * texel, back = texel / 3;
    Mesh mesh = shapes::field(60, [&](double u, double v) {
        const double up = std::clamp((u - 0.4) / 0.2, 0., 1.);
        return Vec3d(u < 0.4 ? u : u > 0.6 ? u - 0.2 - back : 0.4 - back * up, v, height * up);
    });
    Partition partition = shapes::split(mesh, shapes::all_in_one(), 48 * 0.8);
    partition.charts[0].frame = shapes::frame_along(mesh, partition.charts[0].triangles, {0, 0, 1});
    assert_int_equal(holes(mesh, partition, 100000), 0);
}

static void check_seams(const Mesh &mesh, int charts, double within)
{
    Partition partition = shapes::split(mesh, scattered(mesh, charts), 64);
    Task task(2, nullptr, nullptr, {"bake", "pack"});
    gtx_asset *asset = asset_of(bake(mesh, partition, {}, task));
    const SeamReport seams = measure_seams({asset}, mesh, task);
    print_message("# %zu of %zu points within two steps\n", size_t(seams.within_two_steps),
                  size_t(seams.points));
    assert_true(seams.points > 90000);
    assert_true(double(seams.within_two_steps) > within * double(seams.points));
    gtx_close(asset);
}

/* Relief of two texels, and of four, whose sides are steep: each height field alone misses it by
 * more than a step. */
static void fields_meet_where_they_end(void **)
{
    auto bumpy = [](double relief) {
        return shapes::ball(64, [&](const Vec3d &d) {
            return 1 + relief * std::sin(60 * d.x) * std::sin(55 * d.y + 1) * std::cos(50 * d.z);
        });
    };
    for (int charts : {20, 60}) {
        check_seams(bumpy(0.02), charts, 0.998);
        check_seams(bumpy(0.04), charts, 0.984);
    }
}

/* The counter must see seams that are open. */
static void eroded_patches_have_cracks(void **)
{
    Mesh mesh = shapes::ball(64, shapes::bumps);
    assert_true(holes(mesh, shapes::split(mesh, scattered(mesh, 60), 64), 4000, 40) > 100);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_bumpy_ball_of_six_patches),
        cmocka_unit_test(a_ball_of_ragged_patches),
        cmocka_unit_test(a_coarse_ball_with_long_triangles),
        cmocka_unit_test(a_torus_of_ragged_patches),
        cmocka_unit_test(a_cube_closes_at_its_edges),
        cmocka_unit_test(an_open_field_is_whole_up_to_its_border),
        cmocka_unit_test(a_wall_that_leans_back_is_whole),
        cmocka_unit_test(fields_meet_where_they_end),
        cmocka_unit_test(eroded_patches_have_cracks),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
