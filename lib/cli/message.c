/* Messages, exit codes and progress of the command. */
#include "cli/cli.h"

#include "base/warnings.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { MAX_LINE = 16384 };

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

void print_message(const char *format, ...)
{
    char line[MAX_LINE];
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    gtx_make_printable(line);
    end_progress();
    fprintf(stderr, "%s\n", line);
}

void report_issue(const char *file, const gtx_issue *issue)
{
    print_message("%s: %s[%u %s]: %s (byte %llu)", file, issue->is_error ? "error" : "warning",
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
    if (error->rule)
        report_issue(file, &(gtx_issue){error->rule, 1, error->offset, error->rule_name,
                                        error->message});
    else if (error->result == GTX_ERROR_LIMIT && error->limit)
        print_message("%s: error[%s]: %s (--max-%s allows more)", file, id, error->message,
                      error->limit);
    else
        print_message("%s: error[%s]: %s", file, id, error->message);
    return exit_code;
}

int report_no_memory(const char *file)
{
    gtx_error error;
    gtx_fail(&error, GTX_ERROR_MEMORY, "out of memory");
    return report_error(file, &error);
}

void report_warning(const char *file, const char *name, const char *sentence)
{
    const gtx_warning kind = gtx_warning_named(name);
    const bool is_note = kind < GTX_WARNING_COUNT && gtx_warning_is_note(kind);
    if (!cli_quiet)
        print_message("%s: %s[%s]: %s", file, is_note ? "note" : "warning", name, sentence);
}

int print_result(const char *text, size_t size)
{
    if (fwrite(text, 1, size, stdout) == size && fflush(stdout) == 0)
        return EXIT_CODE_OK;
    print_message("stdout: error[write]: %s", strerror(errno));
    return EXIT_CODE_FILE;
}

int print_json(const char *file, gtx_json *json)
{
    const int code = json->failed ? report_no_memory(file) : print_result(json->text, json->size);
    gtx_json_free(json);
    return code;
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
    struct sigaction hangup;
    if (sigaction(SIGHUP, NULL, &hangup) == 0 && hangup.sa_handler != SIG_IGN) /* nohup */
        sigaction(SIGHUP, &action, NULL);
}

bool was_interrupted(void)
{
    return interrupted;
}

double seconds_now(void)
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

/* Since the first call. */
static double seconds_elapsed(void)
{
    static double start = -1;
    if (start < 0)
        start = seconds_now();
    return seconds_now() - start;
}

int show_progress(const gtx_progress *progress, void *user)
{
    (void)user;
    const double elapsed = seconds_elapsed();
    if (!cli_quiet)
        (cli_progress == PROGRESS_JSON ? print_json_line : print_bar)(progress, elapsed);
    return interrupted;
}

void show_count(uint64_t done, uint64_t total, uint64_t failed)
{
    const double elapsed = seconds_elapsed();
    double left;
    char eta[32] = "null";
    if (time_left((double)done / (double)total, elapsed, &left))
        snprintf(eta, sizeof eta, "%.0f", left);
    if (!cli_quiet && cli_progress == PROGRESS_JSON) {
        fprintf(stderr, "{\"done\": %" PRIu64 ", \"total\": %" PRIu64 ", \"failed\": %" PRIu64
                        ", \"seconds\": %.2f, \"eta_seconds\": %s}\n",
                done, total, failed, elapsed, eta);
    } else if (!cli_quiet && isatty(STDERR_FILENO)) {
        fprintf(stderr, "\r%" PRIu64 " of %" PRIu64 " models, %" PRIu64 " failed, %s s left ", done,
                total, failed, eta[0] == 'n' ? "?" : eta);
        bar_shown = true;
    }
}

void end_progress(void)
{
    if (bar_shown)
        fprintf(stderr, "\r%79s\r", "");
    bar_shown = false;
}
