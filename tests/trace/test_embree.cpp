/* Random rays into a cooked scan against Embree on the mesh that it was cooked from: outside a band
 * of one texel they hit the same place, or both nothing. Skipped without models or Embree. */
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

#if __has_include(<embree3/rtcore.h>)
#include "mesh/mesh.hpp"

#include <embree3/rtcore.h>
#include <geotex/cook.h>

using namespace gtx;

struct Target {
    gtx_asset *asset = nullptr;
    gtx_caster *caster = nullptr;
    gtx_info info = {};
    double texel = 0;         /* the widest */
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
};

static void cook(Target &target, const std::string &path)
{
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    gtx_error error = {};
    if (gtx_cook_memory(bytes.data(), bytes.size(), path.c_str(), nullptr, &target.asset, nullptr,
                        &error) ||
        gtx_caster_create(target.asset, nullptr, &target.caster, &error))
        fail_msg("%s", error.message);
    gtx_get_info(target.asset, &target.info);
    for (uint32_t i = 0; i < target.info.patch_count; ++i) {
        const gtx_patch &p = gtx_patches(target.asset)[i];
        target.texel = std::fmax(target.texel, p.extent_x / p.rect[2]);
        target.texel = std::fmax(target.texel, p.extent_y / p.rect[3]);
    }
}

static void load(Target &target, const std::string &path)
{
    Task task(0, nullptr, nullptr);
    CleanReport report;
    const Mesh mesh = clean_mesh(import_mesh(path, task), task, report);
    const Vec3d anchor(target.info.anchor[0], target.info.anchor[1], target.info.anchor[2]);
    const size_t corners = 3 * mesh.triangle_count();
    target.device = rtcNewDevice("threads=1");
    target.scene = rtcNewScene(target.device);
    RTCGeometry geometry = rtcNewGeometry(target.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto *points = static_cast<float *>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), corners));
    auto *indices = static_cast<uint32_t *>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(uint32_t), corners / 3));
    for (size_t c = 0; c < corners; ++c) {
        const Vec3f p(mesh.position(c / 3, int(c % 3)) - anchor);
        points[3 * c] = p.x;
        points[3 * c + 1] = p.y;
        points[3 * c + 2] = p.z;
        indices[c] = uint32_t(c);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(target.scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(target.scene, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(target.scene);
}

/* Infinity for a miss. */
static float embree(const Target &target, const gtx_ray &ray)
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit hit = {};
    hit.ray.org_x = ray.origin[0];
    hit.ray.org_y = ray.origin[1];
    hit.ray.org_z = ray.origin[2];
    hit.ray.dir_x = ray.direction[0];
    hit.ray.dir_y = ray.direction[1];
    hit.ray.dir_z = ray.direction[2];
    hit.ray.tfar = INFINITY;
    hit.ray.mask = ~0u;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(target.scene, &context, &hit);
    return hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? INFINITY : hit.ray.tfar;
}

using Random = std::mt19937_64;

static Vec3d on_sphere(Random &random)
{
    std::uniform_real_distribution<double> uniform;
    const double z = 2 * uniform(random) - 1, turn = 6.283185307179586 * uniform(random);
    const double r = std::sqrt(1 - z * z);
    return Vec3d(r * std::cos(turn), r * std::sin(turn), z);
}

static gtx_ray ray_between(const Vec3d &from, const Vec3d &to)
{
    const Vec3d way = normalize(to - from);
    return {{float(from.x), float(from.y), float(from.z)}, 0,
            {float(way.x), float(way.y), float(way.z)}, 0};
}

/* Both nothing, or places less than a texel apart. */
static bool alike(const Target &target, float a, float b)
{
    return (std::isinf(a) && std::isinf(b)) || std::fabs(a - b) <= float(target.texel);
}

/* Whether the mesh answers so to a ray that lies less than a texel aside: near an outline, or where
 * the surface is steep to the ray. */
static bool in_band(const Target &target, const Vec3d &from, const Vec3d &to, float answer)
{
    const Vec3d way = normalize(to - from);
    const Vec3d x = normalize(cross(way, std::fabs(way.x) < 0.5 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0)));
    const Vec3d y = cross(way, x);
    for (int i = 0; i < 64; ++i) {
        const double r = target.texel * std::sqrt((i + 1) / 64.), turn = 2.399963 * i;
        const Vec3d aside = x * (r * std::cos(turn)) + y * (r * std::sin(turn));
        if (alike(target, embree(target, ray_between(from + aside, to + aside)), answer))
            return true;
    }
    return false;
}

/* Shadow rays from where chords hit, to suns low over the horizon of the normal there and of the
 * mesh: were height fields to shade themselves, more points would be dark than by the mesh. */
