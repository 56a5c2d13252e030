/* Rays among all patches of all instances of a set: shadows and ambient occlusion, in any shader of
 * geotex or of the engine. Needs geotex_height_field.glsl before it; gtx_shading_create puts it
 * before an engine's own main, gtx_rays_bind gives a program its textures. Without them nothing
 * occludes.
 *
 *   bool gtx_occluded(origin, direction, t_max)              any crossing at 0 <= t <= t_max
 *   float gtx_sunlight(point, normal, light, spread, rays, turn)
 *   float gtx_skylight(point, normal, reach, rays, turn)
 *
 * in world space. Crossings count as for the picture: from above, and from below where a patch is
 * two-sided. The walk needs no stack: nodes lie depth first, each with the one behind its
 * subtree. */
GTX_SAMPLER(13, highp sampler2D) gtx_ray_nodes;        /* texels are counted through rows */
GTX_SAMPLER(14, highp usampler2DArray) gtx_ray_cells;  /* as gtx_cells; through layers */
GTX_SAMPLER(15, highp sampler2DArray) gtx_ray_trim;

const int gtx_ray_row = (1 << GTX_RAY_ROW_BITS) - 1;
const int gtx_ray_layer = (1 << GTX_RAY_LAYER_BITS) - 1;

vec4 gtx_ray_texel(int at)
{
    return texelFetch(gtx_ray_nodes, ivec2(at & gtx_ray_row, at >> GTX_RAY_ROW_BITS), 0);
}

/* Three rows of an affine map. */
struct gtx_ray_rows {
    vec4 x, y, z;
};

gtx_ray_rows gtx_rows_at(int at)
{
    return gtx_ray_rows(gtx_ray_texel(at), gtx_ray_texel(at + 1), gtx_ray_texel(at + 2));
}

vec3 gtx_mapped(gtx_ray_rows m, vec4 v)
{
    return vec3(dot(m.x, v), dot(m.y, v), dot(m.z, v));
}

ivec3 gtx_ray_address(int at)
{
    return ivec3(at & gtx_ray_row, (at >> GTX_RAY_ROW_BITS) & gtx_ray_layer,
                 at >> (GTX_RAY_ROW_BITS + GTX_RAY_LAYER_BITS));
}

/* gtx_shows, of level 0, for a height field whose texels begin at `first`, `width` in a row. */
bool gtx_ray_shows(int first, ivec2 size, vec2 at)
{
    ivec2 cell = clamp(ivec2(floor(at)), ivec2(0), size - 2);
    int texel = first + cell.y * size.x + cell.x;
    float a = texelFetch(gtx_ray_trim, gtx_ray_address(texel), 0).r;
    float b = texelFetch(gtx_ray_trim, gtx_ray_address(texel + 1), 0).r;
    float c = texelFetch(gtx_ray_trim, gtx_ray_address(texel + size.x), 0).r;
    float d = texelFetch(gtx_ray_trim, gtx_ray_address(texel + size.x + 1), 0).r;
    vec2 f = clamp(at - vec2(cell), 0.0, 1.0);
    return mix(mix(a, b, f.x), mix(c, d, f.x), f.y) * 255.0 <= gtx_trim_limit(0);
}

