/* The stock main of depth alone, for shadow maps and prepasses. Follows geotex_fragment.glsl. */
void main()
{
    gtx_surface s;
    if (!gtx_find(s))
        discard;
    gtx_write_depth(s);
}
