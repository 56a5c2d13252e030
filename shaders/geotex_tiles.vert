/* Tiles over which an instance may be. Needs geotex_dialect.glsl, geotex_sheet.glsl and
 * geotex_view.glsl before it. */
uniform vec4 gtx_place[10];               /* as in geotex_tiles.glsl */

layout(location = 0) in vec2 gtx_corner;  /* pixels */

GTX_VARYING(0) out vec2 gtx_pixel;

void main()
{
    gtx_pixel = gtx_corner;
    gl_Position = vec4(gtx_corner / gtx_place[6].zw * 2.0 - 1.0, 0.5, 1.0);
}
