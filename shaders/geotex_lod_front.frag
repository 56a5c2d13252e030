/* geotex_lod.frag for what the LOD mesh mostly is: patches that are seen from the front alone, of
 * instances whose transform keeps angles. All is done in the patch's own frame, where its normals
 * are. Needs geotex_view.glsl, geotex_surface.glsl and, with GTX_MATERIALS defined,
 * geotex_material.glsl before it, and GTX_FRONT in the vertex shader. */
GTX_VARYING(0) in vec2 gtx_at;
GTX_VARYING(1) flat in vec3 gtx_page;
GTX_VARYING(2) flat in vec3 gtx_toward;
GTX_VARYING(3) GTX_STEADY in vec3 gtx_eye;
#if defined(GTX_MATERIALS) && !defined(GTX_BLOCKS)
GTX_VARYING(4) flat in vec4 gtx_between;
#endif
GTX_VARYING(5) flat in vec4 gtx_color;

layout(location = 0) out vec4 gtx_out_color;

void main()
{
#ifdef GTX_TRIMMED
    if (!gtx_is_shown())
        discard;
#endif
    vec3 place = vec3(gtx_at, gtx_page.x);
    float level = gtx_page.y;
    vec3 n = normalize(gtx_decode_normal(textureLod(gtx_normals, place, level).xy));
    vec4 color = gtx_color;
    float deviation = gtx_page.z;
#ifdef GTX_BLOCKS
    vec3 eye = normalize(gtx_eye) * (1.0 / deviation);
#else
    vec3 eye = gtx_eye;
#endif
#ifdef GTX_MATERIALS
    if (gtx_maps.y > 0.0)
        color *= textureLod(gtx_colors, place, level);
    gtx_material material = gtx_material_at(place, level, color.rgb);
    vec3 toward = gtx_toward * deviation;
    eye *= deviation;
#ifdef GTX_BLOCKS
    vec4 between = gtx_half_way(vec3(0.0, 0.0, 1.0), eye, toward);
#else
    vec4 between = gtx_between;
#endif
    color.rgb = gtx_shown(gtx_shade(material, n, eye, toward, between, gtx_light.w, deviation));
#else
    float lv = dot(gtx_toward, eye) * (deviation * deviation);
    float light = gtx_diffuse(dot(n, gtx_toward), dot(n, eye), lv, deviation);
    float share = gtx_light.w + (1.0 - gtx_light.w) * light;
#ifdef GTX_PLAIN
    color.rgb = gtx_shown(color.rgb, share);
#else
    color *= textureLod(gtx_colors, place, level);
    color.rgb = gtx_shown(color.rgb * share);
#endif
#endif
    gtx_out_color = color;
}
