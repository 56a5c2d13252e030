/* The stock forward main: lit colour, in sRGB or linear. Follows geotex_fragment.glsl. With
 * GTX_MATERIALS it shades by metallic and roughness, else by Lambert, which costs less; least with
 * GTX_PLAIN, where no map gives colours. */
layout(location = 0) out vec4 gtx_out_color;

void main()
{
    gtx_surface s;
    if (!gtx_find(s))
        discard;
    vec3 n = gtx_world_normal(s);
#ifdef GTX_PLAIN
    vec4 color = gtx_color;
#else
    vec4 color = gtx_albedo(s);
#endif
#ifdef GTX_MATERIALS
    color.rgb = gtx_shade(gtx_material_of(s, color.rgb), n, -gtx_world_ray(s), gtx_light.xyz,
                          gtx_light.w, s.deviation);
    gtx_out_color = vec4(gtx_shown(color.rgb), color.a);
#else
    float light = gtx_diffuse(n, -gtx_world_ray(s), gtx_light.xyz, s.deviation);
    float share = gtx_light.w + (1.0 - gtx_light.w) * light;
#ifdef GTX_PLAIN
    gtx_out_color = vec4(gtx_shown(color.rgb, share), color.a);
#else
    gtx_out_color = vec4(gtx_shown(color.rgb * share), color.a);
#endif
#endif
    gtx_write_depth(s);
}
