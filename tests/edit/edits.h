/* Assets and edits that the tests share. */
#ifndef GTX_TESTS_EDITS_H
#define GTX_TESTS_EDITS_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/counter.h"
#include "common/fixture.h"

#include <geotex/edit.h>

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static inline gtx_edit *begin(const gtx_asset *asset)
{
    gtx_edit *edit = NULL;
    gtx_error error = {0};
    if (gtx_edit_begin(asset, NULL, &edit, &error))
        fail_msg("%s", error.message);
    return edit;
}

/* Ends the edit. */
static inline gtx_asset *finish(gtx_edit *edit)
{
    gtx_asset *out = NULL;
    gtx_error error = {0};
    if (gtx_edit_finish(edit, &out, &error))
        fail_msg("%s", error.message);
    gtx_edit_end(edit);
    return out;
}

static inline void must(gtx_result result)
{
    if (result)
        fail_msg("%s", gtx_result_string(result));
}

#endif
