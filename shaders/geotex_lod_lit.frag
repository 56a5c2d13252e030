/* The stock forward main of LOD meshes that are lit at their vertices, on both sides, by
 * geotex_lod.vert with GTX_LIT defined: no map is looked up, a pixel costs next to nothing. With
 * GTX_OWN_VERTICES colours are an engine's own, of front faces alone. */
GTX_VARYING(0) in vec4 gtx_lit;
#ifndef GTX_OWN_VERTICES
GTX_VARYING(1) in vec3 gtx_behind;
#endif

layout(location = 0) out vec4 gtx_out_color;

void main()
{
#ifdef GTX_OWN_VERTICES
    gtx_out_color = gtx_lit;
#else
    gtx_out_color = vec4(gl_FrontFacing ? gtx_lit.rgb : gtx_behind, gtx_lit.a);
#endif
}
