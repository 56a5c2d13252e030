/* Casting that skips: a ray looks at the cells of a whole height field only where it is in their
 * slab. A level of ranges of heights, as maximum mipmaps are (Tevs, Ihrke and Seidel, "Maximum
 * Mipmaps for Fast, Accurate, and Scalable Dynamic Height Field Rendering", I3D 2008), but slanted
 * like the surface. Needs geotex_cast.glsl before it.
 *
 *   bool gtx_cast_by_slabs(field, slabs, origin, direction, t0, t1, hit)
 *
 * Finds what gtx_cast finds. `slabs` is where those of the level begin. It is for rays from afar:
 * those of hulls are near the height field from the start, and gtx_cast takes a tenth less. */

/* How far what is cast reaches beyond a slab, in cells, so that rounding opens no seam. */
const float gtx_slab_overlap = 2e-4;

/* Whether a ray is among the heights of a slab at any time between two. */
bool gtx_meets_slab(vec4 slab, vec3 origin, vec3 direction, float enter, float leave)
{
    float height = origin.z - dot(slab.xy, origin.xy);
    float rise = direction.z - dot(slab.xy, direction.xy);
    float a = height + enter * rise, b = height + leave * rise;
    float rounding = 1e-6 * (abs(origin.z) + dot(abs(slab.xy), abs(origin.xy)));
    return min(a, b) <= slab.w + rounding && max(a, b) >= slab.z - rounding;
}

bool gtx_cast_by_slabs(gtx_height_field field, int slabs, vec3 origin, vec3 direction, float t0,
                       float t1, out gtx_hit hit)
{
    /* From block to block as gtx_cast goes from cell to cell; x and y count in blocks. */
    float width = float(GTX_BLOCK_CELLS << field.level), limit = t1 - t0, leave = 0.0;
    ivec2 end = (field.size - 2) >> field.level;
    vec3 o = origin + t0 * direction;
    vec2 way = vec2(direction.x < 0.0 ? -1.0 : 1.0, direction.y < 0.0 ? -1.0 : 1.0);
    vec2 ahead = max(way, 0.0), across = width / max(abs(direction.xy), 1e-30);
    vec2 at = o.xy / width, last = vec2(end / GTX_BLOCK_CELLS);
    vec2 next = clamp(floor(at), vec2(0.0), last);
    float overlap = gtx_slab_overlap / float(GTX_BLOCK_CELLS) * min(across.x, across.y);
    bool inside = true, found = false;
    do {
        /* The inner loop finds the next slab and does no more. */
        vec2 block = next;
        float enter = leave;
        bool meets = false, going = true;
        do {
            vec2 planes = (next + ahead - at) * way * across;
            float then = max(leave, min(min(planes.x, planes.y), limit));
            vec4 slab = gtx_patches_texel(slabs + int(next.y * (last.x + 1.0) + next.x));
            bool met = gtx_meets_slab(slab, o, direction, leave, then);
            GTX_LOOK(y, going);
            if (going) {
                block = next;
                enter = leave;
                leave = then;
                next += planes.x <= planes.y ? vec2(way.x, 0.0) : vec2(0.0, way.y);
                inside = leave < limit && next == clamp(next, vec2(0.0), last);
                meets = met;
            }
            going = going && inside && !meets;
        } while (going);
        field.first = ivec2(block) * GTX_BLOCK_CELLS;
        field.last = min(field.first + (GTX_BLOCK_CELLS - 1), end);
        if (meets)
            found = gtx_cast(field, origin, direction, max(t0, t0 + enter - overlap),
                             min(t1, t0 + leave + overlap), hit);
        inside = inside && !found;
    } while (inside);
    return found;
}
