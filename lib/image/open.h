/* Opening a module: a shared library of ours that holds a large one of others. */
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

#ifdef __cplusplus
}
#endif
#endif
