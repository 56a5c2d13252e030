/* gtx cook of folders, as cmd_cook.c calls it. */
#ifndef GTX_CLI_FOLDER_FOLDER_H
#define GTX_CLI_FOLDER_FOLDER_H

#include "cli/cli.h"

#include <geotex/cook.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct folder_cook {
    const char *const *operands;  /* models and folders of models */
    int count;
    const char *output;           /* folder, made where there is none */
    const gtx_cook_desc *desc;    /* of each; `progress` and `sources_fn` are not taken from it */
    const char *report_path;      /* or NULL */
    uint32_t jobs;                /* models at a time; 0: as many as there are processors */
    uint32_t shard, shards;       /* part of the models to cook, 1 of 1: all */
} folder_cook;

/* Whether operands and output ask for it: a folder among them, or an output that is one, or ends
 * like one. */
bool is_folder_cook(const char *const *operands, int count, const char *output);

/* Cooks every model, whatever becomes of the others. Returns the highest of their exit codes. */
int cook_folders(const folder_cook *job);

#ifdef __cplusplus
}
#endif
#endif
