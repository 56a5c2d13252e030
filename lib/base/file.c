/* Reading whole files. */
#include "base/file.h"

#include "base/alloc.h"
#include "base/error.h"
#include "base/limits.h"

#include <errno.h>
#include <string.h>

/* What a stream without a size starts with, and may come to by default. */
static const size_t PIECE = 1 << 16;
static const uint64_t STREAM_LIMIT = (uint64_t)4 << 30;

/* Bytes until the end; 0 where only reading can tell. */
static uint64_t bytes_left(FILE *stream)
{
    const long start = ftell(stream);
    /* A directory opens, and has a "size" on some systems; it cannot be read. */
    if (start < 0 || fgetc(stream) == EOF || fseek(stream, 0, SEEK_END))
        return 0;
    const long end = ftell(stream);
    return fseek(stream, start, SEEK_SET) || end < start ? 0 : (uint64_t)(end - start);
}

static gtx_result grow(gtx_file_bytes *bytes, uint64_t wanted, const char *name, gtx_error *error)
{
    const uint64_t most = bytes->limit < SIZE_MAX ? bytes->limit : SIZE_MAX;
    const size_t capacity = (size_t)(wanted < most ? wanted : most);
    if (capacity <= bytes->size)
        return gtx_fail_limit(error, GTX_LIMITED_MEMORY, name, wanted, most);
    uint8_t *grown = gtx_alloc_raw(&bytes->allocator, capacity, 1);
    if (!grown)
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory for %s", name);
    if (bytes->size)
        memcpy(grown, bytes->data, bytes->size);
    gtx_free_array(&bytes->allocator, bytes->data, bytes->capacity, 1);
    bytes->data = grown;
    bytes->capacity = capacity;
    return GTX_OK;
}

static gtx_result read_all(FILE *stream, uint64_t left, const uint8_t *head, size_t head_size,
                           const char *name, gtx_file_bytes *bytes, gtx_error *error)
{
    gtx_result result = grow(bytes, left > head_size ? left : PIECE, name, error);
    if (result)
        return result;
    bytes->size = head_size < bytes->capacity ? head_size : bytes->capacity;
    memcpy(bytes->data, head, bytes->size);
    if (bytes->size < head_size)
        return gtx_fail_limit(error, GTX_LIMITED_MEMORY, name, head_size, bytes->limit);
    while (!result) {
        bytes->size += fread(bytes->data + bytes->size, 1, bytes->capacity - bytes->size, stream);
        const int next = bytes->size < bytes->capacity ? EOF : fgetc(stream);
        if (next == EOF)
            return GTX_OK;
        result = grow(bytes, 2 * (uint64_t)bytes->capacity, name, error);
        if (!result)
            bytes->data[bytes->size++] = (uint8_t)next;
    }
    return result;
}

gtx_result gtx_read_stream(FILE *stream, const char *name, gtx_file_bytes *bytes,
                           gtx_error *error)
{
    uint8_t head[GTX_FILE_HEAD];
    bytes->data = NULL;
    bytes->size = bytes->capacity = 0;
    const uint64_t left = bytes_left(stream);
    if (!bytes->limit)
        bytes->limit = left > STREAM_LIMIT ? left : STREAM_LIMIT;
    if (left > bytes->limit)
        return gtx_fail_limit(error, GTX_LIMITED_MEMORY, name, left, bytes->limit);
    const size_t head_size = fread(head, 1, sizeof head, stream);
    gtx_result result = GTX_OK;
    if (bytes->look && !ferror(stream))
        result = bytes->look(head, head_size, left, bytes->user, error);
    if (!result)
        result = read_all(stream, left, head, head_size, name, bytes, error);
    if (!result && ferror(stream))
        result = gtx_fail(error, GTX_ERROR_READ, "cannot read %s: %s", name, strerror(errno));
    if (result)
        gtx_free_file(bytes);
    return result;
}

gtx_result gtx_read_file(const char *path, const char *name, gtx_file_bytes *bytes,
                         gtx_error *error)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return gtx_fail(error, GTX_ERROR_READ, "cannot open %s: %s", name, strerror(errno));
    const gtx_result result = gtx_read_stream(file, name, bytes, error);
    fclose(file);
    return result;
}

void gtx_free_file(gtx_file_bytes *bytes)
{
    gtx_free_array(&bytes->allocator, bytes->data, bytes->capacity, 1);
    bytes->data = NULL;
    bytes->size = bytes->capacity = 0;
}
