/* A forward main for engines, to use as it is (gtx_shading_create with its text) or to begin from:
 * linear light of several lights, the first with the engine's shadow map; fog; and how far a point
 * has moved in the picture since the frame before. Follows geotex_fragment.glsl or
 * geotex_lod_fragment.glsl, with GTX_MATERIALS. The block is gtx_lighting of frame.h; with Vulkan
 * it and the samplers are bindings 0, 1 and 2 of set 1. */
#pragma geotex tiles
layout(location = 0) out vec4 gtx_out_color;   /* linear, without a bound above */
layout(location = 1) out vec4 gtx_out_motion;  /* xy: since then, in shares of the viewport */

#ifdef VULKAN
#define GTX_LIGHTING_BLOCK layout(std140, set = 1, binding = 0)
#define GTX_LIGHTING_SAMPLER(b, type) layout(set = 1, binding = b) uniform type
#else
#define GTX_LIGHTING_BLOCK layout(std140)
#define GTX_LIGHTING_SAMPLER(b, type) uniform type
#endif

struct gtx_lamp {
    vec4 place;        /* w 0: of a sun, xyz unit, towards it; else xyz in the world, w its range */
    vec4 color;        /* w: of a spot, the cosine where it ends; -1 of others */
    vec4 axis;         /* of a spot, unit, away from it; w: the cosine up to where it is whole */
};

GTX_LIGHTING_BLOCK uniform gtx_lighting {
    mat4 gtx_lighting_clip, gtx_lighting_clip_before;
    mat4 gtx_lighting_shadow;
    vec4 gtx_lighting_eye, gtx_lighting_around, gtx_lighting_fog, gtx_lighting_options;
    gtx_lamp gtx_lamps[8];
};
GTX_LIGHTING_SAMPLER(1, highp sampler2DShadow) gtx_shadow_map;
GTX_LIGHTING_SAMPLER(2, highp sampler2D) gtx_before;

/* What reaches a point of the first light, by the engine's map: 1 beyond it. Of the four texels
 * that are compared the farthest centre is one off in x and y, where a surface aslant has fallen by
 * sqrt(2) times its slope in widths of a texel; and a width for a coarser level in the map. */
float gtx_sun_share(vec3 world, vec3 n)
{
    float facing = clamp(dot(n, gtx_lamps[0].place.xyz), 0.1, 1.0);
    float bias = gtx_lighting_options.y * (1.0 + 1.5 * sqrt(1.0 - facing * facing) / facing);
    vec4 p = gtx_lighting_shadow * vec4(world, 1.0);
    vec3 at = p.xyz / p.w;
    bool within = all(greaterThan(at, vec3(0.0))) && all(lessThan(at, vec3(1.0)));
    float share = textureLod(gtx_shadow_map, vec3(at.xy, at.z - bias), 0.0);
    return within && gtx_lighting_options.x > 0.0 ? share : 1.0;
}

/* Towards a light, and how much of it comes: by the square of the distance, to nothing at its range
 * (Karis, Real shading in Unreal Engine 4, SIGGRAPH 2013). */
vec4 gtx_toward(gtx_lamp light, vec3 world)
{
    if (light.place.w <= 0.0)
        return vec4(light.place.xyz, 1.0);
    vec3 way = light.place.xyz - world;
    float square = max(dot(way, way), 1e-8), far = square / (light.place.w * light.place.w);
    float ends = clamp(1.0 - far * far, 0.0, 1.0);
    vec3 toward = way * inversesqrt(square);
    float cosine = dot(-toward, light.axis.xyz);
    float spot = light.color.w <= -1.0 ? 1.0 : smoothstep(light.color.w, light.axis.w, cosine);
    return vec4(toward, ends * ends / square * spot);
}

void main()
{
    gtx_surface s;
    if (!gtx_find(s))
        discard;
    vec3 world = gtx_world_point(s), n = gtx_world_normal(s), eye = -gtx_world_ray(s);
    vec4 albedo = gtx_albedo(s);
    gtx_material m = gtx_material_of(s, albedo.rgb), lit = m;
    lit.emission = vec3(0.0);
    lit.lit = 1.0;
    vec3 sum = gtx_shade(lit, n, eye, n, 1.0, s.deviation) * gtx_lighting_around.rgb;
    for (int i = 0; i < int(gtx_lighting_around.w); ++i) {
        vec4 toward = gtx_toward(gtx_lamps[i], world);
        float share = toward.w;
        if (i == 0)
            share *= gtx_sun_share(world, n);
        sum += gtx_shade(lit, n, eye, toward.xyz, 0.0, s.deviation) *
               (gtx_lamps[i].color.rgb * share);
    }
    vec3 color = mix(m.color, sum, m.lit) + m.emission;
    float fog = 1.0 - exp(-gtx_lighting_fog.w * distance(world, gtx_lighting_eye.xyz));
    gtx_out_color = vec4(mix(color, gtx_lighting_fog.rgb, fog), albedo.a);

    vec3 before = world;
    if (gtx_lighting_options.z > 0.0) {
        vec4 object = vec4(gtx_object_point(s), 1.0);
        int row = int(gtx_id);
        before = vec3(dot(texelFetch(gtx_before, ivec2(0, row), 0), object),
                      dot(texelFetch(gtx_before, ivec2(1, row), 0), object),
                      dot(texelFetch(gtx_before, ivec2(2, row), 0), object));
    }
    vec4 now = gtx_lighting_clip * vec4(world, 1.0);
    vec4 then = gtx_lighting_clip_before * vec4(before, 1.0);
    gtx_out_motion = vec4(0.5 * (now.xy / now.w - then.xy / then.w), 0.0, 0.0);
    gtx_write_depth(s);
}
