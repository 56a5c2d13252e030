/* Messages, exit codes and progress of the command. */
#include "cli/cli.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const struct {
    gtx_result result;
    int exit_code;
    const char *id;
} outcomes[] = {
    {GTX_CANCELLED, EXIT_CODE_CANCELLED, "cancelled"},
    {GTX_ERROR_ARGUMENT, EXIT_CODE_USAGE, "usage"},
    {GTX_ERROR_NOT_ZEROED, EXIT_CODE_INTERNAL, "internal"},
    {GTX_ERROR_MEMORY, EXIT_CODE_LIMIT, "memory"},
    {GTX_ERROR_LIMIT, EXIT_CODE_LIMIT, "limit"},
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

void report_issue(const char *file, const gtx_issue *issue)
{
    fprintf(stderr, "%s: %s[%u %s]: %s (byte %llu)\n", file, issue->is_error ? "error" : "warning",
            issue->rule, issue->name, issue->message, (unsigned long long)issue->offset);
}

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
        report_issue(file, &(gtx_issue){error->rule, 1, error->offset, error->rule_name,
                                        error->message});
    else if (error->result == GTX_ERROR_LIMIT && error->limit)
        fprintf(stderr, "%s: error[%s]: %s (--max-%s allows more)\n", file, id, error->message,
                error->limit);
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

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Shares of the time are known roughly, so the first moments tell nothing about the rest. */
static bool time_left(double fraction, double elapsed, double *left)
{
    *left = fraction > 0 ? elapsed * (1 - fraction) / fraction : 0;
    return fraction >= 0.05 && elapsed >= 0.5;
}

static void print_bar(const gtx_progress *progress, double elapsed)
{
    static int last_percent = -1, last_second = -1;
    int percent = (int)(progress->fraction * 100), second = (int)elapsed;
    if (!isatty(STDERR_FILENO) || (percent == last_percent && second == last_second))
        return;
    last_percent = percent;
    last_second = second;
    double left;
    fprintf(stderr, "\r%3d%% %-10s", percent, progress->stage);
    if (time_left(progress->fraction, elapsed, &left))
        fprintf(stderr, "%6.0f s left ", left);
    bar_shown = true;
}

/* A line at each step and each hundredth. */
static void print_json_line(const gtx_progress *progress, double elapsed)
{
    static uint32_t last_stage = UINT32_MAX;
    static float last_fraction;
    if (progress->stage_index == last_stage && progress->fraction < last_fraction + 0.01f)
        return;
    last_stage = progress->stage_index;
    last_fraction = progress->fraction;
    double left;
    char eta[32] = "null";
    if (time_left(progress->fraction, elapsed, &left))
        snprintf(eta, sizeof eta, "%.2f", left);
    fprintf(stderr, "{\"stage\": \"%s\", \"fraction\": %.4f, \"seconds\": %.2f, "
                    "\"eta_seconds\": %s}\n",
            progress->stage, (double)progress->fraction, elapsed, eta);
}

int show_progress(const gtx_progress *progress, void *user)
{
    static double start = -1;
    (void)user;
    if (start < 0)
        start = seconds_now();
    if (!cli_quiet)
        (cli_progress == PROGRESS_JSON ? print_json_line : print_bar)(progress,
                                                                      seconds_now() - start);
    return interrupted;
}

void end_progress(void)
{
    if (bar_shown)
        fprintf(stderr, "\r%32s\r", "");
    bar_shown = false;
}
