/* Looks for a module beside the code that asks for it. */
#define _GNU_SOURCE /* dladdr */
#include "image/open.h"

#include "base/error.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/auxv.h>
#include <unistd.h>

enum { MAX_PATH = 4096, MAX_REASON = 200 };

/* Where the module may be, from the folder of the library or program that holds this code. */
static const char *const places[] = {"", "geotex/", "../lib/geotex/"};

/* The path of that library or program, with links followed. A program's own name is what its caller
 * made it, so the kernel is asked for that. */
static int path_of_code(char path[MAX_PATH])
{
    Dl_info here, program;
    if (!dladdr((const void *)places, &here))
        return 0;
    const int in_program = dladdr((const void *)getauxval(AT_ENTRY), &program) &&
                           program.dli_fbase == here.dli_fbase;
    char *resolved = realpath(in_program ? "/proc/self/exe" : here.dli_fname, NULL);
    const int length = resolved ? snprintf(path, MAX_PATH, "%s", resolved) : -1;
    free(resolved);
    return length > 0 && length < MAX_PATH;
}

static void *open_module(const char *file, const char *need, gtx_error *error)
{
    char path[MAX_PATH + 64], reason[MAX_REASON] = "not found";
    if (!path_of_code(path)) {
        gtx_fail(error, GTX_ERROR_UNSUPPORTED, "%s", need);
        return NULL;
    }
    char *name = strrchr(path, '/') + 1;
    const size_t left = sizeof path - (size_t)(name - path);
    for (size_t i = 0; i < sizeof places / sizeof *places; ++i) {
        snprintf(name, left, "%s%s", places[i], file);
        void *module = dlopen(path, RTLD_NOW | RTLD_LOCAL);
        if (module)
            return module;
        if (access(path, F_OK) == 0) /* there, but not to be opened: that is the reason to tell */
            snprintf(reason, sizeof reason, "%s", dlerror());
    }
    gtx_fail(error, GTX_ERROR_UNSUPPORTED, "%s: %.120s", need, reason);
    return NULL;
}

int gtx_find_program(const char *file, char path[GTX_MAX_PROGRAM_PATH])
{
    if (!path_of_code(path))
        return 0;
    char *name = strrchr(path, '/') + 1;
    for (size_t i = 0; i < sizeof places / sizeof *places; ++i) {
        snprintf(name, (size_t)(path + GTX_MAX_PROGRAM_PATH - name), "%s%s", places[i], file);
        if (access(path, X_OK) == 0)
            return 1;
    }
    return 0;
}

/* dlopen counts references and gives the same module again, so nothing needs to be kept here. */
const void *gtx_open_module(const char *file, const char *symbol, const char *need,
                            gtx_error *error)
{
    void *module = open_module(file, need, error);
    const void *found = module ? dlsym(module, symbol) : NULL;
    if (module && !found)
        gtx_fail(error, GTX_ERROR_UNSUPPORTED, "%s is of another version", file);
    return found;
}
