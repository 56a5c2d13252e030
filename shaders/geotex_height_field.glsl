/* A patch as shaders see it: its record, its cells and its outline. Needs geotex_dialect.glsl and
 * geotex_records.glsl before it.
 *
 * Grid space of a patch: x and y in texels (texel i at x = i), z in height codes. Cell (i, j) spans
 * texels i..i+1, j..j+1, and exists where its four codes are not zero; inside it the height field
 * is the bilinear patch through them (format/gtx.md, section 4.1). At level k cell (i, j) spans 2^k
 * texels from texel 2^k i, 2^k j on, the last ones of a row or column a texel less (section 5);
 * grid space is the same at all levels. */
GTX_SAMPLER(0, highp usampler2DArray) gtx_cells;  /* codes: of level 0 the texels'; of the coarser
                                                     levels each cell has 2 x 2 of its own. All in
                                                     one level: lookups by level cost more */
GTX_SAMPLER(1, highp sampler2DArray) gtx_trim;    /* distance to the outline, as stored */
GTX_SAMPLER(4, highp sampler2D) gtx_patches;      /* records and slabs: geotex_records.glsl */

/* With GTX_COUNT defined fragments count what they look at: x cells, y slabs. */
#ifdef GTX_COUNT
vec2 gtx_looked = vec2(0.0);
#define GTX_LOOK(at, when) gtx_looked.at += float(when)
#else
#define GTX_LOOK(at, when)
#endif

/* What casting needs of a patch. */
struct gtx_height_field {
    ivec2 corner;                         /* of the rectangle in its page */
    ivec2 cells;                          /* where the level's codes begin there */
    int step;                             /* from a cell's to the next one's */
    ivec2 size;                           /* of the rectangle, in texels */
    ivec2 first, last;                    /* cells to look at */
    int page;
    int level;                            /* of detail */
    bool two_sided;                       /* crossings from below count too */
    vec3 low, high;                       /* box of the cells, in grid space */
    float reach;                          /* a ray farther above the height field than so has left
                                             the proxy, or below it */
};

/* object = origin + axis_x * grid.x + axis_y * grid.y + axis_z * grid.z */
struct gtx_frame {
    vec3 origin, axis_x, axis_y, axis_z;
};

/* Where a ray meets the height field. */
struct gtx_hit {
    float t;      /* along the ray that was cast */
    vec3 grid;    /* the point in grid space; grid.xy are its texel coordinates */
    vec2 slope;   /* dz/dx and dz/dy of the height field there, in codes a texel */
    int level;    /* of detail, at which the height field was cast */
    bool back;    /* the height field was crossed from below */
};

vec4 gtx_patches_texel(int at)
{
    return texelFetch(gtx_patches, ivec2(at & ((1 << GTX_PATCHES_ROW_BITS) - 1),
                                         at >> GTX_PATCHES_ROW_BITS), 0);
}

vec4 gtx_record(int patch_index, int texel)
{
    return gtx_patches_texel(patch_index * GTX_RECORD_TEXELS + texel);
}

gtx_frame gtx_frame_of(int patch_index)
{
    return gtx_frame(gtx_record(patch_index, GTX_RECORD_ORIGIN).xyz,
                     gtx_record(patch_index, GTX_RECORD_AXIS_X).xyz,
                     gtx_record(patch_index, GTX_RECORD_AXIS_Y).xyz,
                     gtx_record(patch_index, GTX_RECORD_AXIS_Z).xyz);
}

/* From the rectangle (x, y, w, h) and (lowest z, highest z, page, two-sided), which are those of
 * all levels, for a ray from anywhere. */
gtx_height_field gtx_field_of(vec4 rect, vec4 span, int level)
{
    ivec2 page = textureSize(gtx_trim, 0).xy;
    int up = max(level - 1, 0);
    ivec2 from = ivec2(0);
    if (up > 0)
        from.x = page.x - (page.x >> (up - 1));
    if (page.y > GTX_HIGH_PAGE)
        from += level == 1 ? ivec2(page.x, 0) : ivec2(0, level > 0 ? page.y : 0);
    else
        from.y = page.y * min(level, 2);
    return gtx_height_field(ivec2(rect.xy), from + (ivec2(rect.xy) >> up), level > 0 ? 2 : 1,
                            ivec2(rect.zw), ivec2(0), (ivec2(rect.zw) - 2) >> level, int(span.z),
                            level, span.w > 0.0, vec3(0.0, 0.0, span.x),
                            vec3(rect.zw - 1.0, span.y), 1e30);
}

/* The codes of 2 x 2 texels from one on: (0,0) (1,0) (0,1) (1,1). A cell exists where none is 0. */
vec4 gtx_codes(ivec3 first)
{
#ifdef GTX_GATHER_CODES
    vec2 corner = (vec2(first.xy) + 1.0) / vec2(textureSize(gtx_cells, 0).xy);
    return vec4(textureGather(gtx_cells, vec3(corner, float(first.z))).wzxy);
#else
    return vec4(texelFetch(gtx_cells, first, 0).r,
                texelFetch(gtx_cells, first + ivec3(1, 0, 0), 0).r,
                texelFetch(gtx_cells, first + ivec3(0, 1, 0), 0).r,
                texelFetch(gtx_cells, first + ivec3(1, 1, 0), 0).r);
#endif
}

bool gtx_exists(vec4 codes)
{
    return min(min(codes.x, codes.y), min(codes.z, codes.w)) > 0.0;
}

