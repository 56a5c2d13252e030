/* Tiles over which an instance may be. Needs geotex_records.glsl and
 * geotex_view.glsl before it. */
uniform vec4 gtx_place[GTX_PLACE_ROWS];
uniform vec4 gtx_tint;

layout(location = 0) in vec2 gtx_corner;  /* pixels */

GTX_VARYING(0) out vec2 gtx_pixel;
GTX_VARYING(1) flat out vec4 gtx_color;   /* where no map gives colours, the 2.4th root of rgb */
GTX_VARYING(2) flat out vec4 gtx_flat[3 + GTX_PLACE_ROWS]; /* as in geotex_fragment.glsl */

void main()
{
    gtx_pixel = gtx_corner;
    gtx_color = gtx_tint;
#ifdef GTX_PLAIN
    gtx_color.rgb = pow(max(gtx_tint.rgb, 0.0), vec3(1.0 / 2.4));
#endif
    gtx_flat[0] = gtx_depth;
    gtx_flat[1] = gtx_light;
    gtx_flat[2] = gtx_maps;
    for (int i = 0; i < GTX_PLACE_ROWS; ++i)
        gtx_flat[3 + i] = gtx_place[i];
    gl_Position = vec4(gtx_corner / gtx_place[GTX_PLACE_VIEWPORT].zw * 2.0 - 1.0, 0.5, 1.0);
}
