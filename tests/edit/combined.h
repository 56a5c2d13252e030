/* Combining assets in tests. */
#ifndef GTX_TESTS_COMBINED_H
#define GTX_TESTS_COMBINED_H

#include "edit/edits.h"

#include "common/solids.h"
#include "edit/edit.h"

#include <geotex/solid.h>

typedef struct outcome {
    gtx_asset *asset;
    gtx_combine_result told;
    gtx_solid_facts facts;
} outcome;

static inline outcome combine(const gtx_asset *a, const gtx_asset *b, gtx_combine_op op)
{
    const gtx_combine_desc desc = {.op = op};
    outcome o = {0};
    gtx_solid *solid = NULL;
    gtx_error error = {0};
    if (gtx_combine(a, b, &desc, &o.asset, &o.told, &error) ||
        gtx_solid_create(o.asset, NULL, &solid, &error))
        fail_msg("%s", error.message);
    gtx_solid_measure(solid, &o.facts);
    gtx_solid_destroy(solid);
    return o;
}

static inline void refused(const gtx_asset *a, const gtx_asset *b, const gtx_combine_desc *desc,
                    gtx_result result, const char *text)
{
    gtx_asset *out = NULL;
    gtx_error error = {0};
    assert_int_equal(gtx_combine(a, b, desc, &out, NULL, &error), result);
    assert_null(out);
    if (!strstr(error.message, text))
        fail_msg("'%s' is not in: %s", text, error.message);
}

#endif
