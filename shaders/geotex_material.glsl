/* The material of a hit, and its stock shading: metallic-roughness as in glTF 2.0, appendix B.
 *
 * Needs geotex_view.glsl and geotex_surface.glsl before it. */
GTX_SAMPLER(5, highp sampler2DArray) gtx_materials;  /* occlusion, roughness, metallic, lit; mips */
GTX_SAMPLER(6, highp sampler2DArray) gtx_emissions;  /* sRGB, mips; decoded when sampled */

/* What light meets at a point. Colours are linear. */
struct gtx_material {
    vec3 color, emission;
    float occlusion, roughness, metallic;
    float lit;                /* share of lighting: 0 shows the colour as it is */
};

/* At a place of the pages, for what interpolates one: LOD meshes and displaced grids. gtx_maps.z
 * scales the emission, 0 when there is none; .w is 1 when the model has materials. With
 * GTX_CONSTANT it has one material all over, and no emission. */
gtx_material gtx_material_at(vec3 place, float level, vec3 color)
{
#ifdef GTX_CONSTANT
    vec4 map = gtx_constant_material;
    return gtx_material(color, vec3(0.0), map.x, map.y, map.z, map.w);
#else
    gtx_material m = gtx_material(color, vec3(0.0), 1.0, 1.0, 0.0, 1.0);
    if (gtx_maps.w > 0.0) {
        vec4 map = textureLod(gtx_materials, place, level);
        m = gtx_material(color, vec3(0.0), map.x, map.y, map.z, map.w);
    }
    if (gtx_maps.z > 0.0)
        m.emission = textureLod(gtx_emissions, place, level).rgb * gtx_maps.z;
    return m;
#endif
}

/* The roughness of glTF to the fourth, with what normals stray added to it: variances of slopes add
 * up (LEAN mapping, Olano and Baker 2010). */
float gtx_roughness4(float roughness, float deviation)
{
    float square = roughness * roughness;
    return clamp(square * square + 2.0 * deviation * deviation, 4e-6, 1.0);
}

/* Of one directional light, so bright that a white wall facing it is white, and of light from
 * everywhere, which takes the share `ambient`. n, eye and light are unit, away from the surface, in
 * one space, and half_way is what gtx_half_way says; normals stray by `deviation` about n. */
vec3 gtx_shade(gtx_material m, vec3 n, vec3 eye, vec3 light, vec4 half_way, float ambient,
               float deviation)
{
    vec3 f0 = mix(vec3(0.04), m.color, m.metallic);
    vec3 diffuse = m.color * (0.96 * (1.0 - m.metallic));
    float nl = max(dot(n, light), 0.0), nv = max(dot(n, eye), 1e-3);
    float nh = max(dot(n, half_way.xyz), 0.0);

    /* Fresnel by Schlick; distribution by Trowbridge and Reitz, times pi; visibility by Smith, with
     * masking and shadowing correlated. */
    vec3 fresnel = f0 + (1.0 - f0) * half_way.w;
    float a2 = gtx_roughness4(m.roughness, deviation), d = nh * nh * (a2 - 1.0) + 1.0;
    float distribution = a2 / (d * d);
    float visibility = 0.5 / max(nl * sqrt(nv * nv * (1.0 - a2) + a2) +
                                 nv * sqrt(nl * nl * (1.0 - a2) + a2), 1e-6);
    float wide = gtx_diffuse(n, eye, light, deviation);
    vec3 direct = diffuse * (1.0 - fresnel) * (wide / 0.96) +
                  fresnel * (distribution * visibility * nl);
    vec3 around = (diffuse + f0) * m.occlusion;
    vec3 shaded = (1.0 - ambient) * direct + ambient * around;
    return mix(m.color, shaded, m.lit) + m.emission;
}

vec3 gtx_shade(gtx_material m, vec3 n, vec3 eye, vec3 light, float ambient, float deviation)
{
    return gtx_shade(m, n, eye, light, gtx_half_way(n, eye, light), ambient, deviation);
}

/* Of normals that do not stray. */
vec3 gtx_shade(gtx_material m, vec3 n, vec3 eye, vec3 light, float ambient)
{
    return gtx_shade(m, n, eye, light, ambient, GTX_LEAST_DEVIATION);
}
