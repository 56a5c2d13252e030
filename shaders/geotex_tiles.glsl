/* gtx_find by tiles: a pixel walks the slabs over its tile of 4 x 4 pixels nearest first and keeps
 * the nearest hit, so that nothing behind it is cast. The mains find the surface as if a proxy had
 * been drawn.
 *
 * t is the same along the rays of all patches: w of clip space, or for an orthographic camera how
 * far behind the plane that rays begin on. Pixels count from the viewport's corner. Follows
 * geotex_cast.glsl and geotex_fragment.glsl, with GTX_TILES. */
GTX_VARYING(0) in vec2 gtx_pixel;

/* Records of patches and of slabs (geotex_records.glsl). Then heads of a rectangle of tiles, two a
 * texel: where the list begins and ends, in half texels. Then the lists, two slabs a texel: where
 * the slab is, least t. */
GTX_SAMPLER(9, highp usamplerBuffer) gtx_stream;
#define gtx_place(i) gtx_flat[3 + i]

struct gtx_line {
    vec3 origin, direction;
};

/* The ray through a point of the viewport, from rows of gtx_place taken to some space. */
gtx_line gtx_line_of(vec2 pixel, vec3 origin, vec3 direction, vec3 x, vec3 y)
{
    vec3 aside = x * pixel.x + y * pixel.y;
    return gtx_line(origin + (1.0 - gtx_depth.w) * aside, direction + gtx_depth.w * aside);
}

/* z and w of the clip position at t = 0, and what t adds. */
void gtx_clip_along(vec2 pixel, out vec2 zw, out vec2 zw_step)
{
    vec4 z = gtx_place(GTX_PLACE_CLIP_Z);
    float aside = dot(z.yz, pixel);
    zw = vec2(z.x + (1.0 - gtx_depth.w) * aside, gtx_place(GTX_PLACE_CLIP_W).x);
    zw_step = vec2(z.w + gtx_depth.w * aside, gtx_place(GTX_PLACE_CLIP_W).y);
}

gtx_height_field gtx_unpacked(uint corner, uint size, uint page)
{
    return gtx_field_of(vec4(uvec4(corner & 0xffffu, corner >> 16, size & 0xffffu, size >> 16)),
                        vec4(0.0, 0.0, float(page & ((1u << GTX_TILE_LEVEL_SHIFT) - 1u)),
                             float(page >> GTX_TILE_TWO_SIDED_SHIFT)),
                        int(page >> GTX_TILE_LEVEL_SHIFT & 127u));
}

/* Where the ray of a pixel is in a slab, as x to y: of 1 / t when the camera is perspective, for
 * that is linear in the pixel on each plane, and else of t. Of a pair of planes one is a multiple
 * of the other, negative when the eye is between them; or it is a constant behind. */
vec2 gtx_meets(int slab, vec2 pixel, vec2 range)
{
    vec4 x = uintBitsToFloat(texelFetch(gtx_stream, slab + GTX_TILE_SLAB_PLANES));
    vec4 y = uintBitsToFloat(texelFetch(gtx_stream, slab + GTX_TILE_SLAB_PLANES + 1));
    vec4 z = uintBitsToFloat(texelFetch(gtx_stream, slab + GTX_TILE_SLAB_PLANES + 2));
    vec3 u = vec3(x.x, y.x, z.x) * pixel.x + vec3(x.y, y.y, z.y) * pixel.y + vec3(x.z, y.z, z.z);
    vec3 other = vec3(x.w, y.w, z.w);
    bool perspective = gtx_depth.w > 0.0;
    vec3 v = perspective ? u * other : u + other;
    bvec3 between = lessThan(perspective ? other : vec3(1.0), vec3(0.0));
    vec3 low = mix(u, max(u, v), between), high = mix(v, vec3(1e30), between);
    return vec2(max(max(low.x, low.y), max(low.z, range.x)),
                min(min(high.x, high.y), min(high.z, range.y)));
}

/* From t to what gtx_meets has, and back. */
vec2 gtx_inverse(vec2 range)
{
    return gtx_depth.w > 0.0 ? 1.0 / max(range.yx, 1e-30) : range;
}

/* Casts at the cells of a slab, from and to these t; tells where its patch's texels are, and the
 * ray's direction in its grid space. */
bool gtx_cast_slab(int slab, vec2 pixel, vec2 t, out gtx_hit hit, out int patch_at, out vec3 ray)
{
    uvec4 cells = texelFetch(gtx_stream, slab + GTX_TILE_SLAB_CELLS);
    patch_at = int(cells.z);
    int rays_at = patch_at + GTX_TILE_PATCH_RAYS;
    uvec4 origin = texelFetch(gtx_stream, rays_at);
    uvec4 direction = texelFetch(gtx_stream, rays_at + 1);
    uvec4 x = texelFetch(gtx_stream, rays_at + 2), y = texelFetch(gtx_stream, rays_at + 3);
    gtx_line line = gtx_line_of(pixel, uintBitsToFloat(origin.xyz), uintBitsToFloat(direction.xyz),
                                uintBitsToFloat(x.xyz), uintBitsToFloat(y.xyz));
    gtx_height_field field = gtx_unpacked(origin.w, direction.w, x.w);
    field.first = ivec2(cells.x & 0xffffu, cells.x >> 16);
    field.last = ivec2(cells.y & 0xffffu, cells.y >> 16);
    ray = line.direction;
    return gtx_cast(field, line.origin, line.direction, t.x, t.y, hit);
}

