/* The shaders of pipelines as SPIR-V, as the build puts them into the library. */
#ifndef GTX_VULKAN_SPIRV_H
#define GTX_VULKAN_SPIRV_H

#include <stddef.h>
#include <stdint.h>

typedef struct gtx_spirv {
    uint32_t pipeline, stage; /* 0, 1: vertices, fragments; 2: vertices in two views */
    const uint32_t *words;
    size_t bytes;
} gtx_spirv;

/* Ends with no words. */
extern const gtx_spirv gtx_spirvs[];

#endif
