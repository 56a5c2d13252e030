/* The stock forward main of displaced grids that are lit at their vertices, by geotex_lod.vert with
 * GTX_LIT defined. With GTX_TRIMMED it needs geotex_height_field.glsl before it. */
GTX_VARYING(0) in vec4 gtx_lit;
#ifdef GTX_TRIMMED
GTX_VARYING(11) in float gtx_outline;
#endif

layout(location = 0) out vec4 gtx_out_color;

void main()
{
#ifdef GTX_TRIMMED
    if (gtx_outline > gtx_trim_limit(0))
        discard;
#endif
    gtx_out_color = gtx_lit;
}
