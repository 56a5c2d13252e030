/* Tiles over which an instance may be. Needs geotex_records.glsl and
 * geotex_view.glsl before it. */
GTX_BLOCK(10, gtx_tile_uniforms)
GTX_UNIFORM vec4 gtx_place[GTX_PLACE_ROWS];
GTX_UNIFORM vec4 gtx_tint;
GTX_UNIFORM uint gtx_instance;
GTX_BLOCK_END

#ifdef GTX_RHI
layout(location = 0) in uvec2 gtx_corner; /* pixels */
#else
layout(location = 0) in vec2 gtx_corner;
#endif

GTX_VARYING(0) out vec2 gtx_pixel;
GTX_VARYING(1) flat out vec4 gtx_color;   /* where no map gives colours, the 2.4th root of rgb */
GTX_VARYING(2) flat out vec4 gtx_flat[3 + GTX_PLACE_ROWS]; /* as in geotex_fragment.glsl */
GTX_VARYING(14) flat out uint gtx_id;

void main()
{
    gtx_pixel = vec2(gtx_corner);
    gtx_id = gtx_instance;
    gtx_color = gtx_tint;
#ifdef GTX_PLAIN
    gtx_color.rgb = pow(max(gtx_tint.rgb, 0.0), vec3(1.0 / 2.4));
#endif
    gtx_flat[0] = gtx_depth;
    gtx_flat[1] = gtx_light;
    gtx_flat[2] = gtx_maps;
    for (int i = 0; i < GTX_PLACE_ROWS; ++i)
        gtx_flat[3 + i] = gtx_place[i];
    gl_Position = vec4(gtx_pixel / gtx_place[GTX_PLACE_VIEWPORT].zw * 2.0 - 1.0, 0.5, 1.0);
}
