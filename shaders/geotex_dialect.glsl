/* One GLSL for OpenGL 3.3 core and later, OpenGL ES 3.0 and Vulkan. Comes first after #version;
 * each other file names those that it needs before it, with what these need.
 *
 * GTX_SAMPLER(b, type) declares a sampler at binding b of set 0; GTX_VARYING(n) gives a varying its
 * location; members between GTX_BLOCK(b, name) and GTX_BLOCK_END are plain uniforms, each marked
 * GTX_UNIFORM. With GTX_RHI, which Vulkan implies, they are a block at binding b, and vertices are
 * read as floats and whole numbers alone; bindings are told from GLSL 4.20 on. With GTX_MULTIVIEW,
 * which is for vertex shaders alone, two views are drawn at once. */
#ifdef GTX_MULTIVIEW
#extension GL_EXT_multiview : require
#endif
#ifdef GL_ARM_shader_framebuffer_fetch_depth_stencil
#extension GL_ARM_shader_framebuffer_fetch_depth_stencil : require
#ifdef GL_OES_sample_variables
#extension GL_OES_sample_variables : require
#define GTX_DEPTH_FETCH
#endif
#ifdef GL_ARB_sample_shading
#extension GL_ARB_sample_shading : require
#define GTX_DEPTH_FETCH
#endif
#endif
#ifdef GL_ARB_texture_gather
#extension GL_ARB_texture_gather : require
#define GTX_GATHER
#elif (defined(GL_ES) && __VERSION__ >= 310) || (!defined(GL_ES) && __VERSION__ >= 400)
#define GTX_GATHER
#endif
#if defined(GTX_GATHER) && !defined(GTX_FETCH) /* languages that gather no whole numbers */
#define GTX_GATHER_CODES
#endif
#ifdef GL_ES
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
precision highp usampler2DArray;
#endif
#if defined(VULKAN) && !defined(GTX_RHI)
#define GTX_RHI
#endif
#ifdef VULKAN
#define GTX_SAMPLER(b, type) layout(set = 0, binding = b) uniform type
#define GTX_VARYING(n) layout(location = n)
#define GTX_BLOCK(b, name) layout(std140, set = 0, binding = b) uniform name {
#elif defined(GTX_RHI) && __VERSION__ >= 420
#define GTX_SAMPLER(b, type) layout(binding = b) uniform type
#define GTX_VARYING(n)
#define GTX_BLOCK(b, name) layout(std140, binding = b) uniform name {
#else
#define GTX_SAMPLER(b, type) uniform type
#define GTX_VARYING(n)
#define GTX_BLOCK(b, name) layout(std140) uniform name {
#endif
#ifdef GTX_RHI
#define GTX_UNIFORM
#define GTX_BLOCK_END };
#else
#undef GTX_BLOCK
#define GTX_BLOCK(b, name)
#define GTX_UNIFORM uniform
#define GTX_BLOCK_END
#endif
#ifdef VULKAN
/* Mesa divides each component by the length where SPIR-V says normalize: LOD meshes of a bunny took
 * 1.25 times the processor time of OpenGL with it, and 1.14 without (llvmpipe). Gone again before
 * an engine's own main. */
vec3 gtx_unit(vec3 v)
{
    return v * inversesqrt(dot(v, v));
}
#define normalize gtx_unit
#endif
