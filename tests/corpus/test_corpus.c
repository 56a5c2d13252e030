/* Real and hostile models through the command: a sound asset, or a clear line and exit 2, 3, 5, 6.
 *
 * Every file under $GEOTEX_MODELS is cooked; what was cooked is validated, compared and rendered.
 * Each run is a process of its own with at most 60 seconds of a processor and 4 GiB. Files of
 * malformed/ are sampled (every eighth), and files of more than 1 MB and small assets' pictures
 * left out, unless GTX_CORPUS=all. $GTX_OUT/corpus.txt says what became of each file. */
#define _DEFAULT_SOURCE /* wait4 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <dirent.h>
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

enum { MAX_FILES = 4096, SECONDS = 60, SAMPLE = 8, PICTURE_SAMPLE = 6 };
static const uint64_t memory_limit = 4ull << 30;
static const off_t small_file = 1000000;

static char *files[MAX_FILES];
static unsigned file_count;
static bool everything, sanitized;
static char folder[] = "/tmp/gtx-corpus-XXXXXX";
static char asset[64], picture[64], log_file[64];
static uint64_t peak; /* memory that the last command had resident, bytes */

static int collect(const char *path, const struct stat *info, int kind, struct FTW *ftw)
{
    (void)ftw;
    if (kind == FTW_F && file_count < MAX_FILES && (everything || info->st_size <= small_file))
        files[file_count++] = strdup(path);
    return 0;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Runs the command within the limits, its output in the log; returns the exit code, -1 when it died
 * of a signal: a fault, or one of the limits. */
static int run(char *const argv[])
{
    pid_t child = fork();
    if (child == 0) {
        struct rlimit memory = {memory_limit, memory_limit};
        if (!sanitized) /* shadow memory needs terabytes of addresses */
            setrlimit(RLIMIT_AS, &memory);
        rlim_t seconds = sanitized ? 10 * SECONDS : SECONDS;
        setrlimit(RLIMIT_CPU, &(struct rlimit){seconds, seconds});
        alarm(10 * (unsigned)seconds); /* one that waits; stays armed over execv */
        int out = open(log_file, O_WRONLY | O_CREAT | O_TRUNC, 0600);
        dup2(out, 1);
        dup2(out, 2);
        execv(argv[0], argv);
        _exit(99);
    }
    int status = -1;
    struct rusage usage = {0};
    wait4(child, &status, 0, &usage);
    peak = 1024 * (uint64_t)usage.ru_maxrss;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* The last line of the log, and how many errors it tells of. */
static unsigned read_log(char last[512])
{
    char line[512];
    unsigned errors = 0;
    FILE *file = fopen(log_file, "r");
    for (last[0] = 0; file && fgets(line, sizeof line, file); strcpy(last, line))
        errors += strstr(line, ": error[") != NULL;
    if (file)
        fclose(file);
    last[strcspn(last, "\n")] = 0;
    return errors;
}

static bool exists(const char *path)
{
    return access(path, F_OK) == 0;
}

/* Where outputs are before they are whole. */
static bool has_temporary(void)
{
    bool found = false;
    DIR *list = opendir(folder);
    for (struct dirent *entry; list && (entry = readdir(list)) != NULL;)
        found = found || !strncmp(entry->d_name, ".gtx-", 5);
    if (list)
        closedir(list);
    return found;
}

/* What is wrong with how cooking ended, or NULL. `size` is that of the model; its buffers and
 * images, and what the program itself takes, have 256 MB here. */
static const char *fault_of_cook(int code, off_t size, unsigned errors, const char *last)
{
    if (code == -1)
        return "cook died of a signal or a limit";
    if (has_temporary())
        return "cook left its temporary file";
    if (!sanitized && peak > ((uint64_t)512 << 20) + 2000 * (uint64_t)size)
        return "cook took more memory than it may for files of that size";
    if (code == 0)
        return exists(asset) ? NULL : "cook wrote nothing";
    if (exists(asset))
        return "cook failed but wrote a file";
    if (code != 2 && code != 3 && code != 5 && code != 6)
        return "cook left with an unexpected exit code";
    return errors == 1 && strstr(last, ": error[") ? NULL : "cook did not say why in one line";
}

/* What is wrong with a cooked asset, or NULL. */
static const char *fault_of_asset(char *gtx, char *model, bool pictured)
{
    char *validate[] = {gtx, "validate", asset, NULL};
    char *compare[] = {gtx, "compare", asset, model, "--size", "128", NULL};
    char *render[] = {gtx, "render", asset, "-o", picture, "--size", "128x128", NULL};
    if (run(validate))
        return "the asset is invalid";
    if (pictured && run(compare))
        return "the asset cannot be compared";
    if (pictured && (run(render) || !exists(picture)))
        return "the asset cannot be drawn";
    return NULL;
}

static void remove_outputs(void)
{
    unlink(asset);
    unlink(picture);
    unlink(log_file);
}

static int set_up(void **state)
{
    (void)state;
    const char *config = getenv("GTX_CONFIG"), *mode = getenv("GTX_CORPUS");
    sanitized = config && !strcmp(config, "sanitize");
    everything = mode && !strcmp(mode, "all");
    if (!mkdtemp(folder))
        return -1;
    snprintf(asset, sizeof asset, "%s/out.gtx", folder);
    snprintf(picture, sizeof picture, "%s/out.png", folder);
    snprintf(log_file, sizeof log_file, "%s/log", folder);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    remove_outputs();
    return rmdir(folder);
}

static void every_file_cooks_or_is_refused(void **state)
{
    char *given = getenv("GEOTEX_MODELS"), *gtx = getenv("GTX");
    char models[4096], path[4096];
    (void)state;
    if (!given || !gtx)
        skip();
    assert_non_null(realpath(given, models));
    assert_int_equal(nftw(models, collect, 16, FTW_PHYS), 0);
    qsort(files, file_count, sizeof *files, by_name);
    assert_true(file_count > 0);
    snprintf(path, sizeof path, "%s/corpus.txt", getenv("GTX_OUT") ? getenv("GTX_OUT") : folder);
    FILE *table = fopen(path, "w");
    assert_non_null(table);

    unsigned cooked = 0, refused = 0, faults = 0, malformed = 0;
    for (unsigned i = 0; i < file_count; ++i) {
        if (strstr(files[i], "/malformed/") && !everything && malformed++ % SAMPLE)
            continue;
        char last[512];
        char *cook[] = {gtx, "cook", files[i], "-o", asset, NULL};
        remove_outputs();
        int code = run(cook);
        unsigned errors = read_log(last);
        struct stat model = {0};
        stat(files[i], &model);
        const char *fault = fault_of_cook(code, model.st_size, errors, last);
        if (!fault && code == 0)
            fault = fault_of_asset(gtx, files[i], everything || cooked % PICTURE_SAMPLE == 0);
        if (fault) {
            print_message("%s: %s\n", files[i], fault);
            read_log(last);
            print_message("    %s\n", last);
        }
        const char *name = files[i] + strlen(models), *reason = strstr(last, ": error[");
        fprintf(table, "%-8s%d %s%s\n", fault ? "fault" : code ? "refused" : "cooked", code,
                name + strspn(name, "/"), reason ? reason : "");
        cooked += code == 0;
        refused += code > 0;
        faults += fault != NULL;
        free(files[i]);
    }
    fprintf(table, "%u cooked, %u refused, %u at fault\n", cooked, refused, faults);
    fclose(table);
    assert_int_equal(faults, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_file_cooks_or_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
