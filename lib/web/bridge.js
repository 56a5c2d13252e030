/* A renderer of three.js and its geotex: cameras, lights, fog and output, as the core draws by them.
 *
 * Of three's lights: directional ones with their shadows, ambient and hemisphere light; fog, tone
 * mapping and colour spaces as three has them, by its own shader chunks. */
import {AmbientLight, Box3, BufferAttribute, BufferGeometry, Camera, ColorManagement,
        DirectionalLight, HemisphereLight, Matrix3, Matrix4, Mesh, RawShaderMaterial, Ray, ShaderChunk,
        SRGBColorSpace, Vector3, Vector4} from 'three';
import {Geotex} from './geotex.js';

const MAX_LIGHTS = 4, FIRST_UNIT = 8; /* units below are geotex's */
const VIEW_FLAGS_REVERSED = 3;         /* reversed, and depth from 0 to 1 */
/* By three's numbers; a custom one stays linear. */
const TONES = ['', 'Linear', 'Reinhard', 'Cineon', 'ACESFilmic', '', 'AgX', 'Neutral'];

/* Radiance as three's MeshStandardMaterial has it: light over pi. What a scene lacks is left out, as
 * three does: rasterizers in software go through both sides of a branch. */
const shadingText = ({lights, shadows, tone, srgb, fog, color, material}) => /* glsl */ `
${shadows ? '' : '#pragma geotex vertices'}
uniform vec3 web_ambient, web_sky, web_ground, web_up;
${lights ? `uniform vec3 web_direction[${lights}], web_color[${lights}];` : ''}
${shadows ? `uniform mat4 web_shadow_matrix[${shadows}];
uniform vec4 web_shadow[${shadows}]; /* bias, normal bias, intensity, texel */
uniform highp sampler2DShadow web_shadow_map[${shadows}];
/* 3 x 3 looks, each between four texels. */
float web_lit(highp sampler2DShadow map, mat4 matrix, vec4 shadow, vec3 point, vec3 n)
{
    vec4 at = matrix * vec4(point + n * shadow.y, 1.0);
    vec3 place = at.xyz / at.w + vec3(0.0, 0.0, shadow.x);
    if (any(lessThan(place, vec3(0.0))) || any(greaterThan(place, vec3(1.0))))
        return 1.0;
    float sum = 0.0;
    for (int i = 0; i < 9; ++i)
        sum += textureLod(map, place + vec3(float(i % 3 - 1), float(i / 3 - 1), 0.0) * shadow.w,
                          0.0);
    return mix(1.0, sum / 9.0, shadow.z);
}` : ''}
${tone ? ShaderChunk.tonemapping_pars_fragment : ''}
${fog ? 'uniform vec3 web_fog_color, web_fog_reach; uniform vec4 web_depth_row;' : ''}
vec3 web_shade(gtx_material m, vec3 n, vec3 eye, vec3 light, float deviation)
{
#if defined(GTX_OWN_VERTICES) || ${+!material} /* the same of what is rough and no metal */
    float nl = max(dot(n, light), 0.0), f = 0.04 + 0.96 * gtx_half_way(n, eye, light).w;
    return m.color * ((1.0 - f) * gtx_diffuse(n, eye, light, deviation)) +
           f * 0.5 * nl / max(nl + max(dot(n, eye), 1e-3), 1e-6);
#else
    return gtx_shade(m, n, eye, light, 0.0, deviation);
#endif
}
vec4 web_shown(vec3 point, vec3 n, vec3 eye, gtx_material m, float alpha, float deviation)
{
    vec3 emission = m.emission;
    float lit = m.lit;
    m.emission = vec3(0.0);
    m.lit = 1.0;
    vec3 around = web_ambient + mix(web_ground, web_sky, 0.5 + 0.5 * dot(n, web_up));
    vec3 sum = m.color * (1.0 - m.metallic) * around * m.occlusion;
${[...Array(lights).keys()].map((i) => `    sum += ` + (i < shadows ?
    `web_lit(web_shadow_map[${i}], web_shadow_matrix[${i}], web_shadow[${i}], point, n) * ` : '') +
    `web_color[${i}] * web_shade(m, n, eye, web_direction[${i}], deviation);`).join('\n')}
    vec3 color = mix(m.color, sum * ${1 / Math.PI}, lit) + emission;
    ${tone ? `color = ${tone}ToneMapping(color);` : ''}
    ${srgb ? 'color = gtx_to_srgb(color);' : ''}
    ${fog ? `float depth = -dot(web_depth_row, vec4(point, 1.0));
    color = mix(color, web_fog_color, ${fog === 1 ? 'smoothstep(web_fog_reach.x, web_fog_reach.y, depth)'
        : '1.0 - exp(-web_fog_reach.z * web_fog_reach.z * depth * depth)'});` : ''}
    return vec4(color, alpha);
}
gtx_material web_plain(vec3 color)
{
    return gtx_material(color, vec3(0.0), 1.0, 1.0, 0.0, 1.0);
}
#ifdef GTX_OWN_VERTICES
vec4 gtx_at_vertex(vec3 point, vec3 n, vec3 eye, vec4 albedo, float deviation)
{
    return web_shown(point, n, eye, web_plain(albedo.rgb), albedo.a, deviation);
}
#else
layout(location = 0) out vec4 web_out;
void main()
{
    gtx_surface s;
    if (!gtx_find(s))
        discard;
    vec4 albedo = ${color ? 'gtx_albedo(s)' : 'gtx_color'};
    web_out = web_shown(gtx_world_point(s), gtx_world_normal(s), -gtx_world_ray(s),
                        ${material ? 'gtx_material_of(s, albedo.rgb)' : 'web_plain(albedo.rgb)'},
                        albedo.a, s.deviation);
    gtx_write_depth(s);
}
#endif
`;