static void shadows_agree(const Target &target, const Vec3d &centre, double radius, Random &random)
{
    gtx_scene_instance one = {target.caster, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    gtx_scene *scene;
    assert_int_equal(gtx_scene_create(&one, 1, nullptr, &scene, nullptr), GTX_OK);
    const double offset = gtx_scene_offset(scene);
    size_t points = 0, dark = 0, dark_alone = 0, lit_alone = 0;
    while (points < 50000) {
        const Vec3d from = centre + on_sphere(random) * radius;
        const gtx_ray ray = ray_between(from, centre + on_sphere(random) * radius);
        gtx_hit hit;
        gtx_raycast(target.caster, &ray, &hit, 1, 0);
        if (hit.patch == UINT32_MAX || !alike(target, hit.t, embree(target, ray)))
            continue;
        const Vec3d n(hit.normal[0], hit.normal[1], hit.normal[2]);
        const Vec3d way(ray.direction[0], ray.direction[1], ray.direction[2]);
        const Vec3d point = from + way * double(hit.t);
        const Vec3d sun = normalize(cross(n, on_sphere(random)) + n * 0.1);
        gtx_lit_point lit = {{float(point.x), float(point.y), float(point.z)},
                             {hit.normal[0], hit.normal[1], hit.normal[2]}, 0};
        gtx_light_desc light = {};
        light.direction[0] = float(sun.x);
        light.direction[1] = float(sun.y);
        light.direction[2] = float(sun.z);
        float share;
        gtx_scene_light(scene, &light, &lit, &share, 1);
        const Vec3d start = point + n * offset;
        const bool shaded = !std::isinf(embree(target, ray_between(start, start + sun)));
        ++points;
        dark += shaded;
        dark_alone += !shaded && share == 0;
        lit_alone += shaded && share > 0;
    }
    gtx_scene_destroy(scene);
    print_message("# of %zu points in grazing light %zu are dark by the mesh; %zu only by the "
                  "asset, %zu only by the mesh\n", points, dark, dark_alone, lit_alone);
    assert_true(dark_alone + lit_alone < points / 200);
}

/* One in 50,000 may differ beyond the band: cells may bridge what is up to 12 texels apart in
 * depth, as at the folds of a scan, and rays almost along such a cell see it where the mesh has
 * nothing. */
static void chords_agree(const char *model, size_t count)
{
    const char *models = std::getenv("GEOTEX_MODELS");
    if (!models)
        skip();
    Target target;
    const std::string path = std::string(models) + "/" + model;
    cook(target, path);
    load(target, path);
    Vec3d centre, half;
    double radius = 0;
    for (int k = 0; k < 3; ++k) {
        (&centre.x)[k] = (target.info.bounds_min[k] + target.info.bounds_max[k]) / 2;
        (&half.x)[k] = (target.info.bounds_max[k] - target.info.bounds_min[k]) / 2;
    }
    radius = length(half);
    Random random(5);
    size_t hits = 0, band = 0, wrong = 0, other = 0;
    for (size_t i = 0; i < count; ++i) {
        const Vec3d from = centre + on_sphere(random) * radius;
        const Vec3d to = centre + on_sphere(random) * radius;
        const gtx_ray ray = ray_between(from, to);
        gtx_hit hit;
        gtx_raycast(target.caster, &ray, &hit, 1, 0);
        const float expected = embree(target, ray);
        hits += !std::isinf(expected);
        if (alike(target, hit.t, expected))
            continue;
        const bool excused = in_band(target, from, to, hit.t);
        band += excused;
        wrong += !excused && std::isinf(hit.t) != std::isinf(expected);
        other += !excused && std::isinf(hit.t) == std::isinf(expected);
    }
    print_message("# %s: %zu rays, %zu hit, %zu within the band of a texel (%.2g), outside it %zu "
                  "differ in hit or miss and %zu in place\n", model, count, hits, band,
                  target.texel, wrong, other);
    shadows_agree(target, centre, radius, random);
    rtcReleaseScene(target.scene);
    rtcReleaseDevice(target.device);
    gtx_caster_destroy(target.caster);
    gtx_close(target.asset);
    assert_true(hits > count / 10);
    assert_true(band * 50 <= count);
    assert_true((wrong + other) * 50000 <= count);
}

static void bunny(void **)
{
    chords_agree("scans/bunny.ply", 200000);
}

static void dragon(void **)
{
    chords_agree("draco/dragon_810k_loop_q14.drc", 200000);
}
#else
static void bunny(void **)
{
    skip();
}

static void dragon(void **)
{
    skip();
}
#endif

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bunny),
        cmocka_unit_test(dragon),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
