/* The stock forward main of the LOD mesh: lit colour, in sRGB or linear, from the same maps and by
 * the same light as geotex_forward.frag. Follows geotex_lod_fragment.glsl. GTX_PLAIN and
 * GTX_MATERIALS are as there. */
layout(location = 0) out vec4 gtx_out_color;

/* Light from the front on a unit normal; on a back, on what gtx_from_behind makes of it. */
float gtx_lambert(vec3 n)
{
    vec3 m = gl_FrontFacing ? n : gtx_from_behind(n, gtx_sight());
    return gtx_diffuse(m, -gtx_sight(), gtx_light.xyz, gtx_page.z);
}

void main()
{
#ifdef GTX_TRIMMED
    if (!gtx_is_shown())
        discard;
#endif
    vec3 place = gtx_place();
    float level = gtx_page.y;
    vec3 p = gtx_decode_normal(textureLod(gtx_normals, place, level).xy);
    vec3 n = normalize(gtx_normal_x * p.x + gtx_normal_y * p.y + gtx_normal_z * p.z);
    vec4 color = gtx_color;
#ifdef GTX_MATERIALS
    if (!gl_FrontFacing)
        n = gtx_from_behind(n, gtx_sight());
    if (gtx_maps.y > 0.0)
        color *= textureLod(gtx_colors, place, level);
    gtx_material material = gtx_material_at(place, level, color.rgb);
    color.rgb = gtx_shown(gtx_shade(material, n, -gtx_sight(), gtx_light.xyz, gtx_light.w,
                                    gtx_page.z));
#else
    float share = gtx_light.w + (1.0 - gtx_light.w) * gtx_lambert(n);
#ifdef GTX_PLAIN
    color.rgb = gtx_shown(color.rgb, share);
#else
    color *= textureLod(gtx_colors, place, level);
    color.rgb = gtx_shown(color.rgb * share);
#endif
#endif
    gtx_out_color = color;
}
