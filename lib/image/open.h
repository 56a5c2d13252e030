/* Opening modules, shared libraries of ours that hold large ones of others; finding programs. */
#ifndef GTX_IMAGE_OPEN_H
#define GTX_IMAGE_OPEN_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What `symbol` of the module `file` stands for, or NULL and UNSUPPORTED with a sentence that
 * starts with `need`, such as "images need geotex-image.so". The module is looked for from the
 * folder of the library or program that holds this code, and nowhere else: in that folder, in
 * geotex/ below it and in ../lib/geotex/. No variable of the environment has a say in it. It stays
 * open: threads of such libraries do not survive being unloaded. Any thread. */
const void *gtx_open_module(const char *file, const char *symbol, const char *need,
                            gtx_error *error);

/* The path of a program of ours, looked for in the same places; returns 0 where it is not there. */
enum { GTX_MAX_PROGRAM_PATH = 4096 + 64 };
int gtx_find_program(const char *file, char path[GTX_MAX_PROGRAM_PATH]);

#ifdef __cplusplus
}
#endif
#endif
