/* The exact caster: a walk over the cells along the ray, and the analytic root in each. Needs
 * geotex_dialect.glsl and geotex_sheet.glsl before it.
 *
 *   bool gtx_cast(sheet, origin, direction, t0, t1, hit)
 *
 * First point of the sheet on origin + t * direction, t0 <= t <= t1, all in grid space, with
 * [t0, t1] within the sheet's box (gtx_clip_box). `direction` may have any length. Crossings from
 * above count, from below only when the sheet is two-sided; a point outside the outline does not
 * count and the search goes on behind it. Takes no derivative. */

/* Height of the ray above a cell's bilinear patch as a quadratic of s: c + b s + a s^2. */
struct gtx_gap {
    float a, b, c;
};

gtx_gap gtx_gap_of(vec4 height, vec3 origin, vec3 direction)
{
    float hx = height.y - height.x, hy = height.z - height.x;
    float hxy = height.x - height.y - height.z + height.w;
    gtx_gap gap;
    gap.a = -hxy * direction.x * direction.y;
    gap.b = direction.z - (hx * direction.x + hy * direction.y +
                           hxy * (origin.x * direction.y + origin.y * direction.x));
    gap.c = origin.z - (height.x + hx * origin.x + hy * origin.y + hxy * origin.x * origin.y);
    return gap;
}

/* The root where the gap falls (x) and the one where it rises (y), each by the form that does not
 * cancel; a root that does not exist is infinite or far away. `r` is the root of the discriminant. */
vec2 gtx_roots(gtx_gap gap, float r)
{
    const float tiny = 1e-30;
    float near = gap.b < 0.0 ? r - gap.b : r + gap.b;
    float stable = (gap.b < 0.0 ? 2.0 : -2.0) * gap.c / max(near, tiny);
    float other = (gap.b < 0.0 ? near : -near) / (2.0 * (abs(gap.a) < tiny ? tiny : gap.a));
    return gap.b < 0.0 ? vec2(stable, other) : vec2(other, stable);
}

void gtx_fill_hit(vec4 height, ivec2 cell, vec3 point, bool back, out gtx_hit hit)
{
    float hxy = height.x - height.y - height.z + height.w;
    vec2 at = point.xy - vec2(cell);
    hit.t = 0.0;
    hit.grid = point;
    hit.slope = vec2(height.y - height.x + hxy * at.y, height.z - height.x + hxy * at.x);
    hit.back = back;
}

bool gtx_cast(gtx_sheet sheet, vec3 origin, vec3 direction, float t0, float t1, out gtx_hit hit)
{
    /* From the entry on, at about a texel a unit: keeps the numbers small and so exact. */
    vec3 o = origin + t0 * direction;
    float speed = max(max(abs(direction.x), abs(direction.y)), max(abs(direction.z), 1e-30));
    vec3 d = direction / speed;
    float end = (t1 - t0) * speed;

    ivec2 way = ivec2(d.x < 0.0 ? -1 : 1, d.y < 0.0 ? -1 : 1);
    vec2 inverse = vec2(way) / max(abs(d.xy), 1e-9);
    ivec2 last = sheet.size - 2;
    ivec2 cell = clamp(ivec2(floor(o.xy)), ivec2(0), last);
    float s = 0.0;
    /* Which side of the sheet the ray was on where it left the cell before: carried along, so that
     * rounding at a border can neither hide a crossing nor find it twice. */
    bool known = false, above = false;

    for (int i = sheet.size.x + sheet.size.y; i > 0; --i) {
        vec2 planes = (vec2(cell + max(way, ivec2(0))) - o.xy) * inverse;
        float leave = max(s, min(min(planes.x, planes.y), end));
        vec4 height = vec4(texelFetch(gtx_cells, ivec3(sheet.corner + cell, sheet.page), 0));
        float top = max(max(height.x, height.y), max(height.z, height.w));
        if (top == 0.0) {
            known = false;
        } else if (min(o.z + s * d.z, o.z + leave * d.z) > top &&
                   (!known || above || !sheet.two_sided)) {
            known = above = true;
        } else {
            float span = leave - s;
            gtx_gap gap = gtx_gap_of(height, o + s * d - vec3(cell, 0.0), d);
            if (!known)
                above = gap.c >= 0.0;
            bool then_above = gap.c + span * (gap.b + span * gap.a) >= 0.0;
            float disc = gap.b * gap.b - 4.0 * gap.a * gap.c;
            if (above != then_above || disc > 0.0) {
                vec2 root = gtx_roots(gap, sqrt(max(disc, 0.0)));
                /* A change of side is a crossing; no change is none or two, both inside. */
                bool pair = above == then_above && min(root.x, root.y) >= 0.0 &&
                            max(root.x, root.y) <= span;
                bool falls = pair || (above && !then_above);
                bool rises = sheet.two_sided && (pair || (!above && then_above));
                bool rise_first = rises && (!falls || root.y < root.x);
                for (int k = 0; k < 2; ++k) {
                    bool rise = (k == 0) == rise_first;
                    if (!(rise ? rises : falls))
                        continue;
                    float at = s + clamp(rise ? root.y : root.x, 0.0, span);
                    vec3 point = o + at * d;
                    if (gtx_shows(sheet, cell, point.xy)) {
                        gtx_fill_hit(height, cell, point, rise, hit);
                        hit.t = t0 + at / speed;
                        return true;
                    }
                }
            }
            known = true;
            above = then_above;
        }
        if (leave >= end)
            return false;
        s = leave;
        if (planes.x <= planes.y)
            cell.x += way.x;
        else
            cell.y += way.y;
        if (any(lessThan(cell, ivec2(0))) || any(greaterThan(cell, last)))
            return false;
    }
    return false;
}
