/* gtx validate: an asset against every rule of format/gtx.md. */
#include "cli/cli.h"

#include <geotex/export.h>

#include <stdlib.h>

static bool as_json;

static const option options[] = {
    {"json", 0, OPTION_FLAG, &as_json, NULL, "one JSON object instead of text", 0, 0}, {0}};

static const verb validate_verb = {"validate", "ASSET",
                                   "Checks a file against every rule of the .gtx format.", 1, 1,
                                   options, ASSET_LIMITS};

typedef struct listener {
    const char *path;
    gtx_json json;
    uint32_t errors;
} listener;

static void on_issue(const gtx_issue *issue, void *user)
{
    listener *l = user;
    l->errors += issue->is_error;
    if (!as_json) {
        report_issue(l->path, issue);
        return;
    }
    gtx_json_begin_object(&l->json, NULL);
    gtx_json_string(&l->json, "severity", issue->is_error ? "error" : "warning");
    gtx_json_integer(&l->json, "rule", issue->rule);
    gtx_json_string(&l->json, "name", issue->name);
    gtx_json_integer(&l->json, "offset", issue->offset);
    gtx_json_string(&l->json, "message", issue->message);
    gtx_json_end_object(&l->json);
}

int cmd_validate(int argc, char **argv)
{
    listener l = {0};
    int count;
    int code = parse_options(&validate_verb, argc, argv, &l.path, &count);
    if (code >= 0)
        return code;
    void *data;
    size_t size;
    code = read_whole(l.path, &data, &size);
    if (code)
        return code;
    const void *asset = data;
    gtx_error error;
    if (gtx_find_asset(data, size, &asset, &size, &error) && error.result != GTX_ERROR_NOT_GTX) {
        free(data);
        return report_error(l.path, &error);
    }
    gtx_json_begin_object(&l.json, NULL);
    gtx_json_begin_array(&l.json, "issues");
    gtx_result result = gtx_validate(asset, size, &cli_limits, on_issue, &l, &error);
    gtx_json_end_array(&l.json);
    gtx_json_bool(&l.json, "valid", result == GTX_OK);
    gtx_json_end_object(&l.json);
    free(data);

    code = EXIT_CODE_OK;
    if (result != GTX_OK && l.errors == 0)
        code = report_error(l.path, &error);
    else if (result != GTX_OK)
        code = result == GTX_ERROR_VERSION || result == GTX_ERROR_UNSUPPORTED
                   ? EXIT_CODE_UNSUPPORTED : EXIT_CODE_INVALID;
    else if (!as_json)
        code = print_result("valid\n", 6);
    if (as_json) {
        int printed = print_json(l.path, &l.json);
        code = code ? code : printed;
    }
    return code;
}
