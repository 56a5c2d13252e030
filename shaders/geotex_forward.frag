/* The stock forward main: lit colour in sRGB bytes. Follows geotex_fragment.glsl. With
 * GTX_MATERIALS it shades by metallic and roughness, else by Lambert, which costs less. */
layout(location = 0) out vec4 gtx_out_color;

void main()
{
    gtx_surface s;
    if (!gtx_find(s))
        discard;
    vec3 n = gtx_world_normal(s);
    vec4 color = gtx_albedo(s);
#ifdef GTX_MATERIALS
    color.rgb = gtx_shade(gtx_material_of(s, color.rgb), n, -gtx_world_ray(s), gtx_light.xyz,
                          gtx_light.w);
#else
    float lambert = max(dot(n, gtx_light.xyz), 0.0);
    color.rgb *= gtx_light.w + (1.0 - gtx_light.w) * lambert;
#endif
    gtx_out_color = vec4(gtx_to_srgb(color.rgb), color.a);
    gtx_write_depth(s);
}
