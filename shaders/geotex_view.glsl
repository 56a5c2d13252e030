/* The camera and the light of a draw: uniforms shared by the stock mains. */
GTX_UNIFORMS
GTX_UNIFORM mat4 gtx_clip_from_world;   /* the engine's projection * view */
GTX_UNIFORM vec4 gtx_depth;             /* x: clip z >= -x * w at the near plane (1 or 0);
                                           y, z: window depth = z_clip / w_clip * y + z;
                                           w: 1 perspective, 0 orthographic */
GTX_UNIFORM vec4 gtx_light;             /* xyz: world space, unit, towards the light; w: ambient */
GTX_UNIFORM vec4 gtx_detail;            /* x: pixels a world unit at clip w = 1, over the error
                                           allowed; y: 1 when what is nearer has the lesser
                                           window depth, -1 when the greater, 0 when neither;
                                           z: the level of boxes;
                                           w: the error allowed, in pixels */
GTX_UNIFORM vec4 gtx_search;            /* of geotex_paper.glsl, x, y: linear and binary steps;
                                           0: balanced */
GTX_UNIFORM vec4 gtx_maps;              /* x: last mip level of normals and colours; y: 1 when the
                                           model has colours; z: scale of its emission, or 0;
                                           w: 1 when it has materials */
GTX_UNIFORM vec4 gtx_lod_mesh;          /* of the LOD mesh's level, xyz: origin; w: step */
GTX_UNIFORM vec4 gtx_constant_material; /* of geotex_lod_front.frag, with GTX_CONSTANT */
GTX_UNIFORMS_END

/* Half way between light and eye, unit, and what of Schlick's Fresnel term depends on them.
 * Where they face each other it is n. All are unit and in one space. */
vec4 gtx_half_way(vec3 n, vec3 eye, vec3 light)
{
    vec3 h = normalize(light + eye + 1e-5 * n);
    float away = clamp(1.0 - dot(eye, h), 0.0, 1.0), square = away * away;
    return vec4(h, square * square * away);
}
