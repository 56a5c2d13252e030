/* The names of warnings, and which are notes. */
#include "base/warnings.h"

#include <string.h>

static const struct {
    const char *name;
    bool is_note;
} kinds[] = {
#define GTX_WARNING(id, name) {name, false},
#define GTX_NOTE(id, name) {name, true},
#include "base/warnings.def"
#undef GTX_NOTE
#undef GTX_WARNING
};

const char *gtx_warning_name(gtx_warning kind)
{
    return kinds[kind].name;
}

gtx_warning gtx_warning_named(const char *name)
{
    int kind = 0;
    while (kind < GTX_WARNING_COUNT && strcmp(kinds[kind].name, name))
        ++kind;
    return (gtx_warning)kind;
}

bool gtx_warning_is_note(gtx_warning kind)
{
    return kinds[kind].is_note;
}
