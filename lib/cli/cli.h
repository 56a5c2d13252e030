/* What the verbs of the command share: option tables, messages, exit codes. */
#ifndef GTX_CLI_CLI_H
#define GTX_CLI_CLI_H

#include "base/error.h"
#include "base/json.h"
#include "base/limits.h"

#include <geotex/geotex.h>

#include <stdbool.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { /* exit codes of the command */
    EXIT_CODE_OK = 0,
    EXIT_CODE_USAGE = 1,
    EXIT_CODE_FILE = 2,        /* a named file cannot be read or written */
    EXIT_CODE_INVALID = 3,     /* invalid input */
    EXIT_CODE_INTERNAL = 4,
    EXIT_CODE_UNSUPPORTED = 5, /* legal, but not supported */
    EXIT_CODE_LIMIT = 6,       /* a limit of --max-... is exceeded, or memory is out */
    EXIT_CODE_DIFFERS = 7,     /* a limit of gtx compare is exceeded */
    EXIT_CODE_CANCELLED = 130
};

/* ---- options ---- */

typedef enum option_kind {
    OPTION_FLAG,   /* bool *, no value */
    OPTION_STRING, /* const char ** */
    OPTION_UINT,   /* uint32_t *, within [min, max] */
    OPTION_INT,    /* int32_t *, within [min, max] */
    OPTION_NUMBER, /* double *, within [min, max] */
    OPTION_AMOUNT, /* uint64_t *, within [min, max], with k, M, G or T for powers of 1000 */
    OPTION_SIZE,   /* uint32_t[2], "WxH", each within [min, max] */
    OPTION_TRIPLE, /* double[3], "a,b,c" */
    OPTION_CHOICE, /* uint32_t *, index into the names of `argument`, written "a|b|c" */
    OPTION_ONE_OF, /* uint32_t *, one of the whole numbers of `argument`, written "8|16" */
    OPTION_STEP    /* steps *, appended to: a number within [min, max], or a text when both are 0 */
} option_kind;

/* What is done in the order in which it was asked for. */
typedef struct step {
    const char *name, *text;  /* of the option, and its value */
    double number;
} step;
enum { MAX_STEPS = 64 };
typedef struct steps {
    step list[MAX_STEPS];
    uint32_t count;
} steps;

typedef struct option {
    const char *name;     /* without the leading dashes */
    char letter;          /* short form, or 0 */
    option_kind kind;
    void *value;
    const char *argument; /* how the value is shown in help, NULL for flags */
    const char *help;
    double min, max;
} option;

typedef struct verb {
    const char *name;
    const char *operands; /* as shown in help: "ASSET [MODEL]" */
    const char *summary;
    int min_operands, max_operands;
    const option *options; /* ends with a NULL name */
    uint32_t limits;       /* a bit for each gtx_limited that bounds what it does */
} verb;

/* Of verbs that open assets; that make some; that make them of models; and that draw those. */
enum {
    ASSET_LIMITS = 1 << GTX_LIMITED_MEMORY | 1 << GTX_LIMITED_TEXELS | 1 << GTX_LIMITED_PATCHES,
    MAKING_LIMITS = ASSET_LIMITS | 1 << GTX_LIMITED_WORK,
    MODEL_LIMITS = MAKING_LIMITS | 1 << GTX_LIMITED_TRIANGLES | 1 << GTX_LIMITED_PIXELS,
    DRAWING_LIMITS = MODEL_LIMITS | 1 << GTX_LIMITED_CELLS
};

/* Parses argv[1..] (argv[0] is the verb) into the options' values; operands are moved, in order, to
 * operands[0..*count). Returns -1 to go on, or an exit code: 0 after --help, 1 after a message. */
int parse_options(const verb *v, int argc, char **argv, const char **operands, int *count);

/* What descriptors call a level of --zstd, where 0 is stored. */
static inline int32_t encode_level(int32_t zstd)
{
    return zstd ? zstd : -1;
}

/* Only errors are printed. */
extern bool cli_quiet;
/* What --max-memory and its like allow, for every descriptor that has limits. */
extern gtx_limits cli_limits;
/* The choice of --progress. */
extern uint32_t cli_progress;
enum { PROGRESS_BAR, PROGRESS_JSON };
#define PROGRESS_OPTION                                                                            \
    {"progress", 0, OPTION_CHOICE, &cli_progress, "bar|json",                                      \
     "bar: on a terminal; json: an object per line, on stderr [bar]", 0, 0}

#define THREADS_OPTION(value)                                                                      \
    {"threads", 0, OPTION_UINT, value, "N", "number of threads; 0 = one per processor [0]", 0, 1024}

/* ---- messages ---- */

/* One line on stderr, whatever paths hold: see gtx_make_printable. The format has no newline. */
void print_message(const char *format, ...) GTX_PRINTF(1, 2);
/* A broken rule of the format, on stderr: "file: error[305 patch-page]: sentence (byte 512)". */
void report_issue(const char *file, const gtx_issue *issue);
/* "file: error[id]: sentence" on stderr, from a failed call; returns the exit code. */
int report_error(const char *file, const gtx_error *error);
int report_no_memory(const char *file);
/* "file: warning[name]: sentence", unless quiet. */
void report_warning(const char *file, const char *name, const char *sentence);
/* Writes text to stdout or says why it could not; returns an exit code. */
int print_result(const char *text, size_t size);
/* The same of a JSON text, which is freed; `file` is what it is about. */
int print_json(const char *file, gtx_json *json);

