/* Finding the asset that a GLB holds, behind the C API. */
#include "cook/embedded.hpp"

#include "cook/guard.hpp"
#include "mesh/glb.hpp"

#include "base/alloc.h"

#include <geotex/export.h>

namespace gtx {

std::string_view asset_in(std::string_view bytes)
{
    if (bytes.substr(0, 4) != "glTF")
        return bytes;
    const std::string_view found = embedded_asset(bytes);
    if (found.empty())
        throw Error(GTX_ERROR_EMPTY, "the GLB holds no asset");
    return found;
}

Asset open_asset(std::string_view bytes, const gtx_allocator &allocator, const gtx_limits &limits)
{
    gtx_open_desc open = {};
    open.allocator = &allocator;
    open.limits = limits;
    gtx_asset *asset = nullptr;
    gtx_error error;
    require_ok(gtx_open_memory(bytes.data(), bytes.size(), &open, &asset, &error), error);
    return Asset(asset, gtx_close);
}

} // namespace gtx

gtx_result gtx_find_asset(const void *data, size_t size, const void **asset, size_t *asset_size,
                          gtx_error *error)
{
    return gtx::guard(error, [&] {
        gtx::require_argument(data && asset && asset_size,
                              "gtx_find_asset needs bytes and places for the result");
        const std::string_view found = gtx::asset_in({static_cast<const char *>(data), size});
        if (found.substr(0, 4) != "\xabGTX")
            throw gtx::Error(GTX_ERROR_NOT_GTX, "the bytes are neither a .gtx file nor a GLB that "
                                                "holds one");
        *asset = found.data();
        *asset_size = found.size();
    });
}

gtx_result gtx_open_exported(const char *path, const gtx_open_desc *desc, gtx_asset **out,
                             gtx_error *error)
{
    gtx_error first;
    const gtx_result result = gtx_open_file(path, desc, out, &first);
    if (result != GTX_ERROR_NOT_GTX) {
        if (result && error)
            *error = first;
        return result;
    }
    return gtx::guard(error, [&] {
        const gtx_open_desc given = desc ? *desc : gtx_open_desc{};
        const gtx::FileBytes file(path, gtx_allocator_or_default(given.allocator), given.limits);
        if (file.view().substr(0, 4) != "glTF")
            throw gtx::Error(first);
        const std::string_view bytes = gtx::asset_in(file.view());
        gtx_error opened;
        gtx::require_ok(gtx_open_memory(bytes.data(), bytes.size(), desc, out, &opened), opened);
    });
}