/* Lowest z, highest z, page and two-sided of a record. */
vec4 gtx_span_of(int patch_index)
{
    return vec4(gtx_record(patch_index, GTX_RECORD_LOW_Z).w,
                gtx_record(patch_index, GTX_RECORD_HIGH_Z).w,
                gtx_record(patch_index, GTX_RECORD_PAGE).w,
                gtx_record(patch_index, GTX_RECORD_TWO_SIDED).w);
}

/* A point or, with w = 0, a direction of object space, taken to the patch's grid space. */
vec3 gtx_to_grid(int patch_index, vec4 object)
{
    return vec3(dot(gtx_record(patch_index, GTX_RECORD_TO_GRID), object),
                dot(gtx_record(patch_index, GTX_RECORD_TO_GRID + 1), object),
                dot(gtx_record(patch_index, GTX_RECORD_TO_GRID + 2), object));
}

/* The same straight from the record. The level is below the model's number of mip levels. */
gtx_height_field gtx_field_of(int patch_index, int level)
{
    return gtx_field_of(gtx_record(patch_index, GTX_RECORD_RECT), gtx_span_of(patch_index), level);
}

/* How far a patch's normals stray from those that a lookup at a mip level gives: the standard
 * deviation along an axis across, as lib/frame/deviation.c measures it. */
float gtx_deviation_of(int patch_index, float level)
{
    int k = clamp(int(floor(level + 0.5)), 0, 7);
    return gtx_record(patch_index, GTX_RECORD_DEVIATION + k / 4)[k % 4];
}

/* Object-space position of a grid-space point. */
vec3 gtx_object_point(gtx_frame frame, vec3 grid)
{
    return frame.origin + frame.axis_x * grid.x + frame.axis_y * grid.y + frame.axis_z * grid.z;
}

/* Object-space normal of the height field itself at a hit, on the side of axis_z; not normalised.
 * Normals go by the cofactors of the frame. */
vec3 gtx_facet(gtx_frame frame, gtx_hit hit)
{
    return cross(frame.axis_x, frame.axis_y) - hit.slope.x * cross(frame.axis_y, frame.axis_z) -
           hit.slope.y * cross(frame.axis_z, frame.axis_x);
}

/* The greatest trim code that shows at a level of detail (format/gtx.md, section 4.2). */
float gtx_trim_limit(int level)
{
    return float(GTX_TRIM_OUTLINE) + float(GTX_TRIM_TEXEL) * GTX_TRIM_SHOWN * float(1 << level);
}

/* The trim's code at a point of a rectangle, which it is clamped to. */
float gtx_trim_at(ivec2 corner, ivec2 size, int page, vec2 at)
{
    ivec2 cell = clamp(ivec2(floor(at)), ivec2(0), size - 2);
#ifdef GTX_GATHER
    vec4 g = textureGather(gtx_trim, vec3((vec2(corner + cell) + 1.0) /
                                          vec2(textureSize(gtx_trim, 0).xy), float(page)));
    float a = g.w, b = g.z, c = g.x, d = g.y;
#else
    ivec3 texel = ivec3(corner + cell, page);
    float a = texelFetch(gtx_trim, texel, 0).r;
    float b = texelFetch(gtx_trim, texel + ivec3(1, 0, 0), 0).r;
    float c = texelFetch(gtx_trim, texel + ivec3(0, 1, 0), 0).r;
    float d = texelFetch(gtx_trim, texel + ivec3(1, 1, 0), 0).r;
#endif
    vec2 f = clamp(at - vec2(cell), 0.0, 1.0);
    return mix(mix(a, b, f.x), mix(c, d, f.x), f.y) * 255.0;
}

/* Whether the height field shows at a point: it may lie a little outside the outline. */
bool gtx_shows(gtx_height_field field, vec2 at)
{
    return gtx_trim_at(field.corner, field.size, field.page, at) <= gtx_trim_limit(field.level);
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

/* Shortens [t0, t1] to the height field's box. */
void gtx_clip_box(gtx_height_field field, vec3 origin, vec3 direction, inout float t0,
                  inout float t1)
{
    vec3 steady = mix(direction, vec3(1e-30), vec3(lessThan(abs(direction), vec3(1e-30))));
    vec3 a = (field.low - origin) / steady, b = (field.high - origin) / steady;
    vec3 enter = min(a, b), leave = max(a, b);
    t0 = max(max(t0, enter.x), max(enter.y, enter.z));
    t1 = min(min(t1, leave.x), min(leave.y, leave.z));
}

/* Height of the ray above a cell's bilinear patch as x + y s + z s^2, with s the way from `entry`,
 * which is relative to the cell's corner. */
vec3 gtx_gap(vec4 height, vec3 entry, vec3 direction)
{
    float hx = height.y - height.x, hy = height.z - height.x;
    float hxy = height.x - height.y - height.z + height.w;
    return vec3(entry.z - (height.x + hx * entry.x + (hy + hxy * entry.x) * entry.y),
                direction.z - (hx * direction.x + hy * direction.y +
                               hxy * (entry.x * direction.y + entry.y * direction.x)),
                -hxy * direction.x * direction.y);
}

/* The root where the gap falls (x) and the one where it rises (y), each by the form that does not
 * cancel. A root that does not exist comes out far away. */
vec2 gtx_roots(vec3 gap)
{
    const float tiny = 1e-30;
    float side = gap.y < 0.0 ? 1.0 : -1.0;
    float r = sqrt(max(gap.y * gap.y - 4.0 * gap.z * gap.x, 0.0)) + abs(gap.y);
    float stable = 2.0 * side * gap.x / max(r, tiny);
    float other = 0.5 * side * r / (abs(gap.z) < tiny ? tiny : gap.z);
    return gap.y < 0.0 ? vec2(stable, other) : vec2(other, stable);
}
