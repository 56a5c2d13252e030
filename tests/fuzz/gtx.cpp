/* Opening, against the decoder of the specification: same verdict, same bytes, nothing lost. */
#include "fuzz/decoder.h"
#include "fuzz/fuzz.hpp"

#include "asset/section.h"
#include "base/bytes.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace fuzz {

/* The decoder takes what the header says, whatever is allowed. */
constexpr uint64_t MAX_TEXELS = 1 << 20;

#ifdef GTX_ZSTD
constexpr int MAX_LEVEL = 1;
#else
constexpr int MAX_LEVEL = 0;
#endif

namespace {
struct Verdict {
    gtx_result result;
    gtx_error error{};
    std::vector<uint32_t> rules; /* all that are broken */
};
} // namespace

static void backwards(uint32_t count, void (*job)(uint32_t, void *), void *data, void *)
{
    while (count-- > 0)
        job(count, data);
}

static void note_issue(const gtx_issue *issue, void *user)
{
    REQUIRE(issue->message[0] && issue->name[0], "an issue says nothing");
    if (issue->is_error)
        static_cast<Verdict *>(user)->rules.push_back(issue->rule);
}

static Verdict validated(const uint8_t *data, size_t size)
{
    Verdict out;
    const gtx_limits limits = small_limits();
    out.result = gtx_validate(data, size, &limits, note_issue, &out, &out.error);
    return out;
}

static gtx_asset *opened(const uint8_t *data, size_t size, uint64_t how, gtx_allocator &hooks,
                         gtx_error &error)
{
    const gtx_jobs jobs = {backwards, nullptr};
    gtx_open_desc desc = {};
    desc.allocator = &hooks;
    desc.jobs = how % 4 ? nullptr : &jobs;
    desc.limits = small_limits();
    gtx_asset *asset = nullptr;
    const gtx_result result = gtx_open_memory(data, size, &desc, &asset, &error);
    REQUIRE((result == GTX_OK) == (asset != nullptr), "result %d and an asset", result);
    REQUIRE(!result || (error.result == result && error.message[0]), "%d is not told", result);
    return asset;
}

static uint64_t texels_of(const uint8_t *data, size_t size)
{
    uint64_t texels = 1;
    for (int at : {56, 60, 64})
        texels *= std::min<uint64_t>(size < GTX_HEADER_SIZE ? 0 : gtx_load_u32(data + at), 1 << 20);
    return texels;
}

/* ---- the decoder's bytes ---- */

namespace {
struct Seen {
    const gtx_asset *asset;
    uint32_t sections = 0;
};
} // namespace

static Bytes mesh_bytes(const gtx_asset *asset, uint32_t level)
{
    gtx_lod_mesh mesh;
    gtx_info info;
    gtx_get_info(asset, &info);
    REQUIRE(!gtx_get_lod_mesh(asset, level, &mesh), "there is no LOD mesh %u", level);
    Bytes out;
    const auto append = [&](const void *data, size_t size) {
        const uint8_t *bytes = static_cast<const uint8_t *>(data);
        out.insert(out.end(), bytes, bytes + size);
    };
    append(&mesh, 32);
    append(mesh.first, 4 * (size_t(info.patch_count) + 1));
    append(mesh.indices, 12 * size_t(mesh.triangle_count));
    append(mesh.positions, 6 * size_t(mesh.vertex_count));
    return out;
}

static void compare(const char *type, uint32_t level, const uint8_t *bytes, size_t size,
                    void *user)
{
    Seen *seen = static_cast<Seen *>(user);
    const gtx_asset *asset = seen->asset;
    ++seen->sections;
    if (!asset)
        return;
    static const char *const maps[] = {"HGHT", "TRIM", "NRML", "COLR", "MATL", "EMIT"};
    const void *ours = nullptr;
    size_t our_size = size;
    Bytes mesh;
    for (int i = 0; i < 6; ++i)
        if (!std::strcmp(type, maps[i]))
            ours = gtx_map_data(asset, gtx_map(i), level, &our_size);
    if (!std::strcmp(type, "PTCH"))
        ours = gtx_patches(asset);
    if (!std::strcmp(type, "META"))
        ours = gtx_meta(asset, &our_size);
    if (!std::strcmp(type, "LODM")) {
        mesh = mesh_bytes(asset, level);
        ours = mesh.data();
        our_size = mesh.size();
    }
    REQUIRE(ours && our_size == size && !std::memcmp(ours, bytes, size),
            "bytes of %s %u differ from the decoder's", type, level);
}

/* True where the asset holds every section of the file. */
static bool agree(const uint8_t *data, size_t size, const Verdict &verdict, const gtx_asset *asset)
{
    Seen seen = {asset};
    const unsigned rule = decoder_run(data, size, compare, &seen);
    if (rule == 1 || verdict.result == GTX_ERROR_LIMIT || verdict.result == GTX_ERROR_UNSUPPORTED)
        return false;
    const auto &rules = verdict.rules;
    const bool tolerated = decoder_tolerates(rule) ||
                           std::any_of(rules.begin(), rules.end(), decoder_tolerates);
    REQUIRE((rule != 0) == (verdict.result != 0) || tolerated,
            "the decoder says rule %u, the library %u: %s", rule, verdict.error.rule,
            verdict.error.message);
    /* Where several are broken, each may name another, but of header or content alike. */
    const bool near = std::any_of(rules.begin(), rules.end(),
                                  [&](uint32_t ours) { return (ours < 200) == (rule < 200); });
    REQUIRE(!rule || near || tolerated, "the decoder says rule %u, the library %u: %s", rule,
            verdict.error.rule, verdict.error.message);
    return asset && seen.sections == gtx_load_u32(data + 28);
}

