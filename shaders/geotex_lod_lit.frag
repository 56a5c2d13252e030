/* The stock forward main of LOD meshes that are lit at their vertices, on both sides, by
 * geotex_lod.vert with GTX_LIT defined: no map is looked up, a pixel costs next to nothing. */
GTX_VARYING(0) in vec4 gtx_lit;
GTX_VARYING(1) in vec3 gtx_behind;

layout(location = 0) out vec4 gtx_out_color;

void main()
{
    gtx_out_color = vec4(gl_FrontFacing ? gtx_lit.rgb : gtx_behind, gtx_lit.a);
}
