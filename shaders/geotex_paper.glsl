/* The search of the paper (de Toledo, Wang, Levy 2008, section 4.1): N linear steps, then M binary
 * ones, fewer linear and more binary the steeper the view. The same gtx_cast as geotex_cast.glsl,
 * to be measured against it; it may step over thin features.
 *
 * The four codes of a cell come with one fetch and are interpolated by hand, for a filter would
 * blend heights with code 0, which means empty. Casts height fields of level 0 only. */

/* The paper's z(P): whether the point is on or below the height field. */
bool gtx_below(gtx_height_field field, vec3 point, out vec4 height, out ivec2 cell)
{
    cell = clamp(ivec2(floor(point.xy)), ivec2(0), field.size - 2);
    GTX_LOOK(x, true);
    height = gtx_codes(ivec3(field.corner + cell, field.page));
    vec2 f = point.xy - vec2(cell);
    return gtx_exists(height) &&
           point.z <= mix(mix(height.x, height.y, f.x), mix(height.z, height.w, f.x), f.y);
}

bool gtx_cast(gtx_height_field field, vec3 origin, vec3 direction, float t0, float t1,
              out gtx_hit hit)
{
    const float most_linear = 40.0, least_linear = 10.0, most_binary = 6.0, least_binary = 3.0;
    vec3 in_box = direction / (field.high - field.low); /* the paper's canonical cube */
    float steep = abs(in_box.z) / max(length(in_box), 1e-30);
    int linear_steps = int(mix(most_linear, least_linear, steep));
    int binary_steps = int(mix(least_binary, most_binary, steep) + 0.5);
    if (gtx_search.x > 0.0) {
        linear_steps = int(gtx_search.x);
        binary_steps = int(gtx_search.y);
    }

    vec4 height;
    ivec2 cell;
    float width = (t1 - t0) / float(linear_steps);
    float outside = t0, inside = t0;
    bool found = false;
    for (int i = 1; i <= linear_steps; ++i) {
        inside = t0 + width * float(i);
        found = gtx_below(field, origin + inside * direction, height, cell);
        if (found)
            break;
        outside = inside;
    }
    if (!found)
        return false;
    for (int i = 0; i < binary_steps; ++i) {
        float middle = 0.5 * (outside + inside);
        if (gtx_below(field, origin + middle * direction, height, cell))
            inside = middle;
        else
            outside = middle;
    }
    vec3 point = origin + inside * direction;
    gtx_below(field, point, height, cell);
    vec2 f = point.xy - vec2(cell);
    float hxy = height.x - height.y - height.z + height.w;
    hit.t = inside;
    hit.grid = point;
    hit.slope = vec2(height.y - height.x + hxy * f.y, height.z - height.x + hxy * f.x);
    hit.back = false;
    hit.level = 0;
    return gtx_shows(field, point.xy);
}
