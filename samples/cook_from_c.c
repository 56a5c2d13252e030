/* Cook from C, with progress, and Ctrl-C that leaves nothing behind.
 *
 *   cook_from_c MODEL ASSET.gtx */
#include <geotex/cook.h>

#include <signal.h>
#include <stdio.h>

static volatile sig_atomic_t interrupted;

static void on_interrupt(int signal_number)
{
    (void)signal_number;
    interrupted = 1;
}

/* Called from this thread, some hundred times; returning non-zero cancels the cook. */
static int on_progress(const gtx_progress *progress, void *user)
{
    int *shown = user, percent = (int)(progress->fraction * 100);
    if (percent / 10 != *shown / 10 || percent == 0)
        printf("%3d %%  %s\n", percent, progress->stage);
    *shown = percent;
    return interrupted;
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: cook_from_c MODEL ASSET.gtx\n");
        return 1;
    }
    signal(SIGINT, on_interrupt);
    int shown = -1;
    gtx_cook_desc desc = {.progress = on_progress, .progress_user = &shown}; /* zeros: defaults */
    gtx_report report;
    gtx_error error;
    gtx_result result = gtx_cook_file(argv[1], argv[2], &desc, &report, &error);
    if (result == GTX_CANCELLED) {
        fprintf(stderr, "cancelled; %s is as it was\n", argv[2]);
        return 130;
    }
    if (result != GTX_OK) {
        fprintf(stderr, "%s: %s\n", argv[1], error.message);
        return 1;
    }
    for (size_t i = 0; i < report.warning_count; ++i)
        printf("warning: %s\n", report.warnings[i]);
    printf("%s\n", report.summary);
    gtx_report_free(&report); /* report.json had the rest */
    return 0;
}
