/* The names of warnings. */
#include "base/warnings.h"

const char *gtx_warning_name(gtx_warning kind)
{
    static const char *const names[] = {
#define GTX_WARNING(id, name) name,
#include "base/warnings.def"
#undef GTX_WARNING
    };
    return names[kind];
}
