/* Casting by tiles: a workgroup has a tile of 8 x 8 pixels, an invocation a pixel, which walks the
 * slabs over its tile nearest first and keeps the nearest hit, so that nothing behind it is cast.
 *
 * Needs geotex_dialect.glsl, geotex_sheet.glsl, geotex_view.glsl, geotex_tiles.glsl and
 * geotex_cast.glsl before it. */
layout(local_size_x = 64) in;

/* 2^31 + 2^28 * back + 2^24 * level + patch, t, x, y; or 0 */
layout(rgba32ui, binding = 0) uniform writeonly highp uimage2D gtx_found;
/* For each tile x, y, first, end; then the slabs of all: slab, patch, least t. */
uniform highp usamplerBuffer gtx_lists;
/* 3 texels a slab, as in lib/derive/derive.h. */
uniform highp samplerBuffer gtx_slabs;
/* 5 texels a patch: columns to grid space of gtx_place[3], [6], [4], [5], and the rectangle; w of the
 * first three: level, page, two-sided. */
uniform highp samplerBuffer gtx_tile_rays;

struct gtx_candidate {
    int patch_index;
    gtx_line line;            /* in grid space */
    float level, page, two_sided;
    vec4 block;
    float t0, t1;
};

/* Whether the ray passes the slab of a list's entry before `best`. */
bool gtx_meets(uvec3 entry, vec2 pixel, vec2 range, float best, out gtx_candidate c)
{
    int slab = int(entry.x) * 3, rays = int(entry.y) * 5;
    c.block = texelFetch(gtx_slabs, slab);
    vec4 lid = texelFetch(gtx_slabs, slab + 1);
    vec4 origin = texelFetch(gtx_tile_rays, rays), direction = texelFetch(gtx_tile_rays, rays + 1);
    vec4 x = texelFetch(gtx_tile_rays, rays + 2);
    c.patch_index = int(entry.y);
    c.level = origin.w;
    c.page = direction.w;
    c.two_sided = x.w;
    c.line = gtx_line_of(pixel, origin.xyz, x.xyz, texelFetch(gtx_tile_rays, rays + 3).xyz,
                         direction.xyz);
    vec3 o = c.line.origin, d = c.line.direction;
    o.z -= dot(lid.xy, o.xy);
    d.z -= dot(lid.xy, d.xy);
    vec3 inverse = 1.0 / mix(d, vec3(1e-20), vec3(lessThan(abs(d), vec3(1e-20))));
    vec3 a = (vec3(c.block.xy, lid.z) - o) * inverse, b = (vec3(c.block.zw, lid.w) - o) * inverse;
    vec3 enter = min(a, b), leave = max(a, b);
    c.t0 = max(max(range.x, enter.x), max(enter.y, enter.z));
    c.t1 = min(min(min(range.y, best), leave.x), min(leave.y, leave.z));
    return c.t0 <= c.t1;
}

bool gtx_cast_slab(gtx_candidate c, out gtx_hit hit)
{
    gtx_sheet sheet = gtx_sheet_of(texelFetch(gtx_tile_rays, c.patch_index * 5 + 4),
                                   vec4(0.0, 0.0, c.page, c.two_sided), int(c.level));
    sheet.first = ivec2(c.block.xy + 0.5) >> sheet.level;
    sheet.last = (ivec2(c.block.zw + 0.5) - 1) >> sheet.level;
    return gtx_cast(sheet, c.line.origin, c.line.direction, c.t0, c.t1, hit);
}

void main()
{
    uvec4 tile = texelFetch(gtx_lists, int(gl_WorkGroupID.x));
    /* Four by two pixels side by side in a wide processor: their rays stay together. */
    int lane = int(gl_LocalInvocationIndex);
    ivec2 pixel = ivec2(tile.xy) * 8 +
                  ivec2(lane >> 1 & 4 | lane & 3, lane >> 3 & 6 | lane >> 2 & 1);
    vec2 at = vec2(pixel) + 0.5, zw, zw_step;
    gtx_clip_along(at, zw, zw_step);
    vec2 range = vec2(-1e30, 1e30);
    gtx_clip(zw.x + gtx_depth.x * zw.y, zw_step.x + gtx_depth.x * zw_step.y, range.x, range.y);
    gtx_clip(zw.y - zw.x, zw_step.y - zw_step.x, range.x, range.y);

    float best = 1e30;
    uvec4 seen = uvec4(0u);
    int k = int(tile.z), end = int(tile.w);
    while (k < end) {
        /* All rays of a processor look for a slab, and then all cast. */
        gtx_candidate c;
        bool meets = false;
        while (k < end && !meets) {
            uvec3 entry = texelFetch(gtx_lists, k).xyz;
            k = uintBitsToFloat(entry.z) > best ? end : k + 1;
            meets = gtx_meets(entry, at, range, best, c);
        }
        gtx_hit hit;
        c.t1 = meets ? c.t1 : c.t0 - 1.0;
        if (meets && gtx_cast_slab(c, hit)) {
            best = hit.t;
            seen = uvec4(uint(c.patch_index) | uint(c.level) << 24 | (hit.back ? 9u : 8u) << 28,
                         floatBitsToUint(hit.t), floatBitsToUint(hit.grid.x),
                         floatBitsToUint(hit.grid.y));
        }
    }
    imageStore(gtx_found, pixel, seen);
}
