/* Shared by the verbs that make an asset of assets, grids or images: checks, saving, reports. */
#include "cli/cli.h"

#include "base/warnings.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static int usage(const made_file *m, const char *sentence, const char *name)
{
    print_message("gtx %s: error[usage]: %s%s", m->verb, sentence, name);
    return EXIT_CODE_USAGE;
}

static char *copy_of(const char *text)
{
    char *copy = malloc(strlen(text) + 1);
    return copy ? strcpy(copy, text) : NULL;
}

/* Appends a copy, or NULL; the list has room for a power of two, or for as many as it holds. */
static bool append(char ***list, size_t *count, const char *text)
{
    if ((*count & (*count - 1)) == 0) {
        char **larger = realloc(*list, (*count ? 2 * *count : 1) * sizeof **list);
        if (!larger)
            return false;
        *list = larger;
    }
    char *copy = copy_of(text);
    if (copy)
        (*list)[(*count)++] = copy;
    return copy != NULL;
}

static void free_list(char **list, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        free(list[i]);
    free(list);
}

void made_free(made_file *m)
{
    free_list(m->sources, m->source_count);
    free_list(m->sentences, m->warning_count);
    free(m->kinds);
    m->sources = m->sentences = NULL;
    m->kinds = NULL;
    m->source_count = m->warning_count = 0;
}

int made_from(made_file *m, const char *source)
{
    return append(&m->sources, &m->source_count, source) ? EXIT_CODE_OK : report_no_memory(source);
}

/* "NAME,..." of --allow. */
static int set_allowed(made_file *m)
{
    char name[64];
    for (const char *at = m->allow; at && *at;) {
        const size_t length = strcspn(at, ",");
        snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : sizeof name - 1),
                 at);
        const gtx_warning kind = gtx_warning_named(name);
        if (kind == GTX_WARNING_COUNT)
            return usage(m, "there is no warning to allow of the name ", name);
        m->allowed[kind] = true;
        at += length + (at[length] != 0);
    }
    return EXIT_CODE_OK;
}

int made_check(made_file *m)
{
    const output_file outputs[] = {
        {"-o", m->output}, {"--report", m->report}, {"--depfile", m->depfile}, {NULL, NULL}};
    char caller[32];
    _Static_assert(GTX_WARNING_COUNT <= sizeof m->allowed, "a flag a kind of warning");
    m->start = seconds_now();
    snprintf(caller, sizeof caller, "gtx %s", m->verb);
    if (m->allow && !m->strict)
        return usage(m, "--allow needs --strict", "");
    if (m->depfile && !fits_depfile(m->output))
        return usage(m, "a dependency file cannot name a path with a line break", "");
    for (size_t i = 0; i < m->source_count && m->depfile; ++i)
        if (!fits_depfile(m->sources[i]))
            return usage(m, "a dependency file cannot name a path with a line break: ",
                         m->sources[i]);
    const int code = set_allowed(m);
    return code ? code
                : check_outputs(caller, outputs, (const char *const *)m->sources, m->source_count);
}

int made_warn(made_file *m, const char *file, uint32_t kind, const char *sentence)
{
    const bool is_note = gtx_warning_is_note((gtx_warning)kind);
    if (m->strict && !is_note && !m->allowed[kind]) {
        print_message("%s: error[input]: %s (%s)", file, sentence,
                      gtx_warning_name((gtx_warning)kind));
        return EXIT_CODE_INVALID;
    }
    report_warning(file, gtx_warning_name((gtx_warning)kind), sentence);
    uint32_t *kinds = realloc(m->kinds, (m->warning_count + 1) * sizeof *kinds);
    if (!kinds)
        return report_no_memory(file);
    m->kinds = kinds;
    kinds[m->warning_count] = kind;
    return append(&m->sentences, &m->warning_count, sentence) ? EXIT_CODE_OK
                                                              : report_no_memory(file);
}

/* ---- saving ---- */

static bool has_content(const char *path, const void *data, size_t size)
{
    FILE *file = fopen(path, "rb");
    char part[65536];
    size_t at = 0, got;
    if (!file)
        return false;
    while ((got = fread(part, 1, sizeof part, file)) > 0 && got <= size - at &&
           !memcmp(part, (const char *)data + at, got))
        at += got;
    const bool same = got == 0 && at == size && !ferror(file);
    fclose(file);
    return same;
}

static int write(made_file *m, const gtx_asset *asset, const gtx_encode_desc *encode)
{
    void *data;
    size_t size;
    gtx_error error;
    catch_interrupt();
    if (gtx_encode(asset, encode, &data, &size, &error))
        return report_error(m->output, &error);
    m->bytes = size;
    m->unchanged = m->if_changed && has_content(m->output, data, size);
    const int code = m->unchanged ? EXIT_CODE_OK : write_text_file(m->output, data, size);
    free(data);
    return code;
}

static void add_warnings(const made_file *m, gtx_json *json, bool notes)
{
    for (unsigned names = 0; names < 2; ++names) {
        gtx_json_begin_array(json, notes   ? (names ? "note_names" : "notes")
                                   : names ? "warning_names"
                                           : "warnings");
        for (size_t i = 0; i < m->warning_count; ++i)
            if (gtx_warning_is_note((gtx_warning)m->kinds[i]) == notes)
                gtx_json_string(json, NULL, names ? gtx_warning_name((gtx_warning)m->kinds[i])
                                                  : m->sentences[i]);
        gtx_json_end_array(json);
    }
}

static int write_report(const made_file *m, const gtx_asset *asset)
{
    gtx_json json = {0};
    gtx_info info;
    gtx_get_info(asset, &info);
    gtx_json_begin_object(&json, NULL);
    gtx_json_string(&json, "verb", m->verb);
    gtx_json_begin_array(&json, "sources");
    for (size_t i = 0; i < m->source_count; ++i)
        gtx_json_string(&json, NULL, m->sources[i]);
    gtx_json_end_array(&json);
    gtx_json_integer(&json, "patches", info.patch_count);
    gtx_json_integer(&json, "lod_meshes", info.lod_levels);
    gtx_json_integer(&json, "bytes", m->bytes);
    gtx_json_hash(&json, "content_hash", info.content_hash);
    gtx_json_bool(&json, "unchanged", m->unchanged);
    gtx_json_number(&json, "seconds", seconds_now() - m->start);
    add_warnings(m, &json, false);
    add_warnings(m, &json, true);
    gtx_json_end_object(&json);
    const int code = json.failed ? report_no_memory(m->report)
                                 : write_text_file(m->report, json.text, json.size);
    gtx_json_free(&json);
    return code;
}

int made_save(made_file *m, const gtx_asset *asset, const gtx_encode_desc *encode)
{
    int code = write(m, asset, encode);
    if (!code && m->depfile)
        code = write_depfile(m->depfile, m->output, m->sources, m->source_count);
    if (!code && m->report)
        code = write_report(m, asset);
    return code;
}
