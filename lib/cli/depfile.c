/* Dependency files: what an output was made from, as Make and Ninja read it. */
#include "cli/cli.h"

#include <stdlib.h>
#include <string.h>

/* A path as a word: what the two read otherwise is escaped, backslashes only where they would
 * escape what follows. No way to write a line break is known to both. Returns the end, NULL for
 * those. */
static char *put_word(char *out, const char *path)
{
    size_t backslashes = 0;
    for (; *path; ++path) {
        if (*path == '\n' || *path == '\r')
            return NULL;
        if (*path == ' ' || *path == '\t' || *path == '#' || *path == ':') {
            for (size_t i = 0; i < backslashes && (*path == ' ' || *path == '\t'); ++i)
                *out++ = '\\';
            *out++ = '\\';
        }
        if (*path == '$')
            *out++ = '$';
        backslashes = *path == '\\' ? backslashes + 1 : 0;
        *out++ = *path;
    }
    return out;
}

int write_depfile(const char *path, const char *target, char *const *sources, size_t count)
{
    size_t most = 2 * strlen(target) + 3;
    for (size_t i = 0; i < count; ++i)
        most += 2 * strlen(sources[i]) + 4;
    char *text = malloc(most);
    if (!text)
        return EXIT_CODE_INTERNAL;
    char *end = put_word(text, target);
    if (end)
        *end++ = ':';
    for (size_t i = 0; end && i < count; ++i) {
        memcpy(end, " \\\n ", 4);
        end = put_word(end + 4, sources[i]);
    }
    int code = EXIT_CODE_FILE;
    if (end) {
        *end++ = '\n';
        code = write_text_file(path, text, (size_t)(end - text));
    } else {
        fprintf(stderr, "%s: error[write]: a path has a line break in it\n", path);
    }
    free(text);
    return code;
}
