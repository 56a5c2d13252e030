/* Points over the tiles that an instance may cover, four a point: along the diagonal between two
 * triangles processors would cast twice. Needs geotex_dialect.glsl, geotex_sheet.glsl and
 * geotex_view.glsl before it. */
uniform vec4 gtx_place[10];               /* as in geotex_tiles.glsl */

uniform vec4 gtx_tint;

layout(location = 0) in vec2 gtx_centre;  /* pixels */

GTX_VARYING(1) flat out vec4 gtx_color;   /* where no map gives colours, the 2.4th root of rgb */

void main()
{
    gtx_color = gtx_tint;
#ifdef GTX_PLAIN
    gtx_color.rgb = pow(max(gtx_tint.rgb, 0.0), vec3(1.0 / 2.4));
#endif
    gl_PointSize = 8.0;
    gl_Position = vec4(gtx_centre / gtx_place[6].zw * 2.0 - 1.0, 0.5, 1.0);
}
