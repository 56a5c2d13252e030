/* Writing files atomically: the only way in which geotex writes a file. */
#ifndef GTX_BASE_OUTPUT_H
#define GTX_BASE_OUTPUT_H

#include <geotex/geotex.h>

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Makes `size` bytes the content of a file, or leaves what was there.
 *   - They are written under a name of their own in the same folder, which is gone afterwards, and
 *     are on the disk before they take the place of what was there, whose permissions they get.
 *   - A symbolic link stays one: the file that it leads to is replaced, or made.
 *   - What exists and is no regular file, such as a device or a pipe, is written to, and so is the
 *     file that standard output or standard error goes to.
 * Without POSIX a link is replaced, and permissions are those of a new file.
 * Errors: WRITE, with the path and the system's reason. */
gtx_result gtx_write_file(const char *path, const void *data, size_t size, gtx_error *error);

/* Whether writing one would change the other: links to one file, hard or symbolic, and two
 * spellings of one path, whose file need not exist. Terminals and the like keep nothing, and are
 * never the same. */
bool gtx_same_file(const char *a, const char *b);

#ifdef __cplusplus
}
#endif
#endif
