/* The stock picking main: what each pixel shows. Follows geotex_fragment.glsl. */
layout(location = 0) out highp uvec4 gtx_out_id; /* instance's id, patch, cell of the patch: x, y */

void main()
{
    gtx_surface s;
    if (!gtx_find(s))
        discard;
    ivec2 cell = clamp(ivec2(floor(s.hit.grid.xy)), ivec2(0), s.field.size - 2);
    gtx_out_id = uvec4(gtx_id, gtx_patch_index, cell);
    gtx_write_depth(s);
}
