/* The camera and the light of a draw: uniforms that the stock mains share, and what they do with
 * them. */
/* Of the eye's direction, which hardly changes over a small triangle; those of a block that a GPU
 * displaces may be large. */
#ifdef GTX_BLOCKS
#define GTX_STEADY
#else
#define GTX_STEADY flat
#endif

GTX_BLOCK(8, gtx_uniforms)
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
                                           0: balanced; z: 1 when mains write linear colours */
GTX_UNIFORM vec4 gtx_maps;              /* x: last mip level of normals and colours; y: 1 when the
                                           model has colours; z: scale of its emission, or 0;
                                           w: 1 when it has materials */
GTX_UNIFORM vec4 gtx_lod_mesh;          /* of the LOD mesh's level, xyz: origin; w: step */
GTX_UNIFORM vec4 gtx_constant_material; /* of geotex_lod_front.frag, with GTX_CONSTANT */
#ifdef GTX_MULTIVIEW
GTX_UNIFORM mat4 gtx_other_clip_from_world; /* of the second view, and its eye less the first's */
GTX_UNIFORM vec4 gtx_other_eye;
#endif
GTX_BLOCK_END

/* Of the view that a vertex is drawn in: its clip space, and the eye in an instance's object space,
 * of which the first view's is told with the rows of world -> object. */
mat4 gtx_view_clip()
{
#ifdef GTX_MULTIVIEW
    return gl_ViewIndex == 0 ? gtx_clip_from_world : gtx_other_clip_from_world;
#else
    return gtx_clip_from_world;
#endif
}

vec3 gtx_view_eye(vec4 x, vec4 y, vec4 z)
{
    vec3 eye = vec3(x.w, y.w, z.w);
#ifdef GTX_MULTIVIEW
    vec3 step = gtx_other_eye.xyz * float(gl_ViewIndex);
    eye += vec3(dot(x.xyz, step), dot(y.xyz, step), dot(z.xyz, step));
#endif
    return eye;
}

/* In standard deviations of normals: how little the facets that are seen face the eye, and how near
 * the terminator some of them are on its other side. PSNR inside the outline to 8x8 samples, on
 * bunny, armadillo and dragon at 100 and 200 pixels: the first at 0.25 is up to 0.3 dB better for
 * LOD meshes and up to 0.5 dB worse for what is cast, whose rims glow; at 1, up to 0.5 dB worse for
 * LOD meshes, whose rims stay dark. The second follows from Gaussian slopes; with light from the
 * side, 0.8 is a code too dark, and 3.2 costs 1 to 2 dB. */
#define GTX_LEAST_SEEN 0.5
#define GTX_TERMINATOR 1.6

/* The least deviation told of: less is none. */
#define GTX_LEAST_DEVIATION 1e-3

/* Diffuse light of normals that stray by `deviation` (gtx_surface) about n: the mean of what
 * facets reflect, each as large as the eye sees it, to the second order. Facing the eye that is
 * darker than n alone, for some facets turn away from the light; obliquely it is lighter, for those
 * that turn to the eye hide the others (Oren and Nayar 1994). nl and nv are the cosines of n with
 * light and eye, over the deviation; lv is that between light and eye. */
float gtx_diffuse(float nl, float nv, float lv, float deviation)
{
    float mean = nl * (1.0 - 2.0 * deviation * deviation) + lv / max(nv, GTX_LEAST_SEEN);
    float above = clamp(mean + GTX_TERMINATOR, 0.0, 2.0 * GTX_TERMINATOR);
    return deviation * max(mean, above * above * (0.25 / GTX_TERMINATOR));
}

/* All are unit and in one space. */
float gtx_diffuse(vec3 n, vec3 eye, vec3 light, float deviation)
{
#if (defined(GTX_VERTEX_NORMALS) && !defined(GTX_GRID)) || defined(GTX_OWN_VERTICES)
    if (deviation == GTX_LEAST_DEVIATION)
        return max(dot(n, light), 0.0);
#endif
    float inverse = 1.0 / deviation;
    return gtx_diffuse(dot(n, light) * inverse, dot(n, eye) * inverse, dot(light, eye), deviation);
}

/* Half way between light and eye, unit, and what of Schlick's Fresnel term depends on them.
 * Where they face each other it is n. All are unit and in one space. */
vec4 gtx_half_way(vec3 n, vec3 eye, vec3 light)
{
    vec3 h = normalize(light + eye + 1e-5 * n);
    float away = clamp(1.0 - dot(eye, h), 0.0, 1.0), square = away * away;
    return vec4(h, square * square * away);
}

/* A normal in its patch's frame, not normalised, from two bytes in 0..1. */
vec3 gtx_decode_normal(vec2 code)
{
    vec2 e = code * 2.0 - 1.0;
    vec2 p = vec2(e.x + e.y, e.x - e.y) * 0.5;
    return vec3(p, 1.0 - abs(p.x) - abs(p.y));
}

/* The cosine with the ray below which a back may be the rim of an outline, which the height field
 * overshoots by less than a texel. On a bunny, 640 pixels, light from the side: without it backs at
 * outlines cost 0.2 dB; 0.6 gains no more, and lights open sheets wrongly. */
#define GTX_RIM 0.1

/* The normal of a height field seen from behind along `ray`, unit: it turns round, as a two-sided
 * mesh's does. But where the height field sticks out a little from behind the visible one, that
 * would light it from the wrong side: towards an outline it is mirrored in the picture plane, which
 * is continuous across. As shares of n and of the ray. */
vec2 gtx_turned(vec3 n, vec3 ray)
{
    float away = max(dot(n, ray), 0.0), behind = smoothstep(0.0, GTX_RIM, away);
    return vec2(1.0 - 2.0 * behind, -2.0 * away * (1.0 - behind));
}

vec3 gtx_from_behind(vec3 n, vec3 ray)
{
    vec2 turned = gtx_turned(n, ray);
    return n * turned.x + ray * turned.y;
}

/* x^(1 / 2.4) by its fourth root, within a tenth of a byte from 0.003 to 1: two square roots and a
 * polynomial are a fraction of a power. */
vec3 gtx_root(vec3 x)
{
    vec3 s = sqrt(sqrt(x));
    return s * (0.11164 + s * (1.27068 + s * (0.17171 * s - 0.55377)));
}

/* sRGB of a colour times a share of light, from the colour's 2.4th root: one root instead of
 * three. Where sRGB is linear, near black, a polynomial is within a tenth of a byte of it. */
vec3 gtx_shaded_to_srgb(vec3 root, float share)
{
    vec3 r = min(root * gtx_root(vec3(share)), 1.0);
    return mix(1.055 * r - 0.055, 12.92 * r * r * (0.197 + 2.05 * r),
               vec3(lessThan(r, vec3(0.0904))));
}

/* What stock mains write of a linear colour, and of a share of light times a colour, of which they
 * have the 2.4th root. What is below 0 is there for lavapipe alone: where uniforms decide by
 * themselves it compiles the shader anew, for what they are, each time that others are bound. */
vec3 gtx_shown(vec3 color)
{
    if (gtx_search.z > min(color.x, 0.0))
        return color;
    color = clamp(color, 0.0, 1.0);
    return mix(1.055 * gtx_root(color) - 0.055, 12.92 * color,
               vec3(lessThan(color, vec3(0.0031308))));
}

vec3 gtx_shown(vec3 root, float share)
{
    if (gtx_search.z > min(share, 0.0))
        return pow(root, vec3(2.4)) * share;
    return gtx_shaded_to_srgb(root, share);
}
