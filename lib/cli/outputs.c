/* Outputs: written atomically, and never over an input. */
#include "cli/cli.h"

#include "base/error.h"
#include "base/output.h"

#include <string.h>

int write_text_file(const char *path, const char *text, size_t size)
{
    gtx_error error;
    return gtx_write_file(path, text, size, &error) ? report_error(path, &error) : EXIT_CODE_OK;
}

static bool is_same(const char *output, const char *other, const char *stream)
{
    return gtx_same_file(strcmp(output, "-") ? output : "/dev/stdout",
                         strcmp(other, "-") ? other : stream);
}

gtx_result refuse_inputs(const output_file *outputs, const char *const *inputs, size_t count,
                         gtx_error *error)
{
    for (const output_file *o = outputs; o->option; ++o)
        for (size_t i = 0; i < count && o->path; ++i)
            if (is_same(o->path, inputs[i], "/dev/stdin"))
                return gtx_fail(error, GTX_ERROR_ARGUMENT,
                                "%s would write over a file that is read: %s", o->option, o->path);
    return GTX_OK;
}

int check_outputs(const char *caller, const output_file *outputs, const char *const *inputs,
                  size_t count)
{
    gtx_error error;
    gtx_result result = refuse_inputs(outputs, inputs, count, &error);
    for (const output_file *o = outputs; !result && o->option; ++o)
        for (const output_file *p = outputs; p != o && !result; ++p)
            if (o->path && p->path && is_same(o->path, p->path, "/dev/stdout"))
                result = gtx_fail(&error, GTX_ERROR_ARGUMENT, "%s and %s would write one file: %s",
                                  p->option, o->option, o->path);
    return result ? report_error(caller, &error) : EXIT_CODE_OK;
}
