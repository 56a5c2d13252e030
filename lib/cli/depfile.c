/* Dependency files: what an output was made from, as Make and Ninja read it. */
#include "cli/cli.h"

#include <stdlib.h>
#include <string.h>

bool fits_depfile(const char *path)
{
    return !strpbrk(path, "\n\r");
}

/* A path as a word: what the two read otherwise is escaped, backslashes only where they would
 * escape what follows. Returns the end. */
static char *put_word(char *out, const char *path)
{
    size_t backslashes = 0;
    for (; *path; ++path) {
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
        most += 4 * strlen(sources[i]) + 7;
    char *text = malloc(most);
    if (!text)
        return report_no_memory(path);
    char *end = put_word(text, target);
    *end++ = ':';
    for (size_t i = 0; i < count; ++i) {
        memcpy(end, " \\\n ", 4);
        end = put_word(end + 4, sources[i]);
    }
    *end++ = '\n';
    /* Targets without a rule, so that Make goes on when they are gone. In one % is a pattern, whose
     * escape Ninja would take for another file. */
    for (size_t i = 0; i < count; ++i) {
        if (strchr(sources[i], '%'))
            continue;
        end = put_word(end, sources[i]);
        memcpy(end, ":\n", 2);
        end += 2;
    }
    const int code = write_text_file(path, text, (size_t)(end - text));
    free(text);
    return code;
}
