/* The exact caster: a walk over the cells along the ray, and the analytic root in each. Needs
 * geotex_height_field.glsl before it.
 *
 *   bool gtx_cast(field, origin, direction, t0, t1, hit)
 *
 * First point of the height field on origin + t * direction, t0 <= t <= t1, all in grid space, with
 * [t0, t1] within the height field's box (gtx_clip_box). `direction` may have any length. Crossings
 * from above count, from below only when the height field is two-sided; a point outside the outline
 * does not count and the search goes on behind it. Takes no derivative.
 *
 * Processors that run rays side by side run the body of a loop until the last of them leaves it,
 * and some once more to see that all have left. So loops end with their condition, and a ray that
 * is through changes nothing any more: the condition is asked at the top too, from other values,
 * for compilers may not keep for such a ray what a loop merely computes. */

/* The cell that a ray is in. x and y count in cells of the level. */
struct gtx_walk {
    vec2 cell;
    float enter, leave;      /* where the ray enters and leaves it */
    bool above, then_above;  /* which side of the height field the ray is on there */
    bool known;              /* the cell exists: `above` of the next one is `then_above` of this */
    bool pair;               /* two crossings, without a change of side */
    vec2 fit;                /* its widths are 1 / fit: at coarse levels a last cell is narrower */
    vec4 height;
    vec3 gap;
};

/* Looks at the cell; true when the ray crosses the height field in it, in a way that counts. The
 * side is carried from cell to cell, so that rounding at a border can neither hide a crossing nor
 * find it twice. `height` are its codes, `fit` is that of the last cells, in whose column and row
 * `last` is. */
bool gtx_look(inout gtx_walk w, vec4 height, bool two_sided, vec2 last, float fit, vec3 origin,
              vec3 direction)
{
    vec3 entry = origin + w.enter * direction;
    float span = w.leave - w.enter;
    w.height = height;
    w.fit = mix(vec2(1.0), vec2(fit), vec2(equal(w.cell, last)));
    w.gap = gtx_gap(w.height, vec3((entry.xy - w.cell) * w.fit, entry.z),
                    vec3(direction.xy * w.fit, direction.z));
    w.above = w.known ? w.then_above : w.gap.x >= 0.0;
    w.then_above = w.gap.x + span * (w.gap.y + span * w.gap.z) >= 0.0;
    w.known = gtx_exists(w.height);
    /* Two crossings: the gap has its extremum in between, beyond zero. */
    bool change = w.above != w.then_above;
    bool bends = (w.gap.y < 0.0) == w.above && (w.gap.y + 2.0 * span * w.gap.z > 0.0) == w.above;
    w.pair = !change && bends && w.gap.y * w.gap.y > 4.0 * w.gap.z * w.gap.x;
    return w.known && (w.pair || (change && (w.above || two_sided)));
}

bool gtx_cast(gtx_height_field field, vec3 origin, vec3 direction, float t0, float t1,
              out gtx_hit hit)
{
    /* From the entry on, at about a cell a unit: keeps the numbers small and so exact. */
    float width = float(1 << field.level);
    vec3 texels = vec3(width, width, 1.0), ray = direction / texels;
    float speed = max(max(abs(ray.x), abs(ray.y)), max(abs(ray.z), 1e-30));
    vec3 o = (origin + t0 * direction) / texels, d = ray / speed;
    vec2 first = vec2(field.first), final = vec2(field.last);
    vec2 last = vec2((field.size - 2) >> field.level);
    float fit = field.level > 0 ? width / (width - 1.0) : 1.0;
    float limit = (t1 - t0) * speed;
    /* Drivers that draw on the CPU look up by place for less than they fetch. */
    vec2 texel = 1.0 / vec2(textureSize(gtx_cells, 0).xy);
    vec2 place = (vec2(field.cells) + 1.0) * texel;
    vec2 stride = float(field.step) * texel;

    vec2 way = vec2(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0), ahead = max(way, 0.0);
    vec2 inverse = way / max(abs(d.xy), 1e-9);
    vec2 next = clamp(floor(o.xy), first, final);
    gtx_walk w;
    w.leave = 0.0;
    w.known = w.then_above = w.pair = w.above = false;
    bool inside = false, found = false;
    float s = 0.0, end = limit; /* end: below 0 when there is no more to walk */
    hit.back = false;
    do {
        /* The inner loop finds the next crossing and does no more. */
        bool crossing = false;
        do {
            bool going = end >= 0.0;
            gtx_walk v = w;
            vec2 planes = (next + ahead - o.xy) * inverse;
            v.cell = next;
            v.enter = w.leave;
            v.leave = max(v.enter, min(min(planes.x, planes.y), limit));
#ifdef GTX_GATHER_CODES
            vec4 height = vec4(
                textureGather(gtx_cells, vec3(place + next * stride, float(field.page))).wzxy);
#else
            vec4 height =
                gtx_codes(ivec3(field.cells + field.step * ivec2(next), field.page));
#endif
            bool crosses = gtx_look(v, height, field.two_sided, last, fit, o, d);
            vec2 then = next + (planes.x <= planes.y ? vec2(way.x, 0.0) : vec2(0.0, way.y));
            bool left = v.known && (v.above ? v.gap.x : -v.gap.x) > field.reach;
            bool stays = v.leave < limit && then == clamp(then, first, final) && !left;
            GTX_LOOK(x, going);
            if (going) {
                w = v;
                next = then;
                crossing = crosses;
                inside = stays;
            }
            end = going && stays && !crosses ? end : -1.0;
        } while (end >= 0.0);
        vec2 root = w.enter + clamp(gtx_roots(w.gap), 0.0, w.leave - w.enter);
        bool back = field.two_sided && !w.above;
        float at = back ? root.y : root.x;
        bool shows = crossing && gtx_shows(field, (o.xy + at * d.xy) * texels.xy);
        if (crossing) {
            s = at;
            hit.back = back;
            found = shows;
        }
        bool again = crossing && !shows;
        if (again && w.pair && field.two_sided) { /* the other one is still to come */
            next = w.cell;
            w.leave = s;
            w.then_above = hit.back;
            inside = true;
        }
        end = again && inside ? limit : -1.0;
    } while (end >= 0.0);
    hit.t = t0 + s / speed;
    hit.grid = (o + s * d) * texels;
    hit.level = field.level;
    vec2 at = (o.xy + s * d.xy - w.cell) * w.fit;
    vec4 h = w.height;
    hit.slope = vec2(h.y - h.x, h.z - h.x) + (h.x - h.y - h.z + h.w) * at.yx;
    hit.slope *= w.fit / texels.xy;
    return found;
}
