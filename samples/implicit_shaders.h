/* The shaders of implicit.c: a main for patches that cuts spheres out of them, and one for the
 * boxes of a torus and a ball with relief. */
#ifndef GTX_SAMPLES_IMPLICIT_SHADERS_H
#define GTX_SAMPLES_IMPLICIT_SHADERS_H

enum { HOLES = 4 };

static const char patch_main[] =
    "#ifdef GTX_LOD\n" /* polygons have no ray to go on with */
    "void main() { discard; }\n"
    "#else\n"
    "uniform vec4 holes[4];\n" /* centre and radius */
    "layout(location = 0) out vec4 color;\n"
    "vec3 origin, ray;\n" /* world; t is that of grid space */
    "float leave(float t) {\n" /* where the ray is outside the spheres again */
    "    float out_t = t;\n"
    "    for (int i = 0; i < 12; ++i) {\n"
    "        vec3 p = origin + out_t * ray - holes[i % 4].xyz;\n"
    "        float a = dot(ray, ray), b = dot(p, ray), r = holes[i % 4].w, c = dot(p, p) - r * r;\n"
    "        if (c < -1e-5) out_t += (sqrt(b * b - a * c) - b) / a;\n"
    "    }\n"
    "    return out_t;\n"
    "}\n"
    "void main() {\n"
    "    gtx_surface s;\n"
    "    if (!gtx_find(s)) discard;\n"
    "    ray = gtx_world * gtx_depth.w - gtx_world_eye;\n"
    "    origin = gtx_world;\n"
    "    s.field.reach = 1e30;\n" /* past what the hull tells of */
    "    vec3 n = vec3(0.0), base = vec3(0.60, 0.16, 0.10), point;\n"
    "    for (int i = 0; i < 8 && n == vec3(0.0); ++i) {\n"
    "        float t = leave(s.hit.t), t0 = s.hit.t + 1e-5, t1 = 1e30;\n"
    "        vec3 wall = origin + t * ray;\n"
    "        point = origin + s.hit.t * ray;\n"
    "        if (t == s.hit.t) {\n"
    "            n = gtx_world_normal(s);\n"
    "            base = gtx_albedo(s).rgb;\n"
    "        } else if (!gtx_occluded(wall, point - wall, 0.999)) {\n" /* left once: inside */
    "            for (int k = 0; k < 4; ++k)\n"
    "                if (abs(distance(wall, holes[k].xyz) - holes[k].w) < 1e-3)\n"
    "                    n = (holes[k].xyz - wall) / holes[k].w;\n"
    "            point = wall;\n"
    "            base *= 0.7 + 0.3 * step(0.5, fract(12.0 * wall.y));\n"
    "        } else {\n" /* the ray came out again before: on to where it goes in next */
    "            gtx_clip_box(s.field, gtx_point, s.ray, t0, t1);\n"
    "            if (t0 > t1 || !gtx_cast(s.field, gtx_point, s.ray, t0, t1, s.hit)) discard;\n"
    "        }\n"
    "    }\n"
    "    color = vec4(sqrt(base * (0.25 + 0.75 * max(dot(n, gtx_light.xyz), 0.0))), 1.0);\n"
    "    vec4 at = gtx_clip_from_world * vec4(point, 1.0);\n"
    "    gl_FragDepth = at.z / at.w * gtx_depth.y + gtx_depth.z;\n"
    "}\n"
    "#endif\n";

static const char relief_main[] =
    "uniform highp sampler2D relief;\n"
    "uniform mat4 clip;\n"
    "uniform vec4 eye, light;\n"
    "in vec3 world_point, world_normal;\n"
    "in vec4 srgb;\n"
    "layout(location = 0) out vec4 color;\n"
    "float height(vec2 at) { return 0.07 * textureLod(relief, at, 0.0).r; }\n"
    "float torus(vec3 p) {\n" /* gaps to the surfaces; angles are texture coordinates */
    "    p = vec3(p.x, 0.94 * p.y - 0.23 + 0.34 * p.z, 0.94 * p.z - 0.34 * p.y + 0.2);\n"
    "    vec2 q = vec2(length(p.xz) - 1.25, p.y);\n"
    "    vec2 at = vec2(atan(p.z, p.x) * 3.8197, atan(q.y, q.x) * 0.6366);\n"
    "    return length(q) - 0.17 - height(at);\n"
    "}\n"
    "float ball(vec3 p) {\n"
    "    p -= vec3(2.0, 0.5, 0.7);\n"
    "    float r = length(p), y = p.y / r;\n" /* no studs where meridians meet */
    "    return r - 0.6 - height(vec2(atan(p.z, p.x), asin(y)) * 1.9099) *\n"
    "                     (1.0 - smoothstep(0.7, 0.9, abs(y)));\n"
    "}\n"
    "float gap(vec3 p) { return min(torus(p), ball(p)); }\n"
    "void main() {\n"
    "    vec3 way = normalize(world_point - eye.xyz), p = eye.xyz;\n"
    "    float most = distance(world_point, eye.xyz), t = 0.0, d = 1.0;\n"
    "    for (int i = 0; i < 160 && d > 1e-4 && t < most; ++i, t += 0.6 * d)\n"
    "        d = gap(eye.xyz + t * way);\n"
    "    if (d > 1e-3 || t > most) discard;\n"
    "    p += t * way;\n"
    "    vec2 e = vec2(2e-3, 0.0);\n"
    "    vec3 n = normalize(vec3(gap(p + e.xyy) - gap(p - e.xyy),\n"
    "                            gap(p + e.yxy) - gap(p - e.yxy),\n"
    "                            gap(p + e.yyx) - gap(p - e.yyx)));\n"
    "    vec3 base = torus(p) < ball(p) ? vec3(0.80, 0.55, 0.16) : vec3(0.16, 0.40, 0.55);\n"
    "    color = vec4(sqrt(base * (0.25 + 0.75 * max(dot(n, light.xyz), 0.0))), 1.0);\n"
    "    vec4 at = clip * vec4(p, 1.0);\n"
    "    gl_FragDepth = at.z / at.w * 0.5 + 0.5;\n"
    "}\n";

#endif
