/* The kinds of warnings: each has a stable name, and a sentence that may change. */
#ifndef GTX_BASE_WARNINGS_H
#define GTX_BASE_WARNINGS_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum gtx_warning {
#define GTX_WARNING(id, name) GTX_WARNING_##id,
#define GTX_NOTE GTX_WARNING
#include "base/warnings.def"
#undef GTX_NOTE
#undef GTX_WARNING
    GTX_WARNING_COUNT
} gtx_warning;

/* Such as "open-edges"; static. */
const char *gtx_warning_name(gtx_warning kind);
/* GTX_WARNING_COUNT where there is none of that name. */
gtx_warning gtx_warning_named(const char *name);
bool gtx_warning_is_note(gtx_warning kind);

#ifdef __cplusplus
}
#endif
#endif
