/* gtx_find for what was cast by tiles: the stock mains draw it as if they had cast it themselves.
 *
 * Follows geotex_tiles.glsl and geotex_fragment.glsl, with GTX_TILES. */
GTX_VARYING(0) in vec2 gtx_pixel;

GTX_SAMPLER(7, highp usampler2D) gtx_seen;  /* as geotex_tiles.comp writes it */
uniform vec4 gtx_tint;
uniform uint gtx_instance;

vec3 gtx_to_grid(int index, vec4 object)
{
    return vec3(dot(gtx_record(index, 0), object), dot(gtx_record(index, 1), object),
                dot(gtx_record(index, 2), object));
}

/* The hit's slope, as the cell has it. */
vec2 gtx_slope_at(gtx_sheet sheet, vec2 at)
{
    ivec2 cell = clamp(ivec2(floor(at)) >> sheet.level, sheet.first, sheet.last);
    vec2 width = vec2(min((cell + 1) << sheet.level, sheet.size - 1) - (cell << sheet.level));
    vec2 within = clamp((at - vec2(cell << sheet.level)) / width, 0.0, 1.0);
    vec4 h = vec4(texelFetch(gtx_cells, ivec3(sheet.cells + cell, sheet.page), 0));
    return (vec2(h.y - h.x, h.z - h.x) + (h.x - h.y - h.z + h.w) * within.yx) / width;
}

/* The camera's side of it, and the instance's. */
void gtx_place_ray(vec2 pixel, float t)
{
    mat4x3 world = transpose(mat3x4(gtx_place[9], gtx_place[10], gtx_place[11]));
    gtx_line line = gtx_line_of(pixel, gtx_place[3].xyz, gtx_place[4].xyz, gtx_place[5].xyz,
                                gtx_place[6].xyz);
    vec2 zw, zw_step;
    gtx_clip_along(pixel, zw, zw_step);
    zw += t * zw_step;
    gtx_clip_z = vec4(0.0, 0.0, 0.0, zw.x);
    gtx_clip_w = vec4(0.0, 0.0, 0.0, zw.y);
    gtx_world = world * vec4(line.origin, 1.0);
    gtx_world_eye = gtx_world * gtx_depth.w - world * vec4(line.direction, 0.0);
    gtx_color = gtx_tint;
#ifdef GTX_PLAIN
    gtx_color.rgb = pow(max(gtx_tint.rgb, 0.0), vec3(1.0 / 2.4));
#endif
    gtx_id = gtx_instance;
}

bool gtx_find(out gtx_surface s)
{
    uvec4 seen = texelFetch(gtx_seen, ivec2(gtx_pixel), 0);
    if (seen.x == 0u)
        return false;
    int index = int(seen.x & 0xffffffu);
    float t = uintBitsToFloat(seen.y);
    vec2 pixel = floor(gtx_pixel) + 0.5;
    gtx_patch_index = index;
    gtx_place_ray(pixel, t);
    s.sheet = gtx_sheet_of(index, int(seen.x >> 24 & 15u));
    s.frame = gtx_frame_of(index);
    vec3 x = gtx_to_grid(index, vec4(gtx_place[4].xyz, 0.0));
    vec3 y = gtx_to_grid(index, vec4(gtx_place[5].xyz, 0.0));
    gtx_line line = gtx_line_of(pixel, gtx_to_grid(index, vec4(gtx_place[3].xyz, 1.0)), x, y,
                                gtx_to_grid(index, vec4(gtx_place[6].xyz, 0.0)));
    s.ray = line.direction;
    s.hit.t = t;
    s.hit.grid = vec3(uintBitsToFloat(seen.zw), line.origin.z + t * line.direction.z);
    s.hit.slope = gtx_slope_at(s.sheet, s.hit.grid.xy);
    s.hit.level = s.sheet.level;
    s.hit.back = (seen.x >> 28 & 1u) != 0u;
    float widen = gtx_depth.w > 0.0 ? t : 1.0;
    s.level = gtx_level_of(s.hit, s.ray, x * widen, y * widen);

    /* n_world = transpose(inverse) n: the inverse's rows are the columns. */
    mat3 normals = mat3(gtx_place[0].xyz, gtx_place[1].xyz, gtx_place[2].xyz);
    mat3 axes = gtx_normal_frame(s.frame);
    gtx_normal_x = normals * axes[0];
    gtx_normal_y = normals * axes[1];
    gtx_normal_z = normals * axes[2];
    return true;
}
