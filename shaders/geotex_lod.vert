/* Polygons, whose vertices know their place and their patch: of an LOD mesh or, with GTX_GRID, of
 * height fields drawn as displaced grids (Cook, Shade Trees, SIGGRAPH 1984); with GTX_BLOCKS, too,
 * nodes fetch their heights. Map coordinates and the frame of normals follow from the patch's
 * record. With GTX_LIT, for geotex_lit.frag and geotex_lod_lit.frag, triangles are so small, or so
 * even, that the light at their corners is enough, with GTX_OWN_VERTICES an engine's own; with
 * GTX_VERTEX_NORMALS, for an engine's own main, the normals and colours there are.
 *
 * Needs geotex_height_field.glsl and geotex_view.glsl before it, and with GTX_LIT and GTX_MATERIALS
 * geotex_surface.glsl and geotex_material.glsl. What hardly changes over a triangle is found here
 * and stays the same all over it: triangles are small, and a vertex serves several. Each number
 * more that a triangle carries costs a few per cent on llvmpipe. */
#if !defined(GTX_LIT) || !defined(GTX_MATERIALS)
GTX_SAMPLER(2, highp sampler2DArray) gtx_normals;
#if defined(GTX_GRID) && (defined(GTX_VERTEX_NORMALS) || defined(GTX_LIT)) && !defined(GTX_PLAIN)
GTX_SAMPLER(3, highp sampler2DArray) gtx_colors;
#endif
#endif

#if defined(GTX_BLOCKS)
layout(location = 0) in uvec2 gtx_block;    /* patch + 2^28 * level; the first node, 16 bits each.
                                               The vertex's number tells which one after it. */
#define gtx_patch (gtx_block.x & 0x0fffffffu)
#ifdef VULKAN
#define GTX_VERTEX gl_VertexIndex
#else
#define GTX_VERTEX gl_VertexID
#endif
#elif defined(GTX_GRID)
layout(location = 0) in uvec4 gtx_node;     /* place in the patch, in fourths of a cell; the
                                               height's code, and sixteenths of one */
#elif defined(GTX_RHI)
layout(location = 0) in uvec4 gtx_steps;    /* of the level; the normal */
#else
layout(location = 0) in vec4 gtx_steps;
#endif
#ifndef GTX_BLOCKS
layout(location = 1) in uint gtx_patch;
#endif
#ifdef GTX_SINGLE
uniform vec4 gtx_place[7];                  /* what follows, of the only instance */
#define gtx_world_x gtx_place[0]
#define gtx_world_y gtx_place[1]
#define gtx_world_z gtx_place[2]
#define gtx_object_x gtx_place[3]
#define gtx_object_y gtx_place[4]
#define gtx_object_z gtx_place[5]
#define gtx_tint gtx_place[6]
#define gtx_instance 0u
#else
layout(location = 2) in vec4 gtx_world_x;   /* as in geotex_proxy.vert */
layout(location = 3) in vec4 gtx_world_y;
layout(location = 4) in vec4 gtx_world_z;
layout(location = 5) in vec4 gtx_object_x;
layout(location = 6) in vec4 gtx_object_y;
layout(location = 7) in vec4 gtx_object_z;
layout(location = 8) in vec4 gtx_tint;
layout(location = 9) in uint gtx_instance;
#endif

invariant gl_Position;                      /* bit for bit what a depth prepass has */

#ifdef GTX_LIT
GTX_VARYING(0) out vec4 gtx_lit;            /* colour as it is shown */
#if !defined(GTX_GRID) && !defined(GTX_OWN_VERTICES)
GTX_VARYING(1) out vec3 gtx_behind;         /* the same, of the back */
#endif
#else
GTX_VARYING(0) out vec2 gtx_at;             /* place in the page, 0..1 */
GTX_VARYING(1) flat out vec3 gtx_page;      /* page; mip level; how far normals stray from it */
#if defined(GTX_VERTEX_NORMALS) && defined(GTX_GRID)
GTX_VARYING(5) out vec4 gtx_color;
#else
GTX_VARYING(5) flat out vec4 gtx_color;     /* where no map gives colours, the 2.4th root of rgb */
#endif
#ifdef GTX_FRONT
GTX_VARYING(2) flat out vec3 gtx_toward;    /* the light among the patch's normals, and the eye: */
GTX_VARYING(3) GTX_STEADY out vec3 gtx_eye; /* unit, over how far normals stray; with GTX_BLOCKS
                                               the eye is neither */
