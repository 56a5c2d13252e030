/* What cook-worker.js calls: one model's bytes in, an asset's out. Built by emscripten alone; see
 * web/cook.mk. */
#include <geotex/cook.h>

#include <emscripten/emscripten.h>

#include <stdlib.h>
#include <string.h>

#define WEB_API EMSCRIPTEN_KEEPALIVE

/* One call at a time, as a worker has it. */
static gtx_error last_error;
static gtx_cook_desc desc;
static gtx_report report;
static void *encoded;
static size_t encoded_size;

EM_JS(void, progress_line, (const char *stage, float fraction), {
    Module['onProgress'](UTF8ToString(stage), fraction);
})

static int tell(const gtx_progress *progress, void *user)
{
    (void)user;
    progress_line(progress->stage, progress->fraction);
    return 0; /* who cancels ends the worker */
}

WEB_API int gtxk_result(void)
{
    return (int)last_error.result;
}

WEB_API const char *gtxk_message(void)
{
    return last_error.message;
}

/* Of the last cook's result. */
WEB_API const void *gtxk_data(void)
{
    return encoded;
}

WEB_API size_t gtxk_size(void)
{
    return encoded_size;
}

/* A sentence; NULL behind the last. */
WEB_API const char *gtxk_warning(size_t i)
{
    return i < report.warning_count ? report.warnings[i] : NULL;
}

WEB_API void gtxk_begin(void)
{
    gtx_report_free(&report);
    free(encoded);
    encoded = NULL;
    encoded_size = 0;
    memset(&report, 0, sizeof report);
    memset(&desc, 0, sizeof desc);
    memset(&last_error, 0, sizeof last_error);
    desc.threads = 1;
    desc.progress = tell;
}

/* What each name of an option is in a gtx_cook_desc. Returns 0 for a name that is none. */
WEB_API int gtxk_set(const char *name, double value)
{
#define WHOLE(given, field) {given, &desc.field, NULL, NULL, NULL}
#define LIMIT(field) {#field, NULL, &desc.limits.field, NULL, NULL}
    const struct {
        const char *name;
        uint32_t *whole;
        uint64_t *limit;
        float *number;
        double *precise;
    } rows[] = {
        WHOLE("charts", charts), WHOLE("resolution", resolution), WHOLE("heightBits", height_bits),
        WHOLE("dilation", dilation), WHOLE("mips", mips), WHOLE("lodLevels", lod_levels),
        WHOLE("zUp", z_up), WHOLE("strict", strict), WHOLE("adaptive", adaptive),
        WHOLE("closed", closed), LIMIT(memory), LIMIT(triangles), LIMIT(texels), LIMIT(patches),
        LIMIT(work), {"unit", NULL, NULL, &desc.unit, NULL},
        {"error", NULL, NULL, NULL, &desc.error}};
    if (!strcmp(name, "partition")) {
        desc.partition = (gtx_partition)value;
        return 1;
    }
    if (!strcmp(name, "zstdLevel")) {
        desc.zstd_level = (int32_t)value;
        return 1;
    }
    for (size_t i = 0; i < sizeof rows / sizeof *rows; ++i) {
        if (strcmp(name, rows[i].name))
            continue;
        if (rows[i].whole)
            *rows[i].whole = (uint32_t)value;
        else if (rows[i].limit)
            *rows[i].limit = (uint64_t)value;
        else if (rows[i].number)
            *rows[i].number = (float)value;
        else
            *rows[i].precise = value;
        return 1;
    }
    return 0;
}

/* `name` tells the format where the bytes do not. Returns a gtx_result. */
WEB_API int gtxk_cook(const void *data, size_t size, const char *name)
{
    /* The usual limit, but less than the module can have, so that it says what took it. */
    const uint64_t usual = (UINT64_C(256) << 20) + UINT64_C(2000) * size;
    const uint64_t most = UINT64_C(1800) << 20;
    gtx_asset *asset = NULL;
    const gtx_encode_desc how = {.zstd_level = desc.zstd_level};
    if (!desc.limits.memory)
        desc.limits.memory = usual < most ? usual : most;
    gtx_result result = gtx_cook_memory(data, size, name, &desc, &asset, &report, &last_error);
    if (!result)
        result = gtx_encode(asset, &how, &encoded, &encoded_size, &last_error);
    gtx_close(asset);
    return (int)result;
}
