/* geotex_shell.frag for what the shell mostly is: patches that are seen from the front alone,
 * without materials, of instances whose transform keeps angles. Normals stay in the patch's own
 * frame, where the light comes from gtx_toward. Needs geotex_dialect.glsl, geotex_sheet.glsl,
 * geotex_view.glsl and geotex_surface.glsl before it, and GTX_FRONT in the vertex shader. */
GTX_VARYING(0) in vec2 gtx_at;
GTX_VARYING(1) flat in vec2 gtx_page;
GTX_VARYING(2) flat in vec3 gtx_toward;
GTX_VARYING(5) flat in vec4 gtx_color;

layout(location = 0) out vec4 gtx_out_color;

void main()
{
    vec3 place = vec3(gtx_at, gtx_page.x);
    vec3 p = gtx_decode_normal(textureLod(gtx_normals, place, gtx_page.y).xy);
    float share = gtx_light.w + max(dot(p, gtx_toward), 0.0) * inversesqrt(dot(p, p));
#ifdef GTX_COLORS
    vec4 color = gtx_color * textureLod(gtx_colors, place, gtx_page.y);
    gtx_out_color = vec4(gtx_to_srgb(color.rgb * share), color.a);
#else
    gtx_out_color = vec4(gtx_shaded_to_srgb(gtx_color.rgb, share), gtx_color.a);
#endif
}
