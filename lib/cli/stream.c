/* Reading whole files and standard input. */
#include "cli/cli.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static bool read_stream(FILE *file, char **data, size_t *size)
{
    size_t capacity = 1 << 16, used = 0;
    char *bytes = NULL;
    for (;;) {
        char *grown = realloc(bytes, capacity);
        if (!grown)
            break;
        bytes = grown;
        used += fread(bytes + used, 1, capacity - used, file);
        if (used < capacity) {
            *data = bytes;
            *size = used;
            return !ferror(file);
        }
        capacity *= 2;
    }
    free(bytes);
    errno = ENOMEM;
    return false;
}

int read_whole(const char *path, void **data, size_t *size)
{
    bool is_stdin = !strcmp(path, "-");
    char *bytes = NULL;
    FILE *file = is_stdin ? stdin : fopen(path, "rb");
    bool good = file && read_stream(file, &bytes, size);
    if (!good)
        fprintf(stderr, "%s: error[read]: %s\n", is_stdin ? "stdin" : path, strerror(errno));
    if (file && !is_stdin)
        fclose(file);
    if (!good) {
        free(bytes);
        return EXIT_CODE_FILE;
    }
    *data = bytes;
    return EXIT_CODE_OK;
}