/* One for each renderer: the core, and shadings by what they take into account. */
export class Bridge {
  static #all = new WeakMap();
  #shadings = new Map();

  static of(renderer, options) {
    if (!this.#all.has(renderer))
      this.#all.set(renderer, Geotex.create(renderer.getContext(), options)
          .then((geotex) => new Bridge(renderer, geotex)));
    return this.#all.get(renderer);
  }

  /* What three draws of a model: nothing, by a program that is there before any bytes are. */
  constructor(renderer, geotex) {
    const material = new RawShaderMaterial({
      colorWrite: false, depthWrite: false, fragmentShader: 'void main() {}',
      vertexShader: 'void main() { gl_Position = vec4(0.0); }'});
    material.dispose = () => {}; /* of a model's, by whoever clears a scene: others have it */
    Object.assign(this, {renderer, geotex, material});
    renderer.compile(new Mesh(new BufferGeometry(), material), new Camera());
  }

  /* Compiled when first needed, and kept. */
  shadingOf(look) {
    const key = JSON.stringify(look);
    if (!this.#shadings.has(key))
      this.#shadings.set(key, this.geotex.shading(shadingText(look), true));
    return this.#shadings.get(key);
  }

  /* The texture of a light's shadow map, if it casts one that three compares by. */
  shadowOf(light) {
    const {renderer} = this;
    const depth = light.castShadow && renderer.shadowMap.enabled && light.shadow.map?.depthTexture;
    return depth && depth.compareFunction !== null &&
           renderer.properties.get(depth).__webglTexture;
  }

  /* Into `look`, and the uniforms that go with it. Lights with a shadow come first. */
  light(scene, camera, receives, look) {
    const lights = [], ambient = [0, 0, 0], sky = [0, 0, 0], ground = [0, 0, 0];
    const up = new Vector3(0, 1, 0), at = new Vector3(), to = new Vector3();
    const add = (sum, color, intensity) =>
      color.toArray().forEach((c, k) => { sum[k] += c * intensity; });
    scene.traverseVisible((light) => {
      if (!light.isLight || !light.layers.test(camera.layers))
        return;
      if (light instanceof DirectionalLight && lights.length < MAX_LIGHTS)
        lights.push({light, map: receives && this.shadowOf(light)});
      else if (light instanceof HemisphereLight) {
        add(sky, light.color, light.intensity);
        add(ground, light.groundColor, light.intensity);
        up.setFromMatrixPosition(light.matrixWorld).normalize();
      } else if (light instanceof AmbientLight)
        add(ambient, light.color, light.intensity);
    });
    lights.sort((a, b) => !a.map - !b.map);
    look.lights = lights.length;
    look.shadows = lights.filter(({map}) => map).length;
    const out = {web_ambient: ambient, web_sky: sky, web_ground: ground, web_up: up.toArray()};
    const {gl} = this.geotex;
    lights.forEach(({light, map}, i) => {
      at.setFromMatrixPosition(light.matrixWorld)
          .sub(to.setFromMatrixPosition(light.target.matrixWorld)).normalize();
      out[`web_direction[${i}]`] = at.toArray();
      out[`web_color[${i}]`] = light.color.toArray().map((c) => c * light.intensity);
      if (!map)
        return;
      const s = light.shadow;
      out[`web_shadow_matrix[${i}]`] = s.matrix.elements;
      out[`web_shadow[${i}]`] = [s.bias, s.normalBias, s.intensity ?? 1, s.radius / s.mapSize.x];
      out[`web_shadow_map[${i}]`] = {int: FIRST_UNIT + i};
      this.renderer.state.bindTexture(gl.TEXTURE_2D, map, gl.TEXTURE0 + FIRST_UNIT + i);
    });
    return out;
  }

  output(scene, camera, look) {
    const {renderer} = this, target = renderer.getRenderTarget(), fog = scene.fog;
    const space = target ? (target.isXRRenderTarget ? target.texture.colorSpace
                                                    : ColorManagement.workingColorSpace)
                         : renderer.outputColorSpace;
    look.tone = !target && TONES[renderer.toneMapping] || '';
    look.srgb = space === SRGBColorSpace;
    look.fog = fog ? fog.isFogExp2 ? 2 : 1 : 0;
    const out = look.tone ? {toneMappingExposure: renderer.toneMappingExposure} : {};
    if (!fog)
      return out;
    const color = fog.color.getRGB({}, space), e = camera.matrixWorldInverse.elements;
    return {...out, web_fog_color: [color.r, color.g, color.b],
            web_fog_reach: [fog.near ?? 0, fog.far ?? 1, fog.density ?? 0],
            web_depth_row: [e[2], e[6], e[10], e[14]]};
  }

  /* Instances in the forward pass. */
  show(object, scene, camera, material, more, instances) {
    const look = {
      color: instances.some(({model}) => model.asset.hasColor),
      material: instances.some(({model: {asset}}) => asset.hasMaterial || asset.hasEmission)};
    const uniforms = {...this.light(scene, camera, object.receiveShadow, look),
                      ...this.output(scene, camera, look)};
    const shading = this.shadingOf(look);
    shading.set(uniforms);
    const {gl} = this.geotex, {depth} = this.renderer.state.buffers;
    /* What three has set for it, unless the scene overrides its material. */
    const known = material === object.material ? {
      depthFunc: depth.getReversed?.() ? gl.GEQUAL : gl.LEQUAL, depthMask: material.depthWrite,
      colorMask: Array(4).fill(material.colorWrite),
      cullFace: gl.BACK, frontFace: object.matrixWorld.determinant() < 0 ? gl.CW : gl.CCW} : {};
    this.draw(object, camera, {...more, shading, known}, instances);
  }

  draw(object, camera, more, instances) {
    const {renderer} = this, viewport = renderer.getCurrentViewport(new Vector4());
    this.geotex.draw({
      view: camera.matrixWorldInverse.elements, projection: camera.projectionMatrix.elements,
      width: viewport.z, height: viewport.w, maxError: object.maxError,
      flags: renderer.state.buffers.depth.getReversed?.() ? VIEW_FLAGS_REVERSED : 0, ...more,
    }, instances);
  }
}

/* Stands in three's lists for the patches: the corners of their bounds, of which nothing is drawn,
 * so that three culls, sorts and measures it as any mesh. */
export function boundsOf({min, max}) {
  const corners = [];
  for (let i = 0; i < 8; ++i)
    for (let k = 0; k < 3; ++k)
      corners.push((i >> k & 1 ? max : min)[k]);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(corners), 3));
  geometry.setDrawRange(0, 0);
  return geometry;
}

/* Where three's ray meets an asset that stands at a matrix, as an intersection with the object. */
export function meet(asset, matrix, object, raycaster, intersects) {
  const inverse = new Matrix4().copy(matrix).invert();
  const ray = new Ray().copy(raycaster.ray).applyMatrix4(inverse);
  const direction = raycaster.ray.direction.clone().transformDirection(inverse);
  const box = new Box3(new Vector3(...asset.min), new Vector3(...asset.max));
  if (!ray.intersectsBox(box))
    return;
  const hit = asset.raycast(ray.origin.toArray(), direction.toArray());
  if (!hit)
    return;
  const point = new Vector3(...hit.point).applyMatrix4(matrix);
  const distance = point.distanceTo(raycaster.ray.origin);
  if (distance < raycaster.near || distance > raycaster.far)
    return;
  const normal = new Vector3(...hit.normal);
  intersects.push({
    distance, point, object, face: {normal, a: 0, b: 0, c: 0, materialIndex: 0},
    normal: normal.clone().applyMatrix3(new Matrix3().getNormalMatrix(matrix)).normalize(),
    color: hit.color});
}
