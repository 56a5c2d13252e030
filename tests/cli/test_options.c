/* Every option of every verb is used by some test, by its long name. */
#include "cli/command.h"

#include <ctype.h>
#include <glob.h>

static char *sources; /* of all tests */

static void append_file(const char *path)
{
    static size_t size;
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    const size_t more = (size_t)ftell(file);
    rewind(file);
    sources = realloc(sources, size + more + 1);
    assert_non_null(sources);
    assert_int_equal(fread(sources + size, 1, more, file), more);
    sources[size += more] = 0;
    fclose(file);
}

static int read_sources(void **state)
{
    glob_t found;
    (void)state;
    if (!getenv("GTX") || glob("tests/*/*.[ch]*", 0, NULL, &found))
        return 1;
    for (size_t i = 0; i < found.gl_pathc; ++i)
        append_file(found.gl_pathv[i]);
    globfree(&found);
    strcpy(folder, ".");
    return 0;
}

static int free_sources(void **state)
{
    (void)state;
    free(sources);
    return remove("stderr.txt");
}

static size_t name_length(const char *option)
{
    size_t length = 2;
    while (isalnum((unsigned char)option[length]) || option[length] == '-')
        ++length;
    return length;
}

/* `option` begins with its two dashes and ends where its name does. */
static bool is_used(const char *option, size_t length)
{
    char name[64];
    assert_true(length > 2 && length < sizeof name);
    memcpy(name, option, length);
    name[length] = 0;
    for (const char *at = sources; (at = strstr(at, name)) != NULL; at += length)
        if (name_length(at) == length)
            return true;
    return false;
}

/* Lines of help are "  VERB ..." and "  -o, --NAME ..." or "      --NAME ...". */
static void every_option_is_used(void **state)
{
    (void)state;
    char verbs[sizeof output], missing[4096] = "";
    size_t options = 0;
    expect(gtx("--help"), 0);
    strcpy(verbs, output);
    char *rest, *line = strtok_r(verbs, "\n", &rest);
    for (; line; line = strtok_r(NULL, "\n", &rest)) {
        char verb[32];
        if (strncmp(line, "  ", 2) || sscanf(line, "%31s", verb) != 1)
            continue;
        expect(gtx("%s --help", verb), 0);
        for (const char *at = output; (at = strstr(at, "\n  ")) != NULL; ++at) {
            const char *option = at + 3 + strspn(at + 3, " ");
            if (option[0] == '-' && option[1] != '-')
                option += 4; /* "-o, " */
            if (strncmp(option, "--", 2))
                continue;
            const size_t length = name_length(option), used = strlen(missing);
            ++options;
            if (!is_used(option, length))
                snprintf(missing + used, sizeof missing - used, " %s %.*s,", verb, (int)length,
                         option);
        }
    }
    assert_true(options > 80);
    if (*missing)
        fail_msg("no test uses:%s", missing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_option_is_used)};
    return cmocka_run_group_tests(tests, read_sources, free_sources);
}
