/* Normal and colour of a hit. Needs geotex_height_field.glsl before it. */
GTX_SAMPLER(2, highp sampler2DArray) gtx_normals;  /* hemi-octahedral, two channels, mips */
GTX_SAMPLER(3, highp sampler2DArray) gtx_colors;   /* sRGB, mips; decoded when sampled */

/* The mip level whose texels have the area of the pixel at a hit. `dx` and `dy` are the steps of
 * the ray's point from pixel to pixel at the hit's t, in grid space: differentials of the ray, not
 * of the hit, so that they may be taken before any loop or branch. */
float gtx_level_of(gtx_hit hit, vec3 direction, vec3 dx, vec3 dy)
{
    /* Both steps slide along the ray onto the height field's tangent plane. The area that they span
     * in x and y is the triple product of them with the ray over the ray's rate of descent. */
    vec3 n = vec3(-hit.slope, 1.0);
    float area = abs(dot(cross(dx, dy), direction)) / max(abs(dot(n, direction)), 1e-20);
    return 0.5 * log2(max(area, 1e-20));
}

vec4 gtx_lookup_level(highp sampler2DArray map, gtx_height_field field, vec2 at, float level)
{
    /* In texels of level 0, where the size is known: some drivers answer textureSize for a level
     * that differs from pixel to pixel as if it did not. */
    float half_texel = 0.5 * exp2(level);
    vec2 low = vec2(field.corner) + half_texel;
    vec2 high = vec2(field.corner + field.size) - half_texel;
    vec2 texel = clamp(vec2(field.corner) + at + 0.5, low, high);
    return textureLod(map, vec3(texel / vec2(textureSize(map, 0).xy), float(field.page)), level);
}

/* At the nearest whole level, clamped there to the patch's own texels: patches are packed without a
 * gutter (section 4.7). */
vec4 gtx_lookup(highp sampler2DArray map, gtx_height_field field, vec2 at, float level, float last)
{
    return gtx_lookup_level(map, field, at, floor(clamp(level, 0.0, last) + 0.5));
}

/* The patch's normal frame in object space: the columns x', y', z' (section 4.3). */
mat3 gtx_normal_frame(gtx_frame frame)
{
    vec3 z = normalize(frame.axis_z);
    vec3 x = normalize(frame.axis_x - dot(frame.axis_x, z) * z);
    return mat3(x, cross(z, x), z);
}

vec3 gtx_to_srgb(vec3 c)
{
    c = clamp(c, 0.0, 1.0);
    return mix(1.055 * gtx_root(c) - 0.055, 12.92 * c, vec3(lessThan(c, vec3(0.0031308))));
}

#if defined(GTX_TRIMMED) && !defined(GTX_LIT)
/* Of a displaced grid: whether there is a cell and it shows. Varyings of geotex_lod.vert. */
GTX_VARYING(11) in vec2 gtx_texel;
GTX_VARYING(12) flat in uvec3 gtx_trimmed;

bool gtx_is_shown()
{
    uvec3 t = gtx_trimmed;
#ifdef GTX_BLOCKS
    vec4 rect = vec4(uvec4(t.x & 0xffffu, t.x >> 16, t.y & 0xffffu, t.y >> 16));
    gtx_height_field field =
        gtx_field_of(rect, vec4(0.0, 0.0, float(t.z & 0xffffu), 0.0), int(t.z >> 16));
#else
    gtx_height_field field;
    field.corner = ivec2(t.x & 0xffffu, t.x >> 16);
    field.size = ivec2(t.y & 0xffffu, t.y >> 16);
    field.page = int(t.z);
    field.cells = field.corner;
    field.step = 1;
    field.level = 0;
#endif
    if (any(greaterThan(gtx_texel, vec2(field.size) - 0.99))) /* triangles may stick out */
        return false;
    ivec2 cell = clamp(ivec2(floor(gtx_texel)), ivec2(0), field.size - 2);
    ivec2 codes = field.cells + field.step * (cell >> field.level);
    return gtx_exists(gtx_codes(ivec3(codes, field.page))) &&
           gtx_shows(field, gtx_texel);
}
#endif
