/* Whole files in memory. */
#ifndef GTX_BASE_FILE_H
#define GTX_BASE_FILE_H

#include <geotex/geotex.h>

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gtx_file_bytes {
    gtx_allocator allocator;      /* given, like the limit */
    uint64_t limit;               /* most bytes to take from it */
    uint8_t *data;
    size_t size, capacity;        /* freed as `capacity` bytes */
} gtx_file_bytes;

/* Reads a file; or what is left of a stream, which may be a pipe. Messages call it `name`; that of
 * READ has the system's reason. Errors: READ, LIMIT, MEMORY (nothing is left to free). */
gtx_result gtx_read_file(const char *path, const char *name, gtx_file_bytes *bytes,
                         gtx_error *error);
gtx_result gtx_read_stream(FILE *stream, const char *name, gtx_file_bytes *bytes,
                           gtx_error *error);
void gtx_free_file(gtx_file_bytes *bytes);

#ifdef __cplusplus
}
#endif
#endif
