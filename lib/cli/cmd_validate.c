/* gtx validate: an asset against every rule of format/gtx.md. */
#include "cli/cli.h"

#include "base/json.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static bool as_json;

static const option options[] = {
    {"json", 0, OPTION_FLAG, &as_json, NULL, "one JSON object instead of text", 0, 0}, {0}};

static const verb validate_verb = {"validate", "ASSET",
                                   "Checks a file against every rule of the .gtx format.", 1, 1,
                                   options};

typedef struct listener {
    const char *path;
    gtx_json json;
    uint32_t errors;
} listener;

static void on_issue(const gtx_issue *issue, void *user)
{
    listener *l = user;
    const char *severity = issue->is_error ? "error" : "warning";
    l->errors += issue->is_error;
    if (!as_json) {
        fprintf(stderr, "%s: %s[%u %s]: %s (byte %" PRIu64 ")\n", l->path, severity, issue->rule,
                issue->name, issue->message, issue->offset);
        return;
    }
    gtx_json_begin_object(&l->json, NULL);
    gtx_json_string(&l->json, "severity", severity);
    gtx_json_integer(&l->json, "rule", issue->rule);
    gtx_json_string(&l->json, "name", issue->name);
    gtx_json_integer(&l->json, "offset", issue->offset);
    gtx_json_string(&l->json, "message", issue->message);
    gtx_json_end_object(&l->json);
}

/* The whole file in memory from malloc; NULL with errno set. */
static uint8_t *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    uint8_t *data = NULL;
    size_t capacity = 0;
    *size = 0;
    for (;;) {
        if (*size == capacity) {
            capacity = capacity ? 2 * capacity : 1 << 16;
            uint8_t *grown = realloc(data, capacity);
            if (!grown)
                break;
            data = grown;
        }
        size_t got = fread(data + *size, 1, capacity - *size, file);
        *size += got;
        if (!got) {
            if (ferror(file))
                break;
            fclose(file);
            return data;
        }
    }
    free(data);
    fclose(file);
    return NULL;
}

int cmd_validate(int argc, char **argv)
{
    listener l = {0};
    int count;
    int code = parse_options(&validate_verb, argc, argv, &l.path, &count);
    if (code >= 0)
        return code;
    size_t size;
    uint8_t *data = read_file(l.path, &size);
    if (!data) {
        fprintf(stderr, "%s: error[read]: %s\n", l.path, strerror(errno));
        return EXIT_CODE_FILE;
    }
    gtx_error error;
    gtx_json_begin_object(&l.json, NULL);
    gtx_json_begin_array(&l.json, "issues");
    gtx_result result = gtx_validate(data, size, on_issue, &l, &error);
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
        int printed = print_result(l.json.text, l.json.size);
        code = code ? code : printed;
    }
    gtx_json_free(&l.json);
    return code;
}