#if defined(GTX_MATERIALS) && !defined(GTX_BLOCKS)
GTX_VARYING(4) flat out vec4 gtx_between;   /* what gtx_half_way says there */
#endif
#else
#ifdef GTX_VERTEX_NORMALS
GTX_VARYING(2) out vec3 gtx_normal;         /* world space; of the front */
GTX_VARYING(3) flat out vec2 gtx_behind;    /* from behind: how often that, and how often the ray */
#else
GTX_VARYING(2) flat out vec3 gtx_normal_x;  /* the patch's normals -> world */
GTX_VARYING(3) flat out vec3 gtx_normal_y;
GTX_VARYING(4) flat out vec3 gtx_normal_z;
#endif
GTX_VARYING(6) GTX_STEADY out vec3 gtx_ray; /* of sight; world space, unit unless GTX_BLOCKS */
GTX_VARYING(7) out vec3 gtx_object;         /* the point in either space; what follows costs only */
GTX_VARYING(8) out vec3 gtx_world;          /* where a main reads it */
GTX_VARYING(9) flat out int gtx_patch_index;
GTX_VARYING(10) flat out uint gtx_id;       /* of the instance */
#endif
#endif

#if defined(GTX_TRIMMED) && defined(GTX_LIT)
GTX_VARYING(11) out float gtx_outline;      /* code of the trim */
#elif defined(GTX_TRIMMED)
GTX_VARYING(11) out vec2 gtx_texel;         /* of the patch */
GTX_VARYING(12) flat out uvec3 gtx_trimmed; /* of the rectangle, 16 bits each: corner; size; page,
                                               and with GTX_BLOCKS level */
#endif

vec3 gtx_to_world(vec3 object)
{
    return vec3(dot(gtx_world_x.xyz, object), dot(gtx_world_y.xyz, object),
                dot(gtx_world_z.xyz, object));
}

#ifdef GTX_BLOCKS
/* A node of the block, as a corner of any cell that is there. Between cells that are not,
 * triangles stay in the block's slab: nothing of them shows. */
vec3 gtx_displaced(int index, int level)
{
    vec4 rect = gtx_record(index, GTX_RECORD_RECT);
    float page = gtx_record(index, GTX_RECORD_PAGE).w, code = 0.0;
    gtx_height_field field = gtx_field_of(rect, vec4(0.0, 0.0, page, 0.0), level);
    ivec2 end = field.last + 1, first = ivec2(gtx_block.y & 0xffffu, gtx_block.y >> 16);
    ivec2 corner = ivec2(GTX_VERTEX % (GTX_BLOCK_CELLS + 1), GTX_VERTEX / (GTX_BLOCK_CELLS + 1));
    ivec2 node = min(first + corner, end), texel = min(node << level, field.size - 1);
    for (int i = 0; i < 4 && code == 0.0; ++i) {
        ivec2 side = ivec2(i & 1, i >> 1), cell = node - side;
        if (cell == clamp(cell, ivec2(0), field.last))
            code = float(texelFetch(gtx_cells, ivec3(field.cells + field.step * cell + side,
                                                     field.page), 0).r);
    }
    if (code == 0.0) {
        ivec2 block = first / GTX_BLOCK_CELLS;
        int at = block.y * (field.last.x / GTX_BLOCK_CELLS + 1) + block.x;
        int slabs = int(gtx_record(index, GTX_RECORD_SLABS + level / 4)[level % 4]);
        vec4 slab = gtx_patches_texel(slabs + at);
        code = dot(slab.xy, vec2(texel)) + 0.5 * (slab.z + slab.w);
    }
    return vec3(vec2(texel), code);
}
#endif

#ifndef GTX_GRID
/* Not of unit length. */
vec3 gtx_octahedral(float code)
{
    float high = floor(code * (1.0 / 256.0));
    vec2 e = vec2(code - 256.0 * high, high) * (2.0 / 255.0) - 1.0;
    float z = 1.0 - abs(e.x) - abs(e.y);
    return vec3(e + mix(vec2(min(z, 0.0)), vec2(max(-z, 0.0)), vec2(lessThan(e, vec2(0.0)))), z);
}

#endif

#if defined(GTX_LIT) && !defined(GTX_GRID)
vec3 gtx_shown_to(vec3 n, vec3 eye, vec3 root)
{
    float light = gtx_diffuse(n, eye, gtx_light.xyz, GTX_LEAST_DEVIATION);
    return gtx_shown(root, gtx_light.w + (1.0 - gtx_light.w) * light);
}

