/* The stock forward main of displaced grids that are lit at their vertices, by geotex_lod.vert with
 * GTX_LIT defined. With GTX_TRIMMED it needs geotex_surface.glsl and what that needs before it. */
GTX_VARYING(0) in vec4 gtx_lit;

layout(location = 0) out vec4 gtx_out_color;

void main()
{
#ifdef GTX_TRIMMED
    if (!gtx_is_shown())
        discard;
#endif
    gtx_out_color = gtx_lit;
}
