/* Messages, exit codes and progress of the command. */
#include "cli/cli.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct {
    gtx_result result;
    int exit_code;
    const char *id;
} outcomes[] = {
    {GTX_CANCELLED, EXIT_CODE_CANCELLED, "cancelled"},
    {GTX_ERROR_ARGUMENT, EXIT_CODE_USAGE, "usage"},
    {GTX_ERROR_NOT_ZEROED, EXIT_CODE_INTERNAL, "internal"},
    {GTX_ERROR_MEMORY, EXIT_CODE_INTERNAL, "memory"},
    {GTX_ERROR_LIMIT, EXIT_CODE_UNSUPPORTED, "limit"},
    {GTX_ERROR_READ, EXIT_CODE_FILE, "read"},
    {GTX_ERROR_WRITE, EXIT_CODE_FILE, "write"},
    {GTX_ERROR_NOT_GTX, EXIT_CODE_INVALID, "not-gtx"},
    {GTX_ERROR_VERSION, EXIT_CODE_UNSUPPORTED, "version"},
    {GTX_ERROR_TRUNCATED, EXIT_CODE_INVALID, "truncated"},
    {GTX_ERROR_CORRUPT, EXIT_CODE_INVALID, "corrupt"},
    {GTX_ERROR_UNSUPPORTED, EXIT_CODE_UNSUPPORTED, "unsupported"},
    {GTX_ERROR_INPUT, EXIT_CODE_INVALID, "input"},
    {GTX_ERROR_EMPTY, EXIT_CODE_INVALID, "empty"},
    {GTX_ERROR_GL, EXIT_CODE_UNSUPPORTED, "gl"},
    {GTX_ERROR_SHADER, EXIT_CODE_INTERNAL, "shader"},
};

int report_error(const char *file, const gtx_error *error)
{
    int exit_code = EXIT_CODE_INTERNAL;
    const char *id = "internal";
    for (size_t i = 0; i < sizeof outcomes / sizeof *outcomes; ++i)
        if (outcomes[i].result == error->result) {
            exit_code = outcomes[i].exit_code;
            id = outcomes[i].id;
        }
    end_progress();
    if (error->rule)
        fprintf(stderr, "%s: error[%u]: %s (byte %llu)\n", file, error->rule, error->message,
                (unsigned long long)error->offset);
    else
        fprintf(stderr, "%s: error[%s]: %s\n", file, id, error->message);
    return exit_code;
}

void report_warning(const char *file, const char *sentence)
{
    if (!cli_quiet)
        fprintf(stderr, "%s: warning: %s\n", file, sentence);
}

int print_result(const char *text, size_t size)
{
    if (fwrite(text, 1, size, stdout) == size && fflush(stdout) == 0)
        return EXIT_CODE_OK;
    fprintf(stderr, "stdout: error[write]: %s\n", strerror(errno));
    return EXIT_CODE_FILE;
}

int write_text_file(const char *path, const char *text, size_t size)
{
    size_t length = strlen(path);
    char *temporary = malloc(length + 5);
    if (!temporary)
        return EXIT_CODE_INTERNAL;
    memcpy(temporary, path, length);
    memcpy(temporary + length, ".tmp", 5);
    FILE *file = fopen(temporary, "wb");
    bool ok = file && fwrite(text, 1, size, file) == size;
    if (file)
        ok = (fclose(file) == 0) && ok;
    ok = ok && rename(temporary, path) == 0;
    if (!ok) {
        fprintf(stderr, "%s: error[write]: %s\n", path, strerror(errno));
        remove(temporary);
    }
    free(temporary);
    return ok ? EXIT_CODE_OK : EXIT_CODE_FILE;
}

static volatile sig_atomic_t interrupted;
static bool bar_shown;

static void on_interrupt(int signal_number)
{
    (void)signal_number;
    interrupted = 1;
}

void catch_interrupt(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_interrupt;
    action.sa_flags = (int)SA_RESETHAND; /* a second Ctrl-C kills */
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

int show_progress(const gtx_progress *progress, void *user)
{
    static int last = -1;
    (void)user;
    if (!cli_quiet && isatty(STDERR_FILENO)) {
        int percent = (int)(progress->fraction * 100);
        if (percent != last) {
            last = percent;
            fprintf(stderr, "\r%3d%% %-10s", percent, progress->stage);
            bar_shown = true;
        }
    }
    return interrupted;
}

void end_progress(void)
{
    if (bar_shown)
        fputs("\r                \r", stderr);
    bar_shown = false;
}
