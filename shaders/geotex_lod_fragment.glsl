/* What a fragment of an LOD mesh or a displaced grid sees: the calls of geotex_fragment.glsl,
 * answered by polygons, for the same mains. Nothing is searched and depth is the polygon's own, so
 * that a main that neither discards nor writes a depth leaves the depth test first.
 *
 * Needs geotex_view.glsl, geotex_surface.glsl and, with GTX_MATERIALS defined, geotex_material.glsl
 * before it. The varyings are those of geotex_lod.vert. */
GTX_VARYING(0) in vec2 gtx_at;
GTX_VARYING(1) flat in vec3 gtx_page;
#ifdef GTX_VERTEX_NORMALS
GTX_VARYING(2) in vec3 gtx_normal;
GTX_VARYING(3) flat in vec2 gtx_behind;
#else
GTX_VARYING(2) flat in vec3 gtx_normal_x;
GTX_VARYING(3) flat in vec3 gtx_normal_y;
GTX_VARYING(4) flat in vec3 gtx_normal_z;
#endif
#if defined(GTX_VERTEX_NORMALS) && defined(GTX_GRID)
GTX_VARYING(5) in vec4 gtx_color;
#else
GTX_VARYING(5) flat in vec4 gtx_color;
#endif
GTX_VARYING(6) GTX_STEADY in vec3 gtx_ray;
GTX_VARYING(7) in vec3 gtx_object;
GTX_VARYING(8) in vec3 gtx_world;
GTX_VARYING(9) flat in int gtx_patch_index;
GTX_VARYING(10) flat in uint gtx_id;

/* Of sight; world space, unit. */
vec3 gtx_sight()
{
#ifdef GTX_BLOCKS
    return normalize(gtx_ray);
#else
    return gtx_ray;
#endif
}

struct gtx_surface {
    gtx_hit hit;        /* hit.grid.xy: texel coordinates in the patch */
    gtx_height_field field;
    gtx_frame frame;    /* grid space -> object space */
    float level;        /* mip level */
    float deviation;    /* how far normals stray from its own */
};

bool gtx_find(out gtx_surface s)
{
    s.field = gtx_field_of(gtx_patch_index, 0);
    s.frame = gtx_frame_of(gtx_patch_index);
    s.hit.t = 0.0;
    s.hit.grid = gtx_to_grid(gtx_patch_index, vec4(gtx_object, 1.0));
    vec3 facet = cross(dFdx(s.hit.grid), dFdy(s.hit.grid));
    s.hit.slope = -facet.xy / facet.z;
    s.hit.level = 0;
    s.hit.back = !gl_FrontFacing;
    s.level = gtx_page.y;
#if defined(GTX_VERTEX_NORMALS) && !defined(GTX_GRID)
    s.deviation = GTX_LEAST_DEVIATION;
#else
    s.deviation = gtx_page.z;
#endif
#ifdef GTX_TRIMMED
    return gtx_is_shown();
#else
    return true;
#endif
}

float gtx_window_depth(gtx_surface s)
{
    return gl_FragCoord.z;
}

void gtx_write_depth(gtx_surface s)
{
}

vec3 gtx_object_point(gtx_surface s)
{
    return gtx_object;
}

vec3 gtx_world_point(gtx_surface s)
{
    return gtx_world;
}

vec3 gtx_world_ray(gtx_surface s)
{
    return gtx_sight();
}

vec3 gtx_place()
{
    return vec3(gtx_at, gtx_page.x);
}

vec3 gtx_world_normal(gtx_surface s)
{
#ifdef GTX_VERTEX_NORMALS
    vec3 n = normalize(gtx_normal);
    vec2 turned = gl_FrontFacing ? vec2(1.0, 0.0) : gtx_behind;
    return n * turned.x + gtx_sight() * turned.y;
#else
    vec3 p = gtx_decode_normal(textureLod(gtx_normals, gtx_place(), gtx_page.y).xy);
    vec3 n = normalize(gtx_normal_x * p.x + gtx_normal_y * p.y + gtx_normal_z * p.z);
    return gl_FrontFacing ? n : gtx_from_behind(n, gtx_sight());
#endif
}

vec4 gtx_albedo(gtx_surface s)
{
    vec4 color = gtx_color;
#ifndef GTX_VERTEX_NORMALS
    if (gtx_maps.y > 0.0)
        color *= textureLod(gtx_colors, gtx_place(), gtx_page.y);
#endif
    return color;
}

#ifdef GTX_MATERIALS
gtx_material gtx_material_of(gtx_surface s, vec3 albedo)
{
    return gtx_material_at(gtx_place(), gtx_page.y, albedo);
}
#endif
