/* Writes the shaders of all pipelines as Vulkan GLSL, for the build to compile: NUMBER.vert and
 * NUMBER.frag in a folder. With a second word also vertex shaders of an engine's own mains, and
 * NUMBER.two, which are vertex shaders for two views. */
#include <geotex/frame.h>
#include <stdio.h>

static int write_stage(const char *folder, uint32_t pipeline, gtx_stage stage, int two)
{
    const char *texts[GTX_MAX_SHADER_TEXTS];
    const uint32_t count = gtx_pipeline_source(pipeline, stage, "", texts);
    char path[4096];
    snprintf(path, sizeof path, "%s/%u.%s", folder, pipeline,
             two ? "two" : stage == GTX_STAGE_VERTEX ? "vert" : "frag");
    FILE *file = fopen(path, "w");
    if (!file)
        return 1;
    fputs(two ? "#version 450\n#define GTX_MULTIVIEW\n" : "#version 450\n", file);
    for (uint32_t i = 0; i < count; ++i)
        fputs(texts[i], file);
    return fclose(file);
}

int main(int argc, char **argv)
{
    int failed = argc != 2 && argc != 3;
    for (uint32_t i = 0; !failed && i < GTX_PIPELINE_COUNT; ++i) {
        gtx_pipeline pipeline;
        if (!gtx_pipeline_get(i, &pipeline) || (pipeline.own_main && argc == 2))
            continue;
        const int two = argc == 3 && (pipeline.vertices < GTX_BUFFER_GRID_VERTICES ||
                                      pipeline.vertices == GTX_BUFFER_BLOCKS);
        failed = write_stage(argv[1], i, GTX_STAGE_VERTEX, 0) ||
                 (two && write_stage(argv[1], i, GTX_STAGE_VERTEX, 1)) ||
                 (!pipeline.own_main && write_stage(argv[1], i, GTX_STAGE_FRAGMENT, 0));
    }
    return failed;
}
