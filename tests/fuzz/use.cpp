/* What can be done with an asset: rays, light, drawing, edits, LOD meshes. */
#include "fuzz/fuzz.hpp"

#include <geotex/cook.h>
#include <geotex/edit.h>
#include <geotex/render.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace fuzz {

constexpr size_t RAYS = 16;

/* Through and past the bounds, from all sides; some along axes, some of odd lengths. */
static void aim(const gtx_info &info, uint64_t how, gtx_ray rays[RAYS])
{
    Random random(how);
    float centre[3], size = 0;
    for (int k = 0; k < 3; ++k) {
        centre[k] = info.bounds_min[k] / 2 + info.bounds_max[k] / 2;
        size = std::max(size, info.bounds_max[k] - info.bounds_min[k]);
    }
    for (size_t i = 0; i < RAYS; ++i) {
        gtx_ray &ray = rays[i];
        ray = {};
        for (int k = 0; k < 3; ++k)
            ray.direction[k] = i < 3 ? float(size_t(k) == i) : random.unit() * 2 - 1;
        for (int k = 0; k < 3; ++k)
            ray.origin[k] = centre[k] + (random.unit() - 0.5f) * 0.5f * size -
                            ray.direction[k] * size;
        if (i == RAYS - 1)
            for (int k = 0; k < 3; ++k)
                ray.direction[k] = random.number(), ray.origin[k] = random.number();
        ray.t_min = i % 5 == 4 ? random.number() : 0;
        ray.t_max = i % 3 ? 0 : std::fabs(random.number());
    }
}

static void check_hits(const gtx_asset *asset, const gtx_hit *hits, size_t count)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    for (const gtx_hit *hit = hits; hit < hits + count; ++hit) {
        if (hit->patch == UINT32_MAX) {
            REQUIRE(std::isinf(hit->t), "no hit at %g", hit->t);
            continue;
        }
        REQUIRE(hit->patch < info.patch_count, "patch %u of %u", hit->patch, info.patch_count);
        const uint16_t *rect = gtx_patches(asset)[hit->patch].rect;
        REQUIRE(hit->x >= 0 && hit->y >= 0 && hit->x <= rect[2] && hit->y <= rect[3],
                "a hit at texel %g %g", hit->x, hit->y);
        REQUIRE(!std::isnan(hit->t), "a hit at no distance");
    }
}

static void use_scene(const gtx_caster *caster, const gtx_ray rays[RAYS], uint64_t how)
{
    gtx_scene_instance instances[2] = {};
    Random random(how + 1);
    for (gtx_scene_instance &instance : instances) {
        instance.caster = caster;
        for (int k = 0; k < 16; ++k)
            instance.transform[k] = k == 15 ? 1.0f : k % 4 == 3 ? 0.0f : random.number();
    }
    for (int k = 0; k < 15; ++k)
        instances[0].transform[k] = k % 5 ? 0.0f : 1.0f;
    gtx_scene *scene = nullptr;
    gtx_error error = {};
    if (gtx_scene_create(instances, 2, nullptr, &scene, &error))
        return REQUIRE(error.result == GTX_ERROR_ARGUMENT, "scene: %s", error.message);
    gtx_hit hits[RAYS];
    uint32_t which[RAYS];
    gtx_scene_raycast(scene, rays, hits, which, RAYS, uint32_t(how % 4));
    gtx_lit_point points[4] = {};
    float shares[4];
    for (int i = 0; i < 4; ++i) {
        std::copy_n(rays[i].origin, 3, points[i].position);
        points[i].normal[i % 3] = 1;
        points[i].turn = float(i) / 4;
    }
    gtx_light_desc light = {};
    light.rays = 2;
    for (int sky = 0; sky < 2; ++sky) {
        light.direction[1] = sky ? 0.0f : random.number();
        light.spread = std::fabs(random.number());
        if (!gtx_scene_light(scene, &light, points, shares, 4))
            for (float share : shares)
                REQUIRE(share >= 0 && share <= 1, "a share of light of %g", share);
    }
    gtx_scene_destroy(scene);
}

static void cast(const gtx_asset *asset, uint64_t how)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    gtx_ray rays[RAYS];
    gtx_hit hits[RAYS], drops[2];
    float colors[RAYS][4];
    aim(info, how, rays);
    Counted memory;
    const gtx_allocator hooks = memory.hooks();
    gtx_caster_desc desc = {};
    desc.allocator = &hooks;
    desc.level = uint32_t(how % 9 % 8);
    desc.max_error = how % 9 == 8 ? (info.bounds_max[0] - info.bounds_min[0]) / 64 : 0;
    gtx_caster *caster = nullptr;
    gtx_error error = {};
    if (gtx_caster_create(asset, &desc, &caster, &error))
        return REQUIRE(!std::isfinite(desc.max_error), "caster: %s", error.message);
    const uint32_t flags = how >> 8 & 3;
    gtx_raycast(caster, rays, hits, RAYS, flags | GTX_RAY_EXHAUSTIVE);
    check_hits(asset, hits, RAYS);
    gtx_raycast(caster, rays, hits, RAYS, flags);
    check_hits(asset, hits, RAYS);
    gtx_hit_colors(asset, hits, colors, RAYS);
    const float up[3] = {0, 1, 0};
    const float points[2][3] = {{rays[3].origin[0], rays[3].origin[1], rays[3].origin[2]},
                                {info.bounds_max[0], info.bounds_max[1], info.bounds_max[2]}};
    gtx_drop(caster, up, 1, points, drops, 2, flags);
    use_scene(caster, rays, how);
    gtx_caster_destroy(caster);
}

static void prepare(const gtx_asset *asset, uint64_t how)
{
    Counted memory;
    const gtx_allocator hooks = memory.hooks();
    gtx_model_desc desc = {};
    desc.allocator = &hooks;
    desc.borrow = how & 1;
    gtx_model *model = nullptr;
    gtx_error error = {};
    REQUIRE(!gtx_model_prepare(asset, &desc, &model, &error), "prepare: %s", error.message);
    REQUIRE(gtx_model_gpu_size(model).geometry > 0, "a model of no bytes");
    gtx_model_destroy(nullptr, model);
}

static void make_lods(const gtx_asset *asset)
{
    gtx_lod_desc desc = {};
    desc.levels = 2;
    desc.threads = 1;
    gtx_asset *out = nullptr;
    gtx_error error = {};
    if (gtx_cook_lod_meshes(asset, &desc, &out, &error))
        return REQUIRE(error.result == GTX_ERROR_MEMORY || error.result == GTX_ERROR_LIMIT,
                       "LOD meshes: %d %s", error.result, error.message);
    round_trip(out, true, "LOD meshes");
    gtx_close(out);
}

void use_asset(const gtx_asset *asset, uint64_t how)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    const uint64_t texels = uint64_t(info.page_count) * info.page_width * info.page_height;
    const uint32_t some = uint32_t(how & 127);
    if (some < 16)
        cast(asset, how >> 7);
    else if (some < 24)
        prepare(asset, how >> 7);
    else if (some < 27 && texels <= 1 << 12) /* slow, as is the next */
        edit_asset(asset, how >> 7);
    else if (some == 32 && texels <= 1 << 11)
        make_lods(asset);
    else if (some < 36 && texels <= 1 << 12)
        combine_asset(asset, how >> 7);
    else if (some == 36 && texels <= 1 << 12)
        export_asset(asset, how >> 7);
}

} // namespace fuzz
