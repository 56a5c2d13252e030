/* Opening and validating: what the public calls ask of the reader. */
#include "asset/read.h"

#include "base/alloc.h"
#include "base/file.h"

static gtx_result check_open(const gtx_open_desc *desc, gtx_asset **out, gtx_error *error)
{
    if (!out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "opening needs a result");
    *out = NULL;
    if (!desc)
        return GTX_OK;
    gtx_result result = gtx_check_limits(&desc->limits, error);
    if (result)
        return result;
    if (desc->flags & ~(uint32_t)GTX_OPEN_SKIP_HASH)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "unknown flags 0x%08x", desc->flags);
    return gtx_check_reserved(desc->reserved, 5, error);
}

/* `held` bytes are taken already, by those to open. */
static gtx_read_options options_of(const gtx_open_desc *desc, uint64_t held)
{
    return (gtx_read_options){
        .allocator = gtx_allocator_or_default(desc ? desc->allocator : NULL),
        .jobs = desc ? desc->jobs : NULL,
        .limits = desc ? &desc->limits : NULL,
        .bytes_held = held,
        .skip_hash = desc && desc->flags & GTX_OPEN_SKIP_HASH,
    };
}

static gtx_result open_bytes(const void *data, size_t size, const gtx_open_desc *desc,
                             uint64_t held, gtx_asset **out, gtx_error *error)
{
    gtx_check check = {.error = error};
    const gtx_read_options options = options_of(desc, held);
    return gtx_read_asset(&check, &options, data, size, out);
}

gtx_result gtx_open_memory(const void *data, size_t size, const gtx_open_desc *desc,
                           gtx_asset **out, gtx_error *error)
{
    gtx_result result = check_open(desc, out, error);
    if (result)
        return result;
    if (!data && size)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the bytes to open are NULL");
    return open_bytes(data, size, desc, 0, out, error);
}

gtx_result gtx_open_prefix(const void *data, size_t size, const gtx_open_desc *desc,
                           gtx_prefix *prefix, gtx_asset **out, gtx_error *error)
{
    gtx_result result = check_open(desc, out, error);
    if (result)
        return result;
    if (!prefix || (!data && size))
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "a prefix to open needs bytes and a result");
    const gtx_read_options options = options_of(desc, 0);
    gtx_prefix found;
    result = gtx_read_prefix(error, &options, data, size, NULL, 0, &found, out);
    if (!result)
        *prefix = found;
    return result;
}

/* What is no asset is not read. */
static gtx_result look_at_head(const uint8_t *head, size_t size, uint64_t file_size, void *user,
                               gtx_error *error)
{
    (void)user;
    gtx_check check = {.error = error, .in_file = true};
    gtx_check_head(&check, head, size, file_size);
    return check.result;
}

gtx_result gtx_open_file(const char *path, const gtx_open_desc *desc, gtx_asset **out,
                         gtx_error *error)
{
    gtx_result result = check_open(desc, out, error);
    if (result)
        return result;
    if (!path)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the path to open is NULL");
    const gtx_limits *limits = desc ? &desc->limits : NULL;
    gtx_file_bytes file = {.allocator = gtx_allocator_or_default(desc ? desc->allocator : NULL),
                           .limit = limits ? limits->memory : 0,
                           .look = look_at_head};
    result = gtx_read_file(path, path, &file, error);
    if (result)
        return result;
    result = open_bytes(file.data, file.size, desc, file.capacity, out, error);
    gtx_free_file(&file);
    return result;
}

gtx_result gtx_validate(const void *data, size_t size, const gtx_limits *limits,
                        gtx_issue_fn fn, void *user, gtx_error *error)
{
    if (limits && gtx_check_limits(limits, error))
        return GTX_ERROR_NOT_ZEROED;
    if (!data && size)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the bytes to validate are NULL");
    gtx_check check = {.fn = fn, .user = user, .error = error, .keep_going = true};
    const gtx_read_options options = {.allocator = gtx_allocator_or_default(NULL),
                                      .limits = limits};
    gtx_asset *asset;
    gtx_result result = gtx_read_asset(&check, &options, data, size, &asset);
    gtx_close(asset);
    return result;
}
