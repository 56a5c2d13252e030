/* A patch as shaders see it: its record, its cells and its outline.
 *
 * Grid space of a patch: x and y in texels (texel i at x = i), z in height codes. Cell (i, j) spans
 * texels i..i+1, j..j+1, and exists where its four codes are not zero; inside it the sheet is the
 * bilinear patch through them (format/gtx.md, section 4.1). */
GTX_SAMPLER(0, highp usampler2DArray) gtx_cells;  /* four codes a cell: (0,0) (1,0) (0,1) (1,1) */
GTX_SAMPLER(1, highp sampler2DArray) gtx_trim;    /* distance to the outline, as stored */
GTX_SAMPLER(4, highp sampler2D) gtx_patches;      /* 8 texels a patch, 256 patches a row */

struct gtx_sheet {
    vec3 origin, axis_x, axis_y, axis_z;  /* object = origin + mat3(axis_x, axis_y, axis_z) * grid */
    vec3 low, high;                       /* box of the cells, in grid space */
    ivec2 corner;                         /* of the rectangle in its page */
    ivec2 size;                           /* of the rectangle, in texels */
    int page;
    bool two_sided;                       /* crossings from below count too */
};

/* Where a ray meets the sheet. */
struct gtx_hit {
    float t;      /* along the ray that was cast */
    vec3 grid;    /* the point in grid space; grid.xy are its texel coordinates */
    vec2 slope;   /* dz/dx and dz/dy of the sheet there, in codes a texel */
    bool back;    /* the sheet was crossed from below */
};

vec4 gtx_record(int patch_index, int texel)
{
    return texelFetch(gtx_patches, ivec2((patch_index & 255) * 8 + texel, patch_index >> 8), 0);
}

gtx_sheet gtx_sheet_of(int patch_index)
{
    vec4 a = gtx_record(patch_index, 3), b = gtx_record(patch_index, 4);
    vec4 c = gtx_record(patch_index, 5), d = gtx_record(patch_index, 6);
    vec4 rect = gtx_record(patch_index, 7);
    gtx_sheet sheet;
    sheet.origin = a.xyz;
    sheet.axis_x = b.xyz;
    sheet.axis_y = c.xyz;
    sheet.axis_z = d.xyz;
    sheet.low = vec3(0.0, 0.0, a.w);
    sheet.high = vec3(rect.zw - 1.0, b.w);
    sheet.corner = ivec2(rect.xy);
    sheet.size = ivec2(rect.zw);
    sheet.page = int(c.w);
    sheet.two_sided = d.w > 0.0;
    return sheet;
}

/* Object-space position of a grid-space point. */
vec3 gtx_object_point(gtx_sheet sheet, vec3 grid)
{
    return sheet.origin + sheet.axis_x * grid.x + sheet.axis_y * grid.y + sheet.axis_z * grid.z;
}

/* Object-space normal of the sheet itself at a hit, on the side of axis_z; not normalised. Normals
 * go by the cofactors of the frame. */
vec3 gtx_facet(gtx_sheet sheet, gtx_hit hit)
{
    return cross(sheet.axis_x, sheet.axis_y) - hit.slope.x * cross(sheet.axis_y, sheet.axis_z) -
           hit.slope.y * cross(sheet.axis_z, sheet.axis_x);
}

/* Whether the sheet shows at a point of a cell: at most 0.3 texel outside its outline (section 4.2:
 * stored code 128 + 16 * 0.3). */
bool gtx_shows(gtx_sheet sheet, ivec2 cell, vec2 at)
{
    ivec3 texel = ivec3(sheet.corner + cell, sheet.page);
    float a = texelFetch(gtx_trim, texel, 0).r;
    float b = texelFetch(gtx_trim, texel + ivec3(1, 0, 0), 0).r;
    float c = texelFetch(gtx_trim, texel + ivec3(0, 1, 0), 0).r;
    float d = texelFetch(gtx_trim, texel + ivec3(1, 1, 0), 0).r;
    vec2 f = clamp(at - vec2(cell), 0.0, 1.0);
    return mix(mix(a, b, f.x), mix(c, d, f.x), f.y) * 255.0 <= 132.8;
}

/* Shortens [t0, t1] to where a + b t >= 0. */
void gtx_clip(float a, float b, inout float t0, inout float t1)
{
    if (b > 0.0)
        t0 = max(t0, -a / b);
    else if (b < 0.0)
        t1 = min(t1, -a / b);
    else if (a < 0.0)
        t1 = t0 - 1.0;
}

/* Shortens [t0, t1] to the sheet's box. */
void gtx_clip_box(gtx_sheet sheet, vec3 origin, vec3 direction, inout float t0, inout float t1)
{
    for (int i = 0; i < 3; ++i) {
        gtx_clip(origin[i] - sheet.low[i], direction[i], t0, t1);
        gtx_clip(sheet.high[i] - origin[i], -direction[i], t0, t1);
    }
}
