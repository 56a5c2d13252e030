/* Beginnings of files: what a cut shows is an asset, and tells how many bytes show more. */
#include "fuzz/fuzz.hpp"

#include <algorithm>
#include <cstring>

namespace fuzz {

/* What the first bytes made. */
namespace {
struct Cut {
    gtx_result result;
    gtx_prefix prefix = {};
    gtx_asset *asset = nullptr;
    gtx_error error = {};
};
} // namespace

/* From a copy, so that sanitizers see what is read behind it. */
static Cut cut(const uint8_t *data, size_t size, const gtx_allocator *hooks)
{
    const Bytes copy(data, data + size);
    gtx_open_desc desc = {};
    Cut out;
    desc.allocator = hooks;
    desc.limits = small_limits();
    out.result = gtx_open_prefix(copy.empty() ? nullptr : copy.data(), size, &desc, &out.prefix,
                                 &out.asset, &out.error);
    REQUIRE(!out.result || (!out.asset && out.error.result == out.result && *out.error.message),
            "%d is not told", out.result);
    REQUIRE(out.result != GTX_ERROR_TRUNCATED || size == out.prefix.file_size,
            "a cut is called one");
    REQUIRE(out.result || (out.prefix.needed == 0 ? size == out.prefix.file_size && out.asset
                                                  : out.prefix.needed > size),
            "%zu bytes need %llu", size, (unsigned long long)out.prefix.needed);
    return out;
}

/* A cut of what opens opens; what is there is an asset as any other. */
static void check(const Cut &c, bool opens, uint64_t how)
{
    gtx_info info;
    REQUIRE(!opens || !c.result || c.result == GTX_ERROR_LIMIT, "a cut says %d: %s", c.result,
            c.error.message);
    if (!c.asset)
        return;
    gtx_get_info(c.asset, &info);
    REQUIRE(info.lod_levels || !c.prefix.needed, "nothing is shown");
    if (how & 1)
        round_trip(c.asset, true, "a beginning");
    if (how & 2)
        use_asset(c.asset, how >> 2);
}

void run_prefix(const uint8_t *data, size_t size)
{
    constexpr int STAGES = 40;
    const uint64_t how = choices(data, size);
    Counted memory;
    const gtx_allocator hooks = memory.hooks();
    Cut whole = cut(data, size, &hooks);
    const bool opens = whole.asset && !whole.prefix.needed;
    gtx_close(whole.asset);
    Random random(how);
    const size_t any = random.below(uint32_t(size) + 1); /* within a section */
    Cut c = cut(data, any, &hooks);
    check(c, opens, 0);
    gtx_close(c.asset);
    size_t at = 0;
    for (int n = 0; n < STAGES; ++n) { /* as a reader goes on */
        c = cut(data, at, &hooks);
        check(c, opens, c.prefix.needed && random.chance(3) ? how | 1 : 0);
        gtx_close(c.asset);
        if (c.result || !c.prefix.needed || c.prefix.needed > size)
            break;
        at = size_t(c.prefix.needed);
    }
    REQUIRE(memory.most <= small_limits().memory, "opening took %zu bytes", memory.most);
}

} // namespace fuzz
