/* Fragment mains of an engine's own, compiled as an engine would. */
#ifndef GTX_TESTS_VULKAN_COMPILE_H
#define GTX_TESTS_VULKAN_COMPILE_H

#include "both.h"

#include <unistd.h>

/* What the engine's compiler made. */
typedef struct compiled {
    const char *main;
    char folder[64];
    uint32_t *words;
    bool no_tiles, broken;
    uint32_t asked;
} compiled;

/* By glslangValidator, which the build of the library took, too. */
static inline const uint32_t *compile(uint32_t pipeline, size_t *bytes, void *user)
{
    compiled *c = user;
    const char *texts[GTX_MAX_SHADER_TEXTS];
    gtx_pipeline of;
    char path[128], command[512];
    assert_true(gtx_pipeline_get(pipeline, &of) && of.own_main);
    ++c->asked;
    if (c->broken || (c->no_tiles && of.vertices == GTX_BUFFER_TILE_CORNERS))
        return NULL;
    const uint32_t count = gtx_pipeline_source(pipeline, GTX_STAGE_FRAGMENT, c->main, texts);
    snprintf(path, sizeof path, "%s/own.frag", c->folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("#version 450\n", file);
    for (uint32_t i = 0; i < count; ++i)
        fputs(texts[i], file);
    fclose(file);
    snprintf(command, sizeof command,
             "glslangValidator -V --target-env vulkan1.0 -o %s/own.spv %s >%s/log || "
             "{ cat %s/log >&2; false; }", c->folder, path, c->folder, c->folder);
    assert_int_equal(system(command), 0);
    snprintf(path, sizeof path, "%s/own.spv", c->folder);
    file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *bytes = (size_t)ftell(file);
    rewind(file);
    free(c->words);
    c->words = malloc(*bytes);
    assert_int_equal(fread(c->words, 1, *bytes, file), *bytes);
    fclose(file);
    return c->words;
}

static inline void begin_compiling(compiled *c)
{
    snprintf(c->folder, sizeof c->folder, "/tmp/gtx_shading_XXXXXX");
    assert_non_null(mkdtemp(c->folder));
}

static inline void end_compiling(compiled *c)
{
    char command[128];
    snprintf(command, sizeof command, "rm -r %s", c->folder);
    assert_int_equal(system(command), 0);
    free(c->words);
}

#endif
