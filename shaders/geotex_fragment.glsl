/* What a fragment of a proxy sees: the surface where its ray meets the patch. The stock mains are
 * written with this, and so is an engine's own (gtx_shading_create):
 *
 *   layout(location = 0) out vec4 color;
 *   void main()
 *   {
 *       gtx_surface s;
 *       if (!gtx_find(s))
 *           discard;
 *       color = vec4(gtx_albedo(s).rgb * lit(gtx_world_point(s), gtx_world_normal(s)), 1.0);
 *       gtx_write_depth(s);
 *   }
 *
 * A main that reads no varying but through functions, gtx_color and gtx_id may say so by the line
 * `#pragma geotex tiles`, to be cast by tiles, too.
 *
 * Needs geotex_view.glsl, geotex_surface.glsl, with GTX_MATERIALS defined geotex_material.glsl, and
 * a gtx_cast (of geotex_cast.glsl or geotex_paper.glsl) before it. The varyings are those of
 * geotex_proxy.vert; with GTX_TILES defined geotex_tiles.glsl comes after it instead. */
#ifdef GTX_TILES
/* geotex_tiles.glsl fills these; with values at once compilers do not warn of them. */
vec4 gtx_clip_z = vec4(0.0), gtx_clip_w = vec4(0.0);
vec3 gtx_normal_x = vec3(0.0), gtx_normal_y = vec3(0.0), gtx_normal_z = vec3(0.0);
vec3 gtx_world = vec3(0.0), gtx_world_eye = vec3(0.0);
int gtx_patch_index = 0;
GTX_VARYING(1) flat in vec4 gtx_color;
/* What is the same all over comes as varyings, too: processors fetch a uniform for every pixel, but
 * a flat varying once. From 3 on it is gtx_place. */
GTX_VARYING(2) flat in vec4 gtx_flat[3 + GTX_PLACE_ROWS];
GTX_VARYING(14) flat in uint gtx_id;
#define gtx_depth gtx_flat[0]
#define gtx_light gtx_flat[1]
#define gtx_maps gtx_flat[2]
#else
GTX_VARYING(0) in vec3 gtx_point;
GTX_VARYING(1) flat in vec3 gtx_eye;
GTX_VARYING(2) flat in vec4 gtx_clip_z;
GTX_VARYING(3) flat in vec4 gtx_clip_w;
GTX_VARYING(4) flat in vec3 gtx_normal_x;
GTX_VARYING(5) flat in vec3 gtx_normal_y;
GTX_VARYING(6) flat in vec3 gtx_normal_z;
GTX_VARYING(7) flat in vec4 gtx_color;
GTX_VARYING(8) flat in int gtx_patch_index;
GTX_VARYING(9) flat in vec4 gtx_rect;
GTX_VARYING(10) flat in vec4 gtx_span;
GTX_VARYING(11) flat in int gtx_level;
GTX_VARYING(12) flat in uint gtx_id;    /* of the instance, as the host gave it */
GTX_VARYING(13) flat in float gtx_reach;
GTX_VARYING(14) in vec3 gtx_world;
GTX_VARYING(15) flat in vec3 gtx_world_eye;
#endif

/* Where the ray of a fragment meets its patch, whose index is gtx_patch_index. */
struct gtx_surface {
    gtx_hit hit;        /* hit.grid.xy: texel coordinates in the patch */
    gtx_height_field field;
    gtx_frame frame;    /* grid space -> object space */
    vec3 ray;           /* away from the camera, in grid space; of any length */
    float level;        /* mip level whose texels are as large as the pixel */
    float deviation;    /* how far normals stray from its own */
};

/* What the engine's matrices and depth range make of a clip position. */
float gtx_depth_of(vec2 zw)
{
    return clamp(zw.x / zw.y, -gtx_depth.x, 1.0) * gtx_depth.y + gtx_depth.z;
}

#ifndef GTX_TILES
/* Shortens the ray to what the engine's near and far planes leave of it and, where the driver
 * tells it, to what has been drawn before: a shader that writes depth comes before the depth
 * test. Of several samples the driver tells of one. Boxes, which the paper's search has, do
 * without. `zw` and `zw_step` are linear along the ray. */
void gtx_clip_depth(vec2 zw, vec2 zw_step, inout float t0, inout float t1)
{
    float low = -gtx_depth.x, high = 1.0;
#ifdef GTX_DEPTH_FETCH
    float drawn = (gl_LastFragDepthARM - gtx_depth.z) / gtx_depth.y;
    if (gl_NumSamples < 2 && gtx_reach >= 0.0) {
        low = gtx_detail.y < 0.0 ? drawn : low;
        high = gtx_detail.y > 0.0 ? drawn : high;
    }
#endif
    gtx_clip(zw.x - low * zw.y, zw_step.x - low * zw_step.y, t0, t1);
    gtx_clip(high * zw.y - zw.x, high * zw_step.y - zw_step.x, t0, t1);
}

