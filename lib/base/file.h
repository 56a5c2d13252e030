/* Whole files in memory. */
#ifndef GTX_BASE_FILE_H
#define GTX_BASE_FILE_H

#include <geotex/geotex.h>

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { GTX_FILE_HEAD = 4096 };

/* Looks at the first bytes of a file, at most GTX_FILE_HEAD, before memory is taken for it.
 * `file_size` is 0 where only reading can tell it. What it returns but OK is the end. */
typedef gtx_result (*gtx_file_look)(const uint8_t *head, size_t size, uint64_t file_size,
                                    void *user, gtx_error *error);

typedef struct gtx_file_bytes {
    gtx_allocator allocator;      /* given, like all before `data` */
    uint64_t limit;               /* of memory: most bytes to take; 0 = those of the file, or 4 GiB
                                     where its size is not known */
    gtx_file_look look;           /* or NULL */
    void *user;
    uint8_t *data;
    size_t size, capacity;        /* freed as `capacity` bytes */
} gtx_file_bytes;

/* Reads a file; or what is left of a stream, which may be a pipe. Messages call it `name`; that of
 * READ has the system's reason. Errors: READ, LIMIT, MEMORY, what `look` says (nothing is left to
 * free). */
gtx_result gtx_read_file(const char *path, const char *name, gtx_file_bytes *bytes,
                         gtx_error *error);
gtx_result gtx_read_stream(FILE *stream, const char *name, gtx_file_bytes *bytes,
                           gtx_error *error);
void gtx_free_file(gtx_file_bytes *bytes);

#ifdef __cplusplus
}
#endif
#endif
