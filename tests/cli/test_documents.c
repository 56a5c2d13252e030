/* What documents tell people to run exists: verbs, their options, targets, samples, links; and
 * versions are today's. */
#include "cli/command.h"

#include <ctype.h>

static const char *const documents[] = {"README.md", "samples/paper.md"};
static char targets[65536];
static unsigned checked; /* commands of one document */

/* Whether `text` has `word` as a whole. */
static bool has_word(const char *text, const char *word)
{
    const size_t size = strlen(word);
    for (const char *at = text; (at = strstr(at, word)); at += size) {
        const char before = at == text ? ' ' : at[-1], after = at[size];
        if (!isalnum(before) && before != '-' && !isalnum(after) && after != '-' && after != '_')
            return true;
    }
    return false;
}

/* The next word at *at, up to a space. */
static bool next_word(const char **at, char *word, size_t size)
{
    while (**at == ' ')
        ++*at;
    size_t used = 0;
    for (; **at && **at != ' '; ++*at)
        if (used + 1 < size)
            word[used++] = **at;
    word[used] = 0;
    return used != 0;
}

static void check_gtx(const char *span)
{
    char verb[64], word[256], help[sizeof output];
    const char *at = span + 4;
    if (!next_word(&at, verb, sizeof verb) || !islower(verb[0]))
        return; /* `gtx VERB` */
    if (gtx("%s --help", verb))
        fail_msg("%s: there is no gtx %s", span, verb);
    strcpy(help, output);
    while (next_word(&at, word, sizeof word))
        if (word[0] == '-' && word[1] && !has_word(help, word))
            fail_msg("%s: gtx %s has no %s", span, verb, word);
    ++checked;
}

static void check_make(const char *span)
{
    char word[256], target[300];
    const char *at = span + 5;
    if (!next_word(&at, word, sizeof word) || strchr(word, '=') || strchr(word, '.'))
        return;
    snprintf(target, sizeof target, "make %s", word);
    if (!has_word(targets, target))
        fail_msg("%s: make help has no %s", span, word);
    ++checked;
}

static void check_sample(const char *span)
{
    static const char *const endings[] = {".c", ".cpp"};
    char name[128], path[256];
    bool there = false;
    sscanf(span + strlen("build/release/samples/"), "%127[a-z_]", name);
    for (int i = 0; i < 2; ++i) {
        struct stat about;
        snprintf(path, sizeof path, "samples/%s%s", name, endings[i]);
        there = there || stat(path, &about) == 0;
    }
    if (!there)
        fail_msg("%s: there is no such sample", span);
    ++checked;
}

static void check_span(const char *span)
{
    static const struct {
        const char *start;
        void (*check)(const char *span);
    } kinds[] = {{"gtx ", check_gtx},
                 {"build/gtx ", NULL},
                 {"make ", check_make},
                 {"build/release/samples/", check_sample}};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; ++i)
        if (strncmp(span, kinds[i].start, strlen(kinds[i].start)) == 0) {
            if (kinds[i].check)
                kinds[i].check(span);
            else
                check_gtx(strstr(span, "gtx "));
        }
}

/* A link is relative to its document; those to the web and within it are not followed. */
static void check_link(const char *document, const char *link)
{
    char path[512];
    struct stat about;
    const char *slash = strrchr(document, '/');
    if (strchr(link, ':') || link[0] == '#')
        return;
    snprintf(path, sizeof path, "%.*s%.*s", slash ? (int)(slash + 1 - document) : 0, document,
             (int)strcspn(link, "#"), link);
    if (stat(path, &about))
        fail_msg("%s: there is no %s", document, path);
}

static void check_line(const char *document, char *line)
{
    for (char *link = line; (link = strstr(link, "]("));) {
        link += 2;
        char target[400];
        snprintf(target, sizeof target, "%.*s", (int)strcspn(link, ")\n"), link);
        check_link(document, target);
    }
    for (char *at = strchr(line, '`'); at;) {
        char *end = strchr(at + 1, '`');
        if (!end)
            return;
        *end = 0;
        check_span(at + 1);
        at = strchr(end + 1, '`');
    }
}

static void what_documents_name_exists(void **state)
{
    (void)state;
    FILE *help = popen("make -s help", "r");
    assert_non_null(help);
    targets[fread(targets, 1, sizeof targets - 1, help)] = 0;
    assert_int_equal(pclose(help), 0);
    for (size_t i = 0; i < sizeof documents / sizeof *documents; ++i) {
        FILE *file = fopen(documents[i], "r");
        assert_non_null(file);
        static char line[8192];
        bool code = false;
        checked = 0;
        while (fgets(line, sizeof line, file)) {
            line[strcspn(line, "\n")] = 0;
            if (strncmp(line, "```", 3) == 0)
                code = !code;
            else if (code)
                check_span(line);
            else
                check_line(documents[i], line);
        }
        fclose(file);
        assert_true(checked > 15); /* else nothing was read */
    }
}

/* The specification and the changelog are of the format that is written. */
static void versions_agree(void **state)
{
    (void)state;
    static const char *const places[][2] = {
        {"format/gtx.md", "# The `.gtx` format, version %.*s\n"},
        {"CHANGELOG.md", "Format %.*s ("}};
    assert_int_equal(gtx("--version"), 0);
    const char *format = strstr(output, "format ");
    assert_non_null(format);
    format += strlen("format ");
    for (size_t i = 0; i < sizeof places / sizeof *places; ++i) {
        static char text[4096];
        char wanted[128];
        FILE *file = fopen(places[i][0], "r");
        assert_non_null(file);
        text[fread(text, 1, sizeof text - 1, file)] = 0;
        fclose(file);
        snprintf(wanted, sizeof wanted, places[i][1], (int)strcspn(format, ","), format);
        if (!strstr(text, wanted))
            fail_msg("%s does not say: %s", places[i][0], wanted);
    }
}

int main(void)
{
    strcpy(folder, "/tmp");
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_documents_name_exists),
        cmocka_unit_test(versions_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