/* The half of the stream at k, of which a texel has two. */
uvec2 gtx_half(int k)
{
    uvec4 both = texelFetch(gtx_stream, k >> 1);
    return (k & 1) != 0 ? both.zw : both.xy;
}

/* The next slab of a list, from the one at k on, that the ray meets within a range of t, and where
 * the ray is in it; 0 when there is none, for records come first. */
int gtx_next_slab(vec2 pixel, vec2 range, int end, inout int k, out vec2 within)
{
    vec2 inverse = gtx_inverse(range), meeting = vec2(1.0, 0.0);
    int slab = 0, stop = end;
    do {
        uvec2 entry = gtx_half(k);
        vec2 met = gtx_meets(int(entry.x), pixel, inverse);
        bool look = k < stop, meets = look && met.x <= met.y;
        GTX_LOOK(y, look);
        if (meets) {
            slab = int(entry.x);
            meeting = met;
        }
        if (look)
            k = uintBitsToFloat(entry.y) > range.y ? end : k + 1;
        stop = meets ? k : stop;
    } while (k < stop);
    /* A little farther than the slab, for rounding. */
    within = gtx_inverse(meeting);
    within += vec2(-2e-6, 2e-6) * abs(within);
    within.y = slab > 0 ? min(within.y, range.y) : within.x - 1.0;
    return slab;
}

/* The camera's side of a hit, and the instance's. */
void gtx_place_hit(vec2 pixel, vec2 zw)
{
    mat4x3 world = transpose(mat3x4(gtx_place(GTX_PLACE_WORLD), gtx_place(GTX_PLACE_WORLD + 1),
                                       gtx_place(GTX_PLACE_WORLD + 2)));
    gtx_line line = gtx_line_of(pixel, gtx_place(GTX_PLACE_ORIGIN).xyz,
                                gtx_place(GTX_PLACE_DIRECTION).xyz, gtx_place(GTX_PLACE_X).xyz,
                                gtx_place(GTX_PLACE_Y).xyz);
    gtx_clip_z = vec4(0.0, 0.0, 0.0, zw.x);
    gtx_clip_w = vec4(0.0, 0.0, 0.0, zw.y);
    gtx_world = world * vec4(line.origin, 1.0);
    gtx_world_eye = gtx_world * gtx_depth.w - world * vec4(line.direction, 0.0);
}

bool gtx_find(out gtx_surface s)
{
    vec2 pixel = floor(gtx_pixel) + 0.5, zw, zw_step, range = vec2(-1e30, 1e30);
    gtx_clip_along(pixel, zw, zw_step);
    gtx_clip(zw.x + gtx_depth.x * zw.y, zw_step.x + gtx_depth.x * zw_step.y, range.x, range.y);
    gtx_clip(zw.y - zw.x, zw_step.y - zw_step.x, range.x, range.y);

    ivec2 tile = (ivec2(pixel) >> 2) -
                 ivec2(gtx_place(GTX_PLACE_FIRST_COLUMN).w, gtx_place(GTX_PLACE_FIRST_ROW).w);
    uvec2 head = gtx_half(2 * int(gtx_place(GTX_PLACE_HEADS).w) +
                          tile.y * int(gtx_place(GTX_PLACE_COLUMNS).w) + tile.x);
    int k = int(head.x), end = int(head.y), patch_at = -1;
    if (k == end)
        return false;
    s.hit.t = 1e30;
    vec2 within;
    int slab = gtx_next_slab(pixel, range, end, k, within);
    do {
        gtx_hit hit;
        int at;
        vec3 ray;
        if (gtx_cast_slab(slab, pixel, within, hit, at, ray) && slab > 0) {
            range.y = hit.t;
            patch_at = at;
            s.ray = ray;
            s.hit = hit;
        }
        slab = gtx_next_slab(pixel, range, end, k, within);
    } while (slab > 0);
    if (patch_at < 0)
        return false;
    zw += s.hit.t * zw_step;
    gtx_place_hit(pixel, zw);
    int normals_at = patch_at + GTX_TILE_PATCH_NORMALS;
    uvec4 x = texelFetch(gtx_stream, normals_at), y = texelFetch(gtx_stream, normals_at + 1);
    uvec4 z = texelFetch(gtx_stream, normals_at + 2);
    uvec4 rest = texelFetch(gtx_stream, patch_at + GTX_TILE_PATCH_INDEX); /* and more */
    gtx_normal_x = uintBitsToFloat(x.xyz);
    gtx_normal_y = uintBitsToFloat(y.xyz);
    gtx_normal_z = uintBitsToFloat(z.xyz);
    s.field = gtx_unpacked(x.w, y.w, z.w);
    gtx_patch_index = int(rest.x);
    s.frame = gtx_frame_of(gtx_patch_index);
    /* As gtx_level_of, with the steps from pixel to pixel at the hit. */
    float widen = gtx_depth.w > 0.0 ? s.hit.t : 1.0;
    float descent = abs(dot(vec3(-s.hit.slope, 1.0), s.ray));
    float area = widen * widen * uintBitsToFloat(rest.y) / max(descent, 1e-20);
    s.level = 0.5 * log2(max(area, 1e-20));
    uint byte = uint(clamp(floor(min(s.level, gtx_maps.x) + 0.5), 0.0, 7.0)) + 3u;
    uint code = (byte < 8u ? rest.z : rest.w) >> (8u * (byte & 3u)) & 255u;
    s.deviation = byte > 3u ? float(code) / 510.0 : 0.0;
    s.deviation = max(s.deviation, GTX_LEAST_DEVIATION);
    return true;
}
