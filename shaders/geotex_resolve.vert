/* The tiles that were cast, to be brought into the framebuffer. Needs geotex_dialect.glsl,
 * geotex_sheet.glsl, geotex_view.glsl and geotex_tiles.glsl before it. */
layout(location = 0) in vec2 gtx_corner;  /* pixels */

GTX_VARYING(0) out vec2 gtx_pixel;

void main()
{
    gtx_pixel = gtx_corner;
    gl_Position = vec4(gtx_corner / gtx_place[8].zw * 2.0 - 1.0, 0.5, 1.0);
}
