/* Real and hostile models through the command: a valid asset, or one clear line and exit 2, 3 or 5.
 *
 * Every file under $GEOTEX_MODELS that could be a model is cooked in a process of its own, with at
 * most 60 seconds and 4 GiB; what was cooked is validated. Files of malformed/ are sampled (every
 * eighth) and models of more than 2 MB left out, unless GTX_CORPUS=all. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <fcntl.h>
#include <ftw.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MAX_FILES = 4096, SECONDS = 60 };
static char *files[MAX_FILES];
static unsigned file_count;
static bool everything;

static bool has_suffix(const char *path, const char *suffix)
{
    size_t n = strlen(path), m = strlen(suffix);
    return n >= m && !strcmp(path + n - m, suffix);
}

static int collect(const char *path, const struct stat *info, int kind, struct FTW *ftw)
{
    static const char *const models[] = {".obj", ".ply", ".drc", ".glb", ".gltf", ".off", ".stl",
                                         ".obj.gz", ".ply.gz", ".off.gz", NULL};
    (void)ftw;
    bool model = false;
    for (const char *const *suffix = models; *suffix; ++suffix)
        model = model || has_suffix(path, *suffix);
    if (kind == FTW_F && model && file_count < MAX_FILES &&
        (everything || info->st_size <= 2000000))
        files[file_count++] = strdup(path);
    return 0;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Runs the command with its output in log; returns the wait status. */
static int run(const char *log, char *const argv[])
{
    pid_t child = fork();
    if (child == 0) {
        const char *config = getenv("GTX_CONFIG");
        struct rlimit time = {SECONDS, SECONDS + 5}, memory = {4ull << 30, 4ull << 30};
        setrlimit(RLIMIT_CPU, &time);
        if (!config || strcmp(config, "sanitize")) /* shadow memory needs terabytes of addresses */
            setrlimit(RLIMIT_AS, &memory);
        int out = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
        dup2(out, 1);
        dup2(out, 2);
        execv(argv[0], argv);
        _exit(99);
    }
    int status = -1;
    waitpid(child, &status, 0);
    return status;
}

static void print_log(const char *log)
{
    char line[512];
    FILE *file = fopen(log, "r");
    while (file && fgets(line, sizeof line, file))
        print_message("    %s", line);
    if (file)
        fclose(file);
}

static bool last_line_is_clear(const char *log)
{
    char line[1024], last[1024] = "";
    unsigned errors = 0;
    FILE *file = fopen(log, "r");
    while (file && fgets(line, sizeof line, file)) {
        strcpy(last, line);
        errors += strstr(line, ": error[") != NULL;
    }
    if (file)
        fclose(file);
    return errors == 1 && strstr(last, ": error[");
}

static void the_corpus_cooks_or_is_refused(void **state)
{
    const char *models = getenv("GEOTEX_MODELS"), *mode = getenv("GTX_CORPUS");
    char *gtx = getenv("GTX");
    (void)state;
    if (!models || !gtx)
        skip();
    everything = mode && !strcmp(mode, "all");
    assert_int_equal(nftw(models, collect, 16, FTW_PHYS), 0);
    qsort(files, file_count, sizeof *files, by_name);
    assert_true(file_count > 0);

    char folder[] = "/tmp/gtx-corpus-XXXXXX", asset[64], temporary[80], log[64];
    assert_non_null(mkdtemp(folder));
    snprintf(asset, sizeof asset, "%s/out.gtx", folder);
    snprintf(temporary, sizeof temporary, "%s.tmp", asset);
    snprintf(log, sizeof log, "%s/log", folder);

    unsigned cooked = 0, refused = 0, bad = 0, malformed = 0;
    for (unsigned i = 0; i < file_count; ++i) {
        if (strstr(files[i], "/malformed/") && !everything && malformed++ % 8)
            continue;
        char *cook[] = {gtx, "cook", files[i], "-o", asset, NULL};
        char *validate[] = {gtx, "validate", asset, NULL};
        unlink(asset);
        const char *fault = NULL;
        int status = run(log, cook);
        int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        bool written = access(asset, F_OK) == 0;
        if (code == -1)
            fault = "died by a signal";
        else if (code == 0 && !written)
            fault = "wrote nothing";
        else if (code == 0 && run(log, validate) != 0)
            fault = "wrote an invalid asset";
        else if (code != 0 && code != 2 && code != 3 && code != 5)
            fault = "left with an unexpected exit code";
        else if (code != 0 && written)
            fault = "failed but wrote a file";
        else if (code != 0 && !last_line_is_clear(log))
            fault = "did not say why in one line";
        else if (access(temporary, F_OK) == 0)
            fault = "left its temporary file";
        if (fault) {
            print_message("%s: %s (status %d)\n", files[i], fault, status);
            print_log(log);
            ++bad;
        }
        cooked += code == 0;
        refused += code > 0;
    }
    print_message("corpus: %u cooked, %u refused, %u at fault\n", cooked, refused, bad);
    unlink(asset);
    unlink(temporary);
    unlink(log);
    rmdir(folder);
    for (unsigned i = 0; i < file_count; ++i)
        free(files[i]);
    assert_int_equal(bad, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_corpus_cooks_or_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