/* ---- what was opened ---- */

void round_trip(const gtx_asset *asset, bool hashed, const char *who)
{
    Counted memory;
    gtx_allocator hooks = memory.hooks();
    gtx_error error = {};
    gtx_info info, info_again;
    gtx_get_info(asset, &info);
    for (int level = 0; level <= MAX_LEVEL; ++level) {
        gtx_encode_desc desc = {};
        desc.allocator = &hooks;
        desc.zstd_level = level ? level : -1;
        void *file = nullptr, *file_again = nullptr;
        size_t size = 0, size_again = 0;
        REQUIRE(!gtx_encode(asset, &desc, &file, &size, &error), "%s: %s", who, error.message);
        gtx_open_desc open = {};
        open.allocator = &hooks;
        gtx_asset *again = nullptr;
        REQUIRE(!gtx_open_memory(file, size, &open, &again, &error), "%s does not open: %u %s", who,
                error.rule, error.message);
        gtx_get_info(again, &info_again);
        REQUIRE(!hashed || info.content_hash == info_again.content_hash,
                "%s: another content hash", who);
        REQUIRE(!gtx_encode(again, &desc, &file_again, &size_again, &error), "%s: %s", who,
                error.message);
        REQUIRE(size == size_again && !std::memcmp(file, file_again, size), "%s: other bytes", who);
        gtx_close(again);
        hooks.free(file, size, hooks.user);
        hooks.free(file_again, size_again, hooks.user);
    }
}

/* gtx_create takes what gtx_open gave, and makes the same of it. */
static void create_again(const gtx_asset *asset, bool hashed)
{
    gtx_info info, info_again;
    gtx_get_info(asset, &info);
    const uint8_t *maps[4][8];
    gtx_lod_mesh meshes[8];
    for (uint32_t level = 0; level < info.mip_count; ++level)
        for (int map = 0; map < 4; ++map)
            maps[map][level] = static_cast<const uint8_t *>(
                gtx_map_data(asset, gtx_map(GTX_MAP_NORMAL + map), level, nullptr));
    for (uint32_t level = 0; level < info.lod_levels; ++level)
        gtx_get_lod_mesh(asset, level, &meshes[level]);
    gtx_asset_desc desc = {};
    desc.patches = gtx_patches(asset);
    desc.patch_count = info.patch_count;
    desc.page_count = info.page_count;
    desc.page_width = info.page_width;
    desc.page_height = info.page_height;
    desc.mip_count = info.mip_count;
    desc.height_bits = info.height_bits;
    desc.height = gtx_map_data(asset, GTX_MAP_HEIGHT, 0, nullptr);
    desc.trim = static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_TRIM, 0, nullptr));
    desc.normal = maps[0];
    desc.color = info.has_color ? maps[1] : nullptr;
    desc.material = info.has_material ? maps[2] : nullptr;
    desc.emission = info.has_emission ? maps[3] : nullptr;
    desc.emission_scale = info.emission_scale;
    desc.lod = meshes;
    desc.lod_levels = info.lod_levels;
    desc.meta = gtx_meta(asset, &desc.meta_size);
    std::copy_n(info.bounds_min, 3, desc.bounds_min);
    std::copy_n(info.bounds_max, 3, desc.bounds_max);
    std::copy_n(info.anchor, 3, desc.anchor);
    desc.unit = info.unit;
    desc.source_triangles = info.source_triangles;
    Counted memory;
    const gtx_allocator hooks = memory.hooks();
    desc.allocator = &hooks;
    gtx_asset *again = nullptr;
    gtx_error error = {};
    REQUIRE(!gtx_create(&desc, &again, &error), "gtx_create: %u %s", error.rule, error.message);
    gtx_get_info(again, &info_again);
    REQUIRE(!hashed || info.content_hash == info_again.content_hash, "gtx_create: another hash");
    gtx_close(again);
}

/* The same through a file. */
static void save_and_open(const gtx_asset *asset)
{
    Counted memory;
    const gtx_allocator hooks = memory.hooks();
    gtx_encode_desc encode = {};
    encode.allocator = &hooks;
    gtx_open_desc open = {};
    open.allocator = &hooks;
    open.limits = small_limits();
    gtx_asset *again = nullptr;
    gtx_error error = {};
    const std::string path = scratch("a.gtx");
    REQUIRE(!gtx_save_file(asset, path.c_str(), &encode, &error), "saving: %s", error.message);
    REQUIRE(!gtx_open_file(path.c_str(), &open, &again, &error), "opening: %s", error.message);
    gtx_close(again);
}

void run_gtx(const uint8_t *data, size_t size)
{
    const uint64_t how = choices(data, size);
    Counted memory;
    gtx_allocator hooks = memory.hooks();
    gtx_error error = {};
    gtx_asset *asset = opened(data, size, how, hooks, error);
    REQUIRE(memory.most <= small_limits().memory, "opening took %zu bytes", memory.most);
    const Verdict verdict = validated(data, size);
    REQUIRE(verdict.result == error.result && verdict.error.rule == error.rule,
            "opening says %d, rule %u; validating %d, rule %u", error.result, error.rule,
            verdict.result, verdict.error.rule);
    const bool known = texels_of(data, size) <= MAX_TEXELS;
    const bool whole = known && agree(data, size, verdict, asset);
    if (asset && known) {
        if (how >> 8 & 1)
            create_again(asset, whole);
        else if (how >> 9 & 1)
            round_trip(asset, whole, "what was opened");
        if (how >> 59 == 0)
            save_and_open(asset);
        use_asset(asset, how >> 10);
    }
    gtx_close(asset);
}

} // namespace fuzz
