/* The shaders of ray_shadows.c: one lighting for patches and polygons. */
#ifndef GTX_SAMPLES_RAY_SHADOWS_SHADERS_H
#define GTX_SAMPLES_RAY_SHADOWS_SHADERS_H

static const char lighting[] =
    "uniform highp sampler2D shadow_map;\n"
    "uniform mat4 sun_clip;\n"
    "uniform vec4 to_sun, way;\n" /* to_sun.w: the depth of a texel's width; way.x: 0..3 */
    "layout(location = 0) out vec4 color;\n"
    "float map_share(vec3 point, float facing) {\n"
    "    vec3 q = (sun_clip * vec4(point, 1.0)).xyz * 0.5 + 0.5;\n"
    "    float slope = sqrt(1.0 - min(facing * facing, 1.0)) / max(facing, 0.1), lit = 0.0;\n"
    "    float nearest = min(q.z - to_sun.w * (2.83 * slope + 1.0), 1.0);\n"
    "    ivec2 size = textureSize(shadow_map, 0);\n"
    "    ivec2 at = clamp(ivec2(floor(q.xy * vec2(size) - 1.5)), ivec2(0), size - 4);\n"
    "    for (int i = 0; i < 16; ++i)\n"
    "        lit += step(nearest, texelFetch(shadow_map, at + ivec2(i & 3, i / 4), 0).r);\n"
    "    return lit / 16.0;\n"
    "}\n"
    "void shade(vec3 albedo, vec3 point, vec3 n) {\n"
    "    float facing = max(dot(n, to_sun.xyz), 0.0), sun, sky = 1.0;\n"
    "    float turn = gtx_ray_turn(gl_FragCoord.xy);\n"
    "    if (way.x == 0.0)\n"
    "        sun = map_share(point, facing);\n"
    "    else if (way.x == 1.0)\n"
    "        sun = gtx_sunlight(point, n, to_sun.xyz, 0.0, 1, 0.0);\n"
    "    else\n"
    "        sun = gtx_sunlight(point, n, to_sun.xyz, 0.08, 8, turn);\n"
    "    if (way.x == 3.0)\n"
    "        sky = gtx_skylight(point, n, 1.5, 8, turn);\n"
    "    vec3 light = vec3(0.26, 0.29, 0.34) * sky + vec3(0.90, 0.84, 0.74) * (facing * sun);\n"
    "    color = vec4(sqrt(albedo * light), 1.0);\n"
    "}\n";
static const char polygon_main[] =
    "in vec3 world_point, world_normal;\n"
    "in vec4 srgb;\n"
    "void main() { shade(srgb.rgb * srgb.rgb, world_point, normalize(world_normal)); }\n";
static const char patch_main[] =
    "void main() {\n"
    "    gtx_surface s;\n"
    "    if (!gtx_find(s)) discard;\n"
    "    shade(gtx_albedo(s).rgb, gtx_world_point(s), gtx_world_normal(s));\n"
    "    gtx_write_depth(s);\n"
    "}\n";

#endif
