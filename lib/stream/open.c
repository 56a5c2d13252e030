/* Opening what was read for a request, if it is the tile that was requested. */
#include <geotex/stream.h>

#include "asset/section.h"
#include "base/error.h"
#include "base/hash.h"

#include <inttypes.h>

static bool is_in_box(const gtx_stream_request *request, const gtx_info *info)
{
    for (int k = 0; k < 3; ++k)
        if (!(info->anchor[k] + (double)info->bounds_min[k] >= request->low[k] &&
              info->anchor[k] + (double)info->bounds_max[k] <= request->high[k]))
            return false;
    return true;
}

static uint64_t held_by(const gtx_asset *asset)
{
    gtx_sizes sizes = {.meta = asset->meta_size};
    for (uint32_t k = 0; k < GTX_MAX_LODS; ++k)
        sizes.lod[k] = asset->lod_size[k];
    return gtx_asset_bytes(&asset->info, &sizes);
}

/* As gtx_open_prefix, but what shows nothing is an error. */
static gtx_result open_beginning(const gtx_stream_request *request, const void *data, size_t size,
                                 const gtx_open_desc *desc, gtx_asset **out, gtx_error *error)
{
    gtx_prefix prefix;
    gtx_result result = gtx_open_prefix(data, size, desc, &prefix, out, error);
    if (!result && (!*out || prefix.file_size != request->file_bytes)) {
        gtx_close(*out);
        *out = NULL;
        result = gtx_fail(error, GTX_ERROR_CORRUPT, "the bytes are not the beginning of the tile");
    }
    return result;
}

gtx_result gtx_stream_open(const gtx_stream_request *request, const void *data, size_t size,
                           const gtx_open_desc *desc, gtx_asset **out, uint64_t *held,
                           gtx_error *error)
{
    if (out)
        *out = NULL;
    if (!request || !out || (!data && size))
        return gtx_fail(error, GTX_ERROR_ARGUMENT,
                        "opening a tile needs its request, bytes, and a place for the asset");
    if (size < request->bytes)
        return gtx_fail(error, GTX_ERROR_TRUNCATED, "the tile ends after %zu of %" PRIu64
                        " bytes", size, request->bytes);
    if (size > request->bytes || gtx_hash_bytes(data, size) != request->hash)
        return gtx_fail(error, GTX_ERROR_CORRUPT, "the bytes are not those of the tile");
    gtx_open_desc open = desc ? *desc : (gtx_open_desc){0};
    if (!open.limits.memory || open.limits.memory > request->memory)
        open.limits.memory = request->memory ? request->memory : 1;
    gtx_result result = request->bytes < request->file_bytes
                            ? open_beginning(request, data, size, &open, out, error)
                            : gtx_open_memory(data, size, &open, out, error);
    if (result)
        return result;
    gtx_info info;
    gtx_get_info(*out, &info);
    if (!is_in_box(request, &info)) {
        gtx_close(*out);
        *out = NULL;
        return gtx_fail(error, GTX_ERROR_CORRUPT, "the tile exceeds its bounding box");
    }
    if (held)
        *held = held_by(*out);
    return GTX_OK;
}