/* Whether the ray crosses a block of 8 x 8 cells of the height field whose record is at `field`. */
bool gtx_crosses(int field, int block, vec3 origin, vec3 direction, float t_max)
{
    gtx_ray_rows to_grid = gtx_rows_at(field + GTX_RAY_FIELD_TO_GRID);
    vec4 record = gtx_ray_texel(field + GTX_RAY_FIELD_CELLS);
    ivec2 size = ivec2(record.xy);
    int first = int(record.z) * GTX_RAY_FIELD_ALIGN;
    vec3 o = gtx_mapped(to_grid, vec4(origin, 1.0)), d = gtx_mapped(to_grid, vec4(direction, 0.0));
    ivec2 low = ivec2(block & ((1 << GTX_RAY_BLOCK_BITS) - 1), block >> GTX_RAY_BLOCK_BITS) * 8;
    ivec2 high = min(low + 8, size - 1);
    float t0 = 0.0, t1 = t_max;
    gtx_clip(o.x - float(low.x), d.x, t0, t1);
    gtx_clip(float(high.x) - o.x, -d.x, t0, t1);
    gtx_clip(o.y - float(low.y), d.y, t0, t1);
    gtx_clip(float(high.y) - o.y, -d.y, t0, t1);

    /* As in gtx_cast: from the entry on, at about a cell a unit. */
    float speed = max(max(abs(d.x), abs(d.y)), max(abs(d.z), 1e-30)), end = (t1 - t0) * speed;
    o += t0 * d;
    d /= speed;
    ivec2 way = ivec2(d.x < 0.0 ? -1 : 1, d.y < 0.0 ? -1 : 1), ahead = max(way, ivec2(0));
    vec2 inverse = vec2(way) / max(abs(d.xy), 1e-9);
    ivec2 next = clamp(ivec2(floor(o.xy)), low, high - 1);
    /* Neighbouring cells overlap by this along the ray, so that none slips between them. */
    const float overlap = 1e-4;
    float leave = 0.0;
    bool inside = t0 <= t1, found = false;
    while (inside && !found) {
        bvec2 met = bvec2(false);
        vec2 root = vec2(0.0);
        while (inside && !any(met)) {
            vec2 planes = (vec2(next + ahead) - o.xy) * inverse;
            float enter = leave;
            leave = max(enter, min(min(planes.x, planes.y), end));
            ivec3 texel = gtx_ray_address(first + next.y * size.x + next.x);
            vec4 height = vec4(texelFetch(gtx_ray_cells, texel, 0));
            vec3 entry = o + enter * d;
            vec3 gap = gtx_gap(height, vec3(entry.xy - vec2(next), entry.z), d);
            root = gtx_roots(gap);
            met = bvec2(height.x > 0.0 && gap.y * gap.y > 4.0 * gap.z * gap.x);
            met.y = met.y && record.w > 0.0;
            met.x = met.x && root.x >= -overlap && root.x <= leave - enter + overlap;
            met.y = met.y && root.y >= -overlap && root.y <= leave - enter + overlap;
            root += enter;
            next += planes.x <= planes.y ? ivec2(way.x, 0) : ivec2(0, way.y);
            inside = leave < end && next == clamp(next, low, high - 1);
        }
        if (met.x)
            found = gtx_ray_shows(first, size, o.xy + root.x * d.xy);
        if (met.y && !found)
            found = gtx_ray_shows(first, size, o.xy + root.y * d.xy);
    }
    return found;
}

vec3 gtx_ray_inverse(vec3 d)
{
    return 1.0 / mix(d, vec3(1e-30), lessThan(abs(d), vec3(1e-30)));
}

/* Any crossing at 0 <= t <= t_max, in lengths of `direction`; t_max is at most 1e15. */
bool gtx_occluded(vec3 origin, vec3 direction, float t_max)
{
    vec3 o = origin, d = direction, inverse = gtx_ray_inverse(d);
    int top = int(gtx_ray_texel(0).x), node = GTX_RAY_HEAD_TEXELS, end = top;
    int behind = 0;                       /* the node after an instance's; 0: in the world */
    int fields = 0;
    bool found = false, more = true;
    while (more && !found) {
        /* The inner loop finds the next leaf and does no more (Aila and Laine 2009). */
        vec4 low = vec4(0.0), high = vec4(0.0);
        bool leaf = false;
        while (node < end && !leaf) {
            low = gtx_ray_texel(node + GTX_RAY_NODE_LOW);
            high = gtx_ray_texel(node + GTX_RAY_NODE_HIGH);
            vec3 a = (low.xyz - o) * inverse, b = (high.xyz - o) * inverse;
            vec3 enter = min(a, b), exit = max(a, b);
            float t0 = max(max(enter.x, enter.y), max(enter.z, 0.0));
            float t1 = min(min(exit.x, exit.y), min(exit.z, t_max));
            bool met = t0 <= t1 * 1.000001;
            leaf = met && high.w >= 0.0;
            node = met || high.w >= 0.0 ? node + GTX_RAY_NODE_TEXELS : int(low.w);
        }
        if (leaf && behind == 0) {        /* an instance: on into its asset */
            int instance = int(high.w);
            gtx_ray_rows to_object = gtx_rows_at(instance + GTX_RAY_INSTANCE_TO_OBJECT);
            vec4 asset = gtx_ray_texel(instance + GTX_RAY_INSTANCE_NODES);
            o = gtx_mapped(to_object, vec4(origin, 1.0));
            d = gtx_mapped(to_object, vec4(direction, 0.0));
            behind = node;
            node = int(asset.x);
            end = int(asset.y);
            fields = end;
            inverse = gtx_ray_inverse(d);
        } else if (leaf) {
            int field = fields + GTX_RAY_FIELD_TEXELS * int(high.w);
            found = gtx_crosses(field, int(low.w), o, d, t_max);
        } else {                          /* back to the world, or through */
            more = behind > 0;
            node = behind;
            end = top;
            behind = 0;
            o = origin;
            d = direction;
            inverse = gtx_ray_inverse(d);
        }
    }
    return found;
}

