/* The stock main of deferred shading. Follows geotex_fragment.glsl, with GTX_MATERIALS. */
layout(location = 0) out vec4 gtx_out_albedo;    /* sRGB, or linear; alpha */
layout(location = 1) out vec4 gtx_out_normal;    /* world space, * 0.5 + 0.5 */
layout(location = 2) out vec4 gtx_out_material;  /* occlusion, roughness with what normals
                                                      stray, metallic, lit */
layout(location = 3) out vec4 gtx_out_emission;  /* linear */

void main()
{
    gtx_surface s;
    if (!gtx_find(s))
        discard;
    vec4 albedo = gtx_albedo(s);
    gtx_material m = gtx_material_of(s, albedo.rgb);
    gtx_out_albedo = vec4(gtx_shown(albedo.rgb), albedo.a);
    gtx_out_normal = vec4(gtx_world_normal(s) * 0.5 + 0.5, 1.0);
    float roughness = sqrt(sqrt(gtx_roughness4(m.roughness, s.deviation)));
    gtx_out_material = vec4(m.occlusion, roughness, m.metallic, m.lit);
    gtx_out_emission = vec4(m.emission, 1.0);
    gtx_write_depth(s);
}
