/* The stock forward main: casts the ray, writes lit colour (sRGB bytes) and true depth.
 *
 * Needs geotex_dialect.glsl, geotex_sheet.glsl, geotex_view.glsl, geotex_surface.glsl and a
 * gtx_cast (geotex_cast.glsl or geotex_paper.glsl) before it; varyings as geotex_proxy.vert. With
 * GTX_MATERIALS defined it needs geotex_material.glsl too, and shades by that; else by Lambert. */
GTX_VARYING(0) in vec3 gtx_point;
GTX_VARYING(1) flat in vec3 gtx_eye;
GTX_VARYING(2) flat in vec4 gtx_clip_z;
GTX_VARYING(3) flat in vec4 gtx_clip_w;
GTX_VARYING(4) flat in vec3 gtx_normal_x;
GTX_VARYING(5) flat in vec3 gtx_normal_y;
GTX_VARYING(6) flat in vec3 gtx_normal_z;
GTX_VARYING(7) flat in vec4 gtx_color;
GTX_VARYING(8) flat in int gtx_patch_index;
GTX_VARYING(9) flat in vec4 gtx_rect;
GTX_VARYING(10) flat in vec4 gtx_span;
GTX_VARYING(11) flat in int gtx_level;

layout(location = 0) out vec4 gtx_out_color;

void main()
{
    vec3 dx = dFdx(gtx_point), dy = dFdy(gtx_point);
    gtx_sheet sheet = gtx_sheet_of(gtx_rect, gtx_span, gtx_level);
    vec3 direction = gtx_point * gtx_depth.w - gtx_eye;

    /* z and w of the clip position are linear along the ray: zw + t * step. */
    vec2 zw = vec2(dot(gtx_clip_z, vec4(gtx_point, 1.0)), dot(gtx_clip_w, vec4(gtx_point, 1.0)));
    vec2 zw_step = vec2(dot(gtx_clip_z.xyz, direction), dot(gtx_clip_w.xyz, direction));
    float t0 = -1e30, t1 = 1e30;
    gtx_clip(zw.x + gtx_depth.x * zw.y, zw_step.x + gtx_depth.x * zw_step.y, t0, t1);
    gtx_clip(zw.y - zw.x, zw_step.y - zw_step.x, t0, t1);
    gtx_clip_box(sheet, gtx_point, direction, t0, t1);
    gtx_hit hit;
    if (t0 > t1 || !gtx_cast(sheet, gtx_point, direction, t0, t1, hit))
        discard;

    float widen = 1.0 + hit.t * gtx_depth.w;
    float level = gtx_level_of(hit, direction, dx * widen, dy * widen);
    vec2 code = gtx_lookup(gtx_normals, sheet, hit.grid.xy, level, gtx_maps.x).xy;
    gtx_frame frame = gtx_frame_of(gtx_patch_index);
    vec3 n = gtx_decode_normal(frame, code);
    if (hit.back)
        n = gtx_from_behind(n, mat3(frame.axis_x, frame.axis_y, frame.axis_z) * direction);
    n = normalize(gtx_normal_x * n.x + gtx_normal_y * n.y + gtx_normal_z * n.z);
    vec4 color = gtx_color;
    if (gtx_maps.y > 0.0)
        color *= gtx_lookup(gtx_colors, sheet, hit.grid.xy, level, gtx_maps.x);
#ifdef GTX_MATERIALS
    /* The columns for normals are the inverse transpose of object -> world, times any number. */
    mat3 world = inverse(transpose(mat3(gtx_normal_x, gtx_normal_y, gtx_normal_z)));
    vec3 ray = world * (mat3(frame.axis_x, frame.axis_y, frame.axis_z) * direction);
    gtx_material material = gtx_material_of(sheet, hit.grid.xy, level, color.rgb);
    color.rgb = gtx_shade(material, n, -normalize(ray), gtx_light.xyz, gtx_light.w);
#else
    float lambert = max(dot(n, gtx_light.xyz), 0.0);
    color.rgb *= gtx_light.w + (1.0 - gtx_light.w) * lambert;
#endif
    gtx_out_color = vec4(gtx_to_srgb(color.rgb), color.a);

    zw = vec2(dot(gtx_clip_z, vec4(hit.grid, 1.0)), dot(gtx_clip_w, vec4(hit.grid, 1.0)));
    gl_FragDepth = clamp(zw.x / zw.y, -gtx_depth.x, 1.0) * gtx_depth.y + gtx_depth.z;
}