/* All that light needs comes with the vertices. */
void main()
{
    vec4 object = vec4(gtx_lod_mesh.xyz + gtx_lod_mesh.w * vec3(gtx_steps.xyz), 1.0);
    vec3 world = gtx_to_world(object.xyz) + vec3(gtx_world_x.w, gtx_world_y.w, gtx_world_z.w);
    gl_Position = gtx_view_clip() * vec4(world, 1.0);
    mat3 world_normals = mat3(gtx_object_x.xyz, gtx_object_y.xyz, gtx_object_z.xyz);
    vec3 n = normalize(world_normals * gtx_octahedral(float(gtx_steps.w)));
    vec3 eye = gtx_view_eye(gtx_object_x, gtx_object_y, gtx_object_z);
    vec3 ray = normalize(gtx_to_world(object.xyz * gtx_depth.w - eye));
#ifdef GTX_OWN_VERTICES
    gtx_lit = gtx_at_vertex(world, n, -ray, gtx_tint, GTX_LEAST_DEVIATION);
#else
    vec3 root = pow(max(gtx_tint.rgb, 0.0), vec3(1.0 / 2.4));
    gtx_lit = vec4(gtx_shown_to(n, -ray, root), gtx_tint.a);
    gtx_behind = gtx_shown_to(gtx_from_behind(n, ray), -ray, root);
#endif
}
#else
void main()
{
    int index = int(gtx_patch);
#ifdef GTX_GRID
#ifdef GTX_BLOCKS
    int level_of_detail = int(gtx_block.x >> 28);
    vec3 grid = gtx_displaced(index, level_of_detail);
#else
    vec3 grid = vec3(0.25 * vec2(gtx_node.xy), float(gtx_node.z) + 0.0625 * float(gtx_node.w));
#endif
    vec4 object = vec4(gtx_object_point(gtx_frame_of(index), grid), 1.0);
    vec2 at = grid.xy;
#else
    vec4 object = vec4(gtx_lod_mesh.xyz + gtx_lod_mesh.w * vec3(gtx_steps.xyz), 1.0);
    vec2 at = gtx_to_grid(index, object).xy;
#endif
    vec3 world = gtx_to_world(object.xyz) + vec3(gtx_world_x.w, gtx_world_y.w, gtx_world_z.w);
    gl_Position = gtx_view_clip() * vec4(world, 1.0);

    /* The mip level whose texels, seen from above, are nearest to a pixel in size; 0 when the size
     * of a pixel is unknown. */
    vec3 axis_x = gtx_record(index, GTX_RECORD_AXIS_X).xyz;
    vec3 axis_y = gtx_record(index, GTX_RECORD_AXIS_Y).xyz;
    vec3 axis_z = gtx_record(index, GTX_RECORD_AXIS_Z).xyz;
    float texel = length(cross(gtx_to_world(axis_x), gtx_to_world(axis_y)));
    float pixels = gtx_detail.x * gtx_detail.w * sqrt(texel);
    float level = log2(gl_Position.w / max(pixels, 1e-30));
    level = pixels > 0.0 ? clamp(level, 0.0, gtx_maps.x) : 0.0;
    /* The lookup takes the nearest whole level of one of the triangle's vertices, and there texels
     * of this patch alone: of two levels that are nearly as near, the coarser one tells which. */
    float half_texel = 0.5 * exp2(min(floor(level + 0.75), gtx_maps.x));
    vec4 rect = gtx_record(index, GTX_RECORD_RECT);
#if defined(GTX_TRIMMED) && !defined(GTX_LIT)
    uvec4 corners = uvec4(rect);
    gtx_texel = at;
    gtx_trimmed = uvec3(corners.x | corners.y << 16, corners.z | corners.w << 16,
                        uint(gtx_record(index, GTX_RECORD_PAGE).w));
#ifdef GTX_BLOCKS
    gtx_trimmed.z |= uint(level_of_detail) << 16;
#endif
#endif
    vec2 size = vec2(textureSize(gtx_normals, 0).xy);
    vec2 place = (rect.xy + clamp(at + 0.5, vec2(half_texel), rect.zw - half_texel)) / size;
    float page = gtx_record(index, GTX_RECORD_PAGE).w;
    float deviation = gtx_deviation_of(index, level);

    vec3 z = normalize(axis_z), x = normalize(axis_x - dot(axis_x, z) * z);
    mat3 world_normals = mat3(gtx_object_x.xyz, gtx_object_y.xyz, gtx_object_z.xyz);
#ifdef GTX_LIT
    vec3 p = gtx_decode_normal(textureLod(gtx_normals, vec3(place, page), level).xy);
    vec3 n = normalize(world_normals * (mat3(x, cross(z, x), z) * p));
    vec3 eye = gtx_view_eye(gtx_object_x, gtx_object_y, gtx_object_z);
    vec3 ray = normalize(gtx_to_world(object.xyz * gtx_depth.w - eye));
    if (gtx_lod_mesh.x > min(float(index), 0.0)) /* seen from behind; min as in gtx_shown */
        n = gtx_from_behind(n, ray);
    gtx_lit = gtx_tint;
#ifdef GTX_MATERIALS
    if (gtx_maps.y > 0.0)
        gtx_lit *= textureLod(gtx_colors, vec3(place, page), level);
#endif
#ifdef GTX_OWN_VERTICES
    gtx_lit = gtx_at_vertex(world, n, -ray, gtx_lit, deviation);
#elif defined(GTX_MATERIALS)
    gtx_material material = gtx_material_at(vec3(place, page), level, gtx_lit.rgb);
    gtx_lit.rgb = gtx_shown(gtx_shade(material, n, -ray, gtx_light.xyz, gtx_light.w, deviation));
#else
    float light = gtx_diffuse(n, -ray, gtx_light.xyz, deviation);
#ifndef GTX_PLAIN
    gtx_lit *= textureLod(gtx_colors, vec3(place, page), level);
#endif
    vec3 root = pow(max(gtx_lit.rgb, 0.0), vec3(1.0 / 2.4));
    gtx_lit.rgb = gtx_shown(root, gtx_light.w + (1.0 - gtx_light.w) * light);
#endif
#ifdef GTX_TRIMMED
    gtx_outline = gtx_trim_at(ivec2(rect.xy), ivec2(rect.zw), int(page), at);
#endif
#else
    gtx_at = place;
    gtx_page = vec3(page, level, deviation);
#ifdef GTX_FRONT
    mat3 frame = mat3(x, cross(z, x), z);
    vec3 toward = normalize(gtx_light.xyz * world_normals) * frame;
    gtx_toward = toward * (1.0 / deviation);
    vec3 eye = gtx_view_eye(gtx_object_x, gtx_object_y, gtx_object_z) - object.xyz * gtx_depth.w;
#ifdef GTX_BLOCKS
    gtx_eye = eye * frame;
#else
    eye = normalize(eye) * frame;
    gtx_eye = eye * (1.0 / deviation);
#endif
#if defined(GTX_MATERIALS) && !defined(GTX_BLOCKS)
    gtx_between = gtx_half_way(vec3(0.0, 0.0, 1.0), eye, toward);
#endif
#else
#ifndef GTX_VERTEX_NORMALS
    gtx_normal_x = world_normals * x;
    gtx_normal_y = world_normals * cross(z, x);
    gtx_normal_z = world_normals * z;
#elif defined(GTX_GRID)
    vec3 p = gtx_decode_normal(textureLod(gtx_normals, vec3(place, page), level).xy);
    gtx_normal = normalize(world_normals * (mat3(x, cross(z, x), z) * p));
#else
    gtx_normal = normalize(world_normals * gtx_octahedral(float(gtx_steps.w)));
#endif
    gtx_object = object.xyz;
    gtx_world = world;
    vec3 eye = gtx_view_eye(gtx_object_x, gtx_object_y, gtx_object_z);
    gtx_ray = gtx_to_world(object.xyz * gtx_depth.w - eye);
#ifndef GTX_BLOCKS
    gtx_ray = normalize(gtx_ray);
#endif
#ifdef GTX_VERTEX_NORMALS
    gtx_behind = gtx_turned(gtx_normal, gtx_ray);
#endif
    gtx_patch_index = index;
    gtx_id = gtx_instance;
#endif
    gtx_color = gtx_tint;
#if defined(GTX_VERTEX_NORMALS) && defined(GTX_GRID)
    if (gtx_maps.y > 0.0)
        gtx_color *= textureLod(gtx_colors, vec3(place, page), level);
#endif
#ifdef GTX_PLAIN
    gtx_color.rgb = pow(max(gtx_tint.rgb, 0.0), vec3(1.0 / 2.4));
#endif
#endif
}
#endif
