/* glTF made of assets, and assets found in glTF that anyone may have made. */
#include "fuzz/fuzz.hpp"

#include <geotex/export.h>

#include <cstdlib>
#include <cstring>

namespace fuzz {

void find_embedded(const uint8_t *data, size_t size)
{
    const void *asset = nullptr;
    size_t asset_size = 0;
    gtx_error error = {};
    if (gtx_find_asset(data, size, &asset, &asset_size, &error))
        return REQUIRE(error.result == GTX_ERROR_INPUT || error.result == GTX_ERROR_LIMIT ||
                           error.result == GTX_ERROR_MEMORY || error.result == GTX_ERROR_EMPTY ||
                           error.result == GTX_ERROR_NOT_GTX ||
                           error.result == GTX_ERROR_UNSUPPORTED,
                       "find: %d %s", error.result, error.message);
    const size_t at = size_t(static_cast<const uint8_t *>(asset) - data);
    REQUIRE(at <= size && asset_size <= size - at, "an asset of %zu bytes at %zu of %zu",
            asset_size, at, size);
}

void export_asset(const gtx_asset *asset, uint64_t how)
{
    Random random(how);
    void *bytes = nullptr, *out = nullptr;
    size_t size = 0, out_size = 0;
    gtx_error error = {};
    gtx_encode_desc stored = {};
    stored.zstd_level = -1;
    REQUIRE(!gtx_encode(asset, &stored, &bytes, &size, &error), "encode: %s", error.message);
    gtx_export_desc desc = {};
    desc.level = random.chance(4) ? random.below(4) : 0;
    desc.collision = random.chance(3);
    desc.lods = !desc.collision && random.chance(2);
    desc.threads = 1;
    desc.limits = small_limits();
    if (gtx_export_memory(bytes, size, &desc, &out, &out_size, nullptr, &error)) {
        REQUIRE(error.result == GTX_ERROR_ARGUMENT || error.result == GTX_ERROR_LIMIT ||
                    error.result == GTX_ERROR_MEMORY || error.result == GTX_ERROR_EMPTY,
                "export: %d %s", error.result, error.message);
    } else if (!desc.collision) {
        const void *inside = nullptr;
        size_t inside_size = 0;
        REQUIRE(!gtx_find_asset(out, out_size, &inside, &inside_size, &error), "back: %s",
                error.message);
        REQUIRE(inside_size == size && !std::memcmp(inside, bytes, size), "another asset is back");
    }
    std::free(out);
    std::free(bytes);
}

} // namespace fuzz
