/* Proxies of instances: every fragment of a patch's hull or box gets its ray, in the patch's grid
 * space.
 *
 * Needs geotex_height_field.glsl and geotex_view.glsl before it. Hulls are rasterised by their
 * front faces, where the rays begin. Patches that the near plane cuts have boxes instead, by their
 * back faces, so that a camera inside still sees the patch; their rays are cut to the box and to
 * the near plane in the fragment. */
layout(location = 0) in vec3 gtx_position;  /* grid space */
layout(location = 1) in uint gtx_patch;     /* index + 2^28 * kind: 0 box, n hull of level n - 1 */
layout(location = 2) in vec4 gtx_world_x;   /* rows of object -> world, one set an instance */
layout(location = 3) in vec4 gtx_world_y;
layout(location = 4) in vec4 gtx_world_z;
layout(location = 5) in vec4 gtx_object_x;  /* xyz: rows of the inverse's linear part; w: the eye */
layout(location = 6) in vec4 gtx_object_y;  /* in object space, or against the view's direction */
layout(location = 7) in vec4 gtx_object_z;  /* when orthographic */
layout(location = 8) in vec4 gtx_tint;
layout(location = 9) in uint gtx_instance;  /* its id */

GTX_VARYING(0) out vec3 gtx_point;          /* grid space, on the hull */
GTX_VARYING(1) flat out vec3 gtx_eye;       /* the ray: gtx_point * gtx_depth.w - gtx_eye */
GTX_VARYING(2) flat out vec4 gtx_clip_z;    /* rows of grid -> clip */
GTX_VARYING(3) flat out vec4 gtx_clip_w;
GTX_VARYING(4) flat out vec3 gtx_normal_x;  /* the patch's normals -> world */
GTX_VARYING(5) flat out vec3 gtx_normal_y;
GTX_VARYING(6) flat out vec3 gtx_normal_z;
GTX_VARYING(7) flat out vec4 gtx_color;     /* where no map gives colours, the 2.4th root of rgb */
GTX_VARYING(8) flat out int gtx_patch_index;
GTX_VARYING(9) flat out vec4 gtx_rect;      /* what gtx_field_of takes: a fragment that misses */
GTX_VARYING(10) flat out vec4 gtx_span;     /* need not fetch the record */
GTX_VARYING(11) flat out int gtx_level;     /* of detail, the same all over the patch */
GTX_VARYING(12) flat out uint gtx_id;       /* of the instance */
GTX_VARYING(13) flat out float gtx_reach;   /* of the hull's rays; or a box: -1 - slabs */
GTX_VARYING(14) out vec3 gtx_world;         /* gtx_point in world space */
GTX_VARYING(15) flat out vec3 gtx_world_eye; /* the ray: gtx_world * gtx_depth.w - gtx_world_eye */

vec3 gtx_to_world(vec4 object)
{
    return vec3(dot(gtx_world_x, object), dot(gtx_world_y, object), dot(gtx_world_z, object));
}

/* A row over world space, taken to grid space. */
vec4 gtx_row(vec4 row, gtx_frame frame)
{
    vec4 object = row.x * gtx_world_x + row.y * gtx_world_y + row.z * gtx_world_z +
                  vec4(0.0, 0.0, 0.0, row.w);
    return vec4(dot(object.xyz, frame.axis_x), dot(object.xyz, frame.axis_y),
                dot(object.xyz, frame.axis_z), dot(object.xyz, frame.origin) + object.w);
}

/* A vertex of the box, which fits level 0, as far out as the cells of a coarser level need it. */
vec3 gtx_widen(vec3 position, vec4 rect, vec4 box, int level)
{
    vec2 cell = vec2(1 << level);
    vec2 low = floor(box.xy / cell) * cell - box.xy;
    vec2 high = min(ceil(box.zw / cell) * cell, rect.zw - 1.0) - box.zw;
    return position + vec3(mix(low, high, step(0.5 * (box.xy + box.zw), position.xy)), 0.0);
}

void main()
{
    int index = int(gtx_patch & 0x0fffffffu), kind = int(gtx_patch >> 28);
    gtx_frame frame = gtx_frame_of(index);
    gtx_rect = gtx_record(index, GTX_RECORD_RECT);
    if (kind > 0) {
        gtx_level = kind - 1;
        gtx_point = gtx_position;
        gtx_reach = gtx_record(index, GTX_RECORD_REACH + gtx_level / 4)[gtx_level % 4];
    } else {
        gtx_level = int(gtx_detail.z);
        gtx_point =
            gtx_widen(gtx_position, gtx_rect, gtx_record(index, GTX_RECORD_SOLID), gtx_level);
        gtx_reach = -1.0 - gtx_record(index, GTX_RECORD_SLABS + gtx_level / 4)[gtx_level % 4];
    }
    vec4 grid = vec4(gtx_point, 1.0);
    vec4 eye = vec4(gtx_view_eye(gtx_object_x, gtx_object_y, gtx_object_z), gtx_depth.w);
    mat4 rows = transpose(gtx_view_clip());
    gtx_eye = gtx_to_grid(index, eye);
    gtx_clip_z = gtx_row(rows[2], frame);
    gtx_clip_w = gtx_row(rows[3], frame);
    /* n_world = transpose(inverse) n: the inverse's rows are the columns. */
    vec3 z = normalize(frame.axis_z), x = normalize(frame.axis_x - dot(frame.axis_x, z) * z);
    mat3 world_normals = mat3(gtx_object_x.xyz, gtx_object_y.xyz, gtx_object_z.xyz);
    gtx_normal_x = world_normals * x;
    gtx_normal_y = world_normals * cross(z, x);
    gtx_normal_z = world_normals * z;
    gtx_world = gtx_to_world(vec4(gtx_object_point(frame, gtx_point), 1.0));
    gtx_world_eye = gtx_to_world(eye);
    gtx_id = gtx_instance;
    gtx_color = gtx_tint;
#ifdef GTX_PLAIN
    gtx_color.rgb = pow(max(gtx_tint.rgb, 0.0), vec3(1.0 / 2.4));
#endif
    gtx_patch_index = index;
    gtx_span = gtx_span_of(index);

    float w = dot(gtx_clip_w, grid);
    /* z in the middle of either clip convention: only the sides of the frustum cut the proxy. The
     * fragment writes its own depth. */
    gl_Position = vec4(dot(gtx_row(rows[0], frame), grid), dot(gtx_row(rows[1], frame), grid),
                       0.5 * w, w);
}