/* ---- outputs ---- */

/* A file that a call writes: the option that names it, and its path, or NULL if it is not asked
 * for. A list ends with a NULL option. */
typedef struct output_file {
    const char *option, *path;
} output_file;

/* Before the work: no output may be an input, or another output, under whatever name. "-" is the
 * standard stream. Returns an exit code. */
int check_outputs(const char *caller, const output_file *outputs, const char *const *inputs,
                  size_t count);
/* The first half of it, for files that turn out to be inputs. Errors: ARGUMENT. */
gtx_result refuse_inputs(const output_file *outputs, const char *const *inputs, size_t count,
                         gtx_error *error);
/* Writes a text file whole. Returns an exit code. */
int write_text_file(const char *path, const char *text, size_t size);

/* Reads a file whole, or standard input for "-", and says why when it cannot. *data is of malloc
 * and the caller's. Returns an exit code. */
int read_whole(const char *path, void **data, size_t *size);
/* Whether a dependency file can name a path: no way to write a line break is known to both. */
bool fits_depfile(const char *path);
/* Writes a dependency file as Make and Ninja read it: `target` was made from `sources`, which all
 * fit, and each of which is a target too, so that a deleted one stops no build. Returns an exit
 * code. */
int write_depfile(const char *path, const char *target, char *const *sources, size_t count);

/* Progress on stderr as cli_progress says; cancels on Ctrl-C. A gtx_progress_fn. */
int show_progress(const gtx_progress *progress, void *user);
/* Likewise of jobs: so many of so many are done, some of which failed. One thread at a time. */
void show_count(uint64_t done, uint64_t total, uint64_t failed);
void end_progress(void);
/* Makes Ctrl-C cancel the running call instead of killing the process. Called before anything is
 * written, so that nothing is left half done. */
void catch_interrupt(void);
bool was_interrupted(void);
/* Of a clock that only goes forward. */
double seconds_now(void);

/* ---- what verbs share ---- */

/* Puts an asset with LOD meshes of its maps in the place of *asset, with progress. Errors: as
 * gtx_cook_lod_meshes; *asset is then as it was. */
gtx_result add_lod_meshes(gtx_asset **asset, uint32_t levels, uint32_t threads, gtx_error *error);

/* A verb that makes an asset of files which it reads: zero-filled but for `verb`, and freed by
 * made_free. Each call below returns an exit code, and has told why it is not 0. */
typedef struct made_file {
    const char *verb, *output, *report, *depfile, *allow;
    bool strict, if_changed;
    /* The rest is made.c's. */
    char **sources, **sentences;
    size_t source_count, warning_count;
    uint32_t *kinds;               /* of the sentences: a gtx_warning each */
    bool allowed[64], unchanged;
    uint64_t bytes;
    double start;
} made_file;
#define MADE_OPTIONS(m)                                                                            \
    {"if-changed", 0, OPTION_FLAG, &(m).if_changed, NULL,                                          \
     "do not touch OUT.gtx if it has these bytes already", 0, 0},                                  \
    {"strict", 0, OPTION_FLAG, &(m).strict, NULL,                                                  \
     "warnings are errors (exit 3), notes are not", 0, 0},                                         \
    {"allow", 0, OPTION_STRING, &(m).allow, "NAME,...",                                            \
     "with --strict: warnings that are not errors", 0, 0},                                         \
    {"report", 0, OPTION_STRING, &(m).report, "R.json", "write what was made, as JSON", 0, 0},     \
    {"depfile", 0, OPTION_STRING, &(m).depfile, "D",                                               \
     "write a dependency file for Make or Ninja", 0, 0}

/* A file that is read, before any work. */
int made_from(made_file *m, const char *source);
/* Once all are named: what is written is no source, and --allow has names of warnings. */
int made_check(made_file *m);
/* Of a gtx_warning: tells it, and keeps it for the report; with --strict it may end the verb. */
int made_warn(made_file *m, const char *file, uint32_t kind, const char *sentence);
/* Writes the asset, and what of a report and a dependency file was asked for. */
int made_save(made_file *m, const gtx_asset *asset, const gtx_encode_desc *encode);
void made_free(made_file *m);

/* Of the command, on stdout: its commit, the format, the cooker and the libraries. */
void print_version(void);

/* ---- verbs: each gets argv[0] = its name ---- */

int cmd_cook(int argc, char **argv);
int cmd_horizons(int argc, char **argv);
int cmd_world(int argc, char **argv);
int cmd_info(int argc, char **argv);
int cmd_validate(int argc, char **argv);
int cmd_unpack(int argc, char **argv);
int cmd_pack(int argc, char **argv);
int cmd_export(int argc, char **argv);
int cmd_filter(int argc, char **argv);
int cmd_combine(int argc, char **argv);
int cmd_render(int argc, char **argv);
int cmd_view(int argc, char **argv);
int cmd_compare(int argc, char **argv);
int cmd_bench(int argc, char **argv);

#ifdef __cplusplus
}
#endif
#endif
