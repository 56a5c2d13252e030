/* Reading whole files and standard input. */
#include "cli/cli.h"

#include "base/alloc.h"
#include "base/file.h"

#include <string.h>

int read_whole(const char *path, void **data, size_t *size)
{
    const bool is_stdin = !strcmp(path, "-");
    gtx_file_bytes bytes = {.allocator = gtx_allocator_or_default(NULL),
                            .limit = cli_limits.memory};
    gtx_error error;
    if (is_stdin ? gtx_read_stream(stdin, "standard input", &bytes, &error)
                 : gtx_read_file(path, path, &bytes, &error))
        return report_error(is_stdin ? "stdin" : path, &error);
    *data = bytes.data;
    *size = bytes.size;
    return EXIT_CODE_OK;
}