/* False when the ray misses; then `s` is not filled. Takes derivatives: call it first, from all
 * fragments. */
bool gtx_find(out gtx_surface s)
{
    vec3 dx = dFdx(gtx_point), dy = dFdy(gtx_point);
    /* z and w of the clip position are linear along the ray: zw + t * step. */
    vec2 zw = vec2(dot(gtx_clip_z, vec4(gtx_point, 1.0)), dot(gtx_clip_w, vec4(gtx_point, 1.0)));
    s.field = gtx_field_of(gtx_rect, gtx_span, gtx_level);
    s.ray = gtx_point * gtx_depth.w - gtx_eye;
    vec2 zw_step = vec2(dot(gtx_clip_z.xyz, s.ray), dot(gtx_clip_w.xyz, s.ray));
    float t0 = gtx_reach < 0.0 ? -1e30 : 0.0, t1 = 1e30;
    s.field.reach = gtx_reach < 0.0 ? 1e30 : gtx_reach;
    gtx_clip_depth(zw, zw_step, t0, t1);
    gtx_clip_box(s.field, gtx_point, s.ray, t0, t1);
    if (t0 > t1)
        return false;
#ifdef GTX_SKIP
    bool found = gtx_cast_by_slabs(s.field, int(-1.0 - gtx_reach), gtx_point, s.ray, t0, t1, s.hit);
#else
    bool found = gtx_cast(s.field, gtx_point, s.ray, t0, t1, s.hit);
#endif
    if (!found)
        return false;

    float widen = 1.0 + s.hit.t * gtx_depth.w;
    s.level = gtx_level_of(s.hit, s.ray, dx * widen, dy * widen);
    s.deviation = gtx_deviation_of(gtx_patch_index, min(s.level, gtx_maps.x));
    s.frame = gtx_frame_of(gtx_patch_index);
    return true;
}
#endif

/* What the engine's matrices and depth range make of the point. */
float gtx_window_depth(gtx_surface s)
{
    vec4 point = vec4(s.hit.grid, 1.0);
    return gtx_depth_of(vec2(dot(gtx_clip_z, point), dot(gtx_clip_w, point)));
}

/* Every main calls it, or writes a depth of its own (a logarithmic one, say). */
void gtx_write_depth(gtx_surface s)
{
    gl_FragDepth = gtx_window_depth(s);
}

/* The asset's own coordinates. */
vec3 gtx_object_point(gtx_surface s)
{
    return gtx_object_point(s.frame, s.hit.grid);
}

vec3 gtx_world_point(gtx_surface s)
{
    return gtx_world + s.hit.t * (gtx_world * gtx_depth.w - gtx_world_eye);
}

vec3 gtx_object_ray(gtx_surface s)
{
    return mat3(s.frame.axis_x, s.frame.axis_y, s.frame.axis_z) * s.ray;
}

/* Away from the camera; unit. */
vec3 gtx_world_ray(gtx_surface s)
{
    return normalize(gtx_world * gtx_depth.w - gtx_world_eye);
}

/* Unit; towards the camera where the height field is seen from behind. */
vec3 gtx_world_normal(gtx_surface s)
{
    vec3 p = gtx_decode_normal(
        gtx_lookup(gtx_normals, s.field, s.hit.grid.xy, s.level, gtx_maps.x).xy);
    vec3 n = normalize(gtx_normal_x * p.x + gtx_normal_y * p.y + gtx_normal_z * p.z);
    return s.hit.back ? gtx_from_behind(n, gtx_world_ray(s)) : n;
}

/* The colour map times the instance's tint. Linear. */
vec4 gtx_albedo(gtx_surface s)
{
    vec4 color = gtx_color;
    if (gtx_maps.y > 0.0)
        color *= gtx_lookup(gtx_colors, s.field, s.hit.grid.xy, s.level, gtx_maps.x);
    return color;
}

#ifdef GTX_MATERIALS
/* With the albedo as its colour. A model without a material map is rough and no metal. */
gtx_material gtx_material_of(gtx_surface s, vec3 albedo)
{
    vec4 map = vec4(1.0, 1.0, 0.0, 1.0);
    vec3 emission = vec3(0.0);
    if (gtx_maps.w > 0.0)
        map = gtx_lookup(gtx_materials, s.field, s.hit.grid.xy, s.level, gtx_maps.x);
    if (gtx_maps.z > 0.0)
        emission = gtx_maps.z *
                   gtx_lookup(gtx_emissions, s.field, s.hit.grid.xy, s.level, gtx_maps.x).rgb;
    return gtx_material(albedo, emission, map.x, map.y, map.z, map.w);
}
#endif
