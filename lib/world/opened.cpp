/* How much memory opening a tile's file takes, and where its beginning ends. */
#include "world/facts.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>

namespace gtx {

/* So that a root's, and an index of 3,500 tiles, are 2 MB. Beginnings of 10^6 triangles have 0.3,
 * and those of grids 0.1: at half of this nothing changes; at double, roots of colours and
 * materials may need more than 2 MB until a first picture. */
constexpr uint64_t MAX_BEGINNING = 1500000;

namespace {

/* Memory hooks that count; every block is freed with its size. */
struct Meter {
    uint64_t now = 0, most = 0;
    static void *take(size_t size, void *user)
    {
        auto *meter = static_cast<Meter *>(user);
        meter->now += size;
        meter->most = std::max(meter->most, meter->now);
        return std::malloc(size);
    }
    static void give(void *memory, size_t size, void *user)
    {
        static_cast<Meter *>(user)->now -= size;
        std::free(memory);
    }
};

using AssetOwner = std::unique_ptr<gtx_asset, void (*)(gtx_asset *)>;

} // namespace

static void run_in_turn(uint32_t count, void (*job)(uint32_t, void *), void *data, void *)
{
    for (uint32_t i = 0; i < count; ++i)
        job(i, data);
}

static gtx_open_desc without_limits()
{
    gtx_open_desc desc = {};
    desc.limits.memory = desc.limits.texels = desc.limits.patches = UINT64_MAX;
    return desc;
}

/* It does take it here. Without jobs the sections share what they are decoded with. */
static uint64_t measured(const std::string &bytes, uint64_t size)
{
    Meter meter;
    const gtx_allocator hooks = {Meter::take, Meter::give, &meter};
    const gtx_jobs jobs = {run_in_turn, nullptr};
    gtx_open_desc desc = without_limits();
    gtx_asset *asset = nullptr;
    gtx_prefix prefix = {};
    gtx_error error;
    desc.allocator = &hooks;
    desc.jobs = &jobs;
    require_ok(size < bytes.size()
                   ? gtx_open_prefix(bytes.data(), size, &desc, &prefix, &asset, &error)
                   : gtx_open_memory(bytes.data(), size, &desc, &asset, &error), error);
    gtx_close(asset);
    return meter.most;
}

uint64_t memory_to_open(const std::string &bytes)
{
    return measured(bytes, bytes.size());
}

/* The longest side of any texel: normals and colours are as coarse. */
static double longest_texel(const gtx_asset *asset, const gtx_info &info)
{
    const gtx_patch *patches = gtx_patches(asset);
    float longest = 0;
    for (uint32_t i = 0; i < info.patch_count; ++i)
        longest = std::max({longest, patches[i].extent_x / float(patches[i].rect[2] - 1),
                            patches[i].extent_y / float(patches[i].rect[3] - 1)});
    return double(longest);
}

/* To the last of the sections before heights that shows more, and is not too much to wait for. */
Beginning beginning_of(const std::string &bytes, double error, double deviation)
{
    Beginning out;
    uint64_t content = 0;
    gtx_prefix prefix = {};
    for (uint64_t size = 0; size <= MAX_BEGINNING && size < bytes.size(); size = prefix.needed) {
        const gtx_open_desc desc = without_limits();
        gtx_asset *asset = nullptr;
        gtx_lod_mesh mesh;
        gtx_info info;
        gtx_error failure;
        require_ok(gtx_open_prefix(bytes.data(), size, &desc, &prefix, &asset, &failure), failure);
        const AssetOwner owner(asset, gtx_close);
        if (!asset)
            continue;
        gtx_get_info(asset, &info);
        gtx_get_lod_mesh(asset, 0, &mesh);
        if (info.content_hash == content)
            continue;
        content = info.content_hash;
        out.file.size = size;
        out.error = std::max({error, deviation + double(mesh.error), longest_texel(asset, info)});
    }
    if (out.file.size) {
        out.file = made_of(bytes.substr(0, out.file.size));
        out.memory = measured(bytes, out.file.size);
    }
    return out;
}

} // namespace gtx