/* How far off the surface rays begin: two height steps of the coarsest patch, or the 32nd part of a
 * texel if that is more. A height field rounds the surface that it stands for by half a step up or
 * down, and its cells cut a little into what is round; from there no ray that leaves a surface
 * without hollows meets them, however grazing. Nothing else is left out. */
float gtx_ray_offset()
{
    return gtx_ray_texel(0).y;
}

/* Two directions square to a unit vector and to each other (Duff et al., "Building an Orthonormal
 * Basis, Revisited", JCGT 2017), and the vector. */
mat3 gtx_ray_basis(vec3 n)
{
    float side = n.z < 0.0 ? -1.0 : 1.0, a = -1.0 / (side + n.z), b = n.x * n.y * a;
    return mat3(vec3(1.0 + side * n.x * n.x * a, side * b, -side * n.x),
                vec3(b, side + n.y * n.y * a, -n.y), n);
}

/* Point i of a spiral that covers the unit disc evenly (Vogel 1979). */
vec2 gtx_ray_disc(int i, int rays, float turn)
{
    float angle = 6.2831853 * turn + 2.399963 * float(i);
    return sqrt((float(i) + 0.5) / float(rays)) * vec2(cos(angle), sin(angle));
}

/* A `turn` that differs from pixel to pixel and stays from frame to frame: interleaved gradient
 * noise (Jimenez 2014). */
float gtx_ray_turn(vec2 pixel)
{
    return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}

/* The share of a pattern of rays that end nowhere within `reach`: around `axis`, on a disc across
 * it or, a dome, on the half sphere above it. */
float gtx_ray_share(vec3 point, vec3 normal, vec3 axis, float spread, bool dome, float reach,
                    int rays, float turn)
{
    vec3 start = point + gtx_ray_offset() * normal;
    mat3 around = gtx_ray_basis(axis);
    float lit = 0.0;
    for (int i = 0; i < rays; ++i) {
        vec2 at = gtx_ray_disc(i, rays, turn) * spread;
        vec3 way = around * vec3(at, dome ? sqrt(max(1.0 - dot(at, at), 0.0)) : 1.0);
        if (dot(way, normal) > 0.0 && !gtx_occluded(start, way, reach))
            lit += 1.0;
    }
    return lit / float(rays);
}

/* The share of a disc of light far away that is seen, without the cosine: `light` points to its
 * middle, `spread` is the tangent of half the angle that it spans, 0 for a hard shadow, for which
 * one ray will do. All vectors unit. */
float gtx_sunlight(vec3 point, vec3 normal, vec3 light, float spread, int rays, float turn)
{
    return gtx_ray_share(point, normal, light, rays == 1 ? 0.0 : spread, false, 1e15, rays, turn);
}

/* The share of the sky that is seen, weighted by the cosine: ambient occlusion by what is nearer
 * than `reach`. */
float gtx_skylight(vec3 point, vec3 normal, float reach, int rays, float turn)
{
    return gtx_ray_share(point, normal, normal, 1.0, true, reach, rays, turn);
}
