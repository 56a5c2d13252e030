/* Opening and validating: what the public calls ask of the reader. */
#include "asset/read.h"

#include "base/alloc.h"

#include <inttypes.h>
#include <stdio.h>

#define DEFAULT_LIMIT ((uint64_t)4 << 30)

static gtx_result check_open(const gtx_open_desc *desc, gtx_asset **out, gtx_error *error)
{
    if (!out)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "opening needs a place for the asset");
    *out = NULL;
    if (!desc)
        return GTX_OK;
    if (desc->flags & ~(uint32_t)GTX_OPEN_SKIP_HASH)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "unknown flags 0x%08x", desc->flags);
    return gtx_check_reserved(desc->reserved, 5, error);
}

static uint64_t limit_of(const gtx_open_desc *desc)
{
    return desc && desc->max_bytes ? desc->max_bytes : DEFAULT_LIMIT;
}

static gtx_result open_bytes(const void *data, size_t size, const gtx_open_desc *desc,
                             uint64_t limit, gtx_asset **out, gtx_error *error)
{
    gtx_check check = {.error = error};
    const gtx_read_options options = {
        .allocator = gtx_allocator_or_default(desc ? desc->allocator : NULL),
        .jobs = desc ? desc->jobs : NULL,
        .limit = limit,
        .skip_hash = desc && desc->flags & GTX_OPEN_SKIP_HASH,
    };
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
    return open_bytes(data, size, desc, limit_of(desc), out, error);
}

/* The size of a file, which is then read from its start. */
static gtx_result measure(FILE *file, const char *path, uint64_t *size, gtx_error *error)
{
    /* The first read tells a directory, which opens and has a "size" on some systems. */
    if (fgetc(file) == EOF && ferror(file))
        return gtx_fail(error, GTX_ERROR_READ, "cannot read %s", path);
    long end = -1;
    if (!fseek(file, 0, SEEK_END))
        end = ftell(file);
    if (end < 0 || fseek(file, 0, SEEK_SET))
        return gtx_fail(error, GTX_ERROR_READ, "cannot find the size of %s", path);
    *size = (uint64_t)end;
    return GTX_OK;
}

static gtx_result open_stream(FILE *file, const char *path, const gtx_open_desc *desc,
                              gtx_asset **out, gtx_error *error)
{
    uint64_t size = 0, limit = limit_of(desc);
    gtx_result result = measure(file, path, &size, error);
    if (result)
        return result;
    if (size == 0)
        return open_bytes(NULL, 0, desc, limit, out, error);
    if (size > limit || size > SIZE_MAX)
        return gtx_fail(error, GTX_ERROR_LIMIT, "%s has %" PRIu64 " bytes, more than the %" PRIu64
                        " allowed", path, size, limit);
    gtx_allocator allocator = gtx_allocator_or_default(desc ? desc->allocator : NULL);
    void *data = gtx_alloc_array(&allocator, (size_t)size, 1);
    if (!data)
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory for %s", path);
    if (fread(data, 1, (size_t)size, file) == size)
        result = open_bytes(data, (size_t)size, desc, limit - size, out, error);
    else
        result = gtx_fail(error, GTX_ERROR_READ, "cannot read %s to its end", path);
    gtx_free_array(&allocator, data, (size_t)size, 1);
    return result;
}

gtx_result gtx_open_file(const char *path, const gtx_open_desc *desc, gtx_asset **out,
                         gtx_error *error)
{
    gtx_result result = check_open(desc, out, error);
    if (result)
        return result;
    if (!path)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the path to open is NULL");
    FILE *file = fopen(path, "rb");
    if (!file)
        return gtx_fail(error, GTX_ERROR_READ, "cannot open %s", path);
    result = open_stream(file, path, desc, out, error);
    fclose(file);
    return result;
}

gtx_result gtx_validate(const void *data, size_t size, gtx_issue_fn fn, void *user,
                        gtx_error *error)
{
    if (!data && size)
        return gtx_fail(error, GTX_ERROR_ARGUMENT, "the bytes to validate are NULL");
    gtx_check check = {.fn = fn, .user = user, .error = error, .keep_going = true};
    const gtx_read_options options = {.allocator = gtx_allocator_or_default(NULL),
                                      .limit = DEFAULT_LIMIT};
    gtx_asset *asset;
    gtx_result result = gtx_read_asset(&check, &options, data, size, &asset);
    gtx_close(asset);
    return result;
}
