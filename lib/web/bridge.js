/* A renderer of three.js and its geotex: cameras, lights, fog and output, as the core draws by them.
 *
 * Of three's lights: directional ones with their shadows, ambient and hemisphere light; fog, tone
 * mapping and colour spaces as three has them, by its own shader chunks. */
import {AmbientLight, Box3, BufferAttribute, BufferGeometry, ColorManagement, DirectionalLight,
        HemisphereLight, Matrix3, Matrix4, NoToneMapping, Ray, ShaderChunk, SRGBColorSpace, Vector3,
        Vector4} from 'three';
import {Geotex} from './geotex.js';

const MOST_LIGHTS = 4, FIRST_UNIT = 8; /* units below are geotex's */
const VIEW_FLAGS_REVERSED = 3;         /* reversed, and depth from 0 to 1 */

/* Radiance as three's MeshStandardMaterial has it: light over pi. */
const SHADING = /* glsl */ `
layout(location = 0) out vec4 web_out;
uniform int web_lights, web_tone, web_srgb, web_fog;
uniform vec3 web_direction[${MOST_LIGHTS}], web_color[${MOST_LIGHTS}];
uniform vec3 web_ambient, web_sky, web_ground, web_up, web_fog_color, web_fog_reach;
uniform vec4 web_depth_row;
uniform mat4 web_shadow_matrix[${MOST_LIGHTS}];
uniform vec4 web_shadow[${MOST_LIGHTS}]; /* bias, normal bias, intensity, texel; 0: none */
uniform highp sampler2DShadow web_shadow_map[${MOST_LIGHTS}];
${ShaderChunk.tonemapping_pars_fragment}
/* 3 x 3 looks, each between four texels. */
float web_lit(highp sampler2DShadow map, mat4 matrix, vec4 shadow, vec3 point, vec3 n)
{
    vec4 at = matrix * vec4(point + n * shadow.y, 1.0);
    vec3 place = at.xyz / at.w + vec3(0.0, 0.0, shadow.x);
    if (shadow.z <= 0.0 || any(lessThan(place, vec3(0.0))) || any(greaterThan(place, vec3(1.0))))
        return 1.0;
    float sum = 0.0;
    for (int i = 0; i < 9; ++i)
        sum += textureLod(map, place + vec3(float(i % 3 - 1), float(i / 3 - 1), 0.0) * shadow.w,
                          0.0);
    return mix(1.0, sum / 9.0, shadow.z);
}

vec3 web_mapped(vec3 color)
{
    return web_tone == 1 ? LinearToneMapping(color)
           : web_tone == 2 ? ReinhardToneMapping(color)
           : web_tone == 3 ? CineonToneMapping(color)
           : web_tone == 4 ? ACESFilmicToneMapping(color)
           : web_tone == 6 ? AgXToneMapping(color)
           : web_tone == 7 ? NeutralToneMapping(color)
           : color;
}

void main()
{
    gtx_surface s;
    if (!gtx_find(s))
        discard;
    vec3 n = gtx_world_normal(s), eye = -gtx_world_ray(s), point = gtx_world_point(s);
    vec4 albedo = gtx_albedo(s);
    gtx_material m = gtx_material_of(s, albedo.rgb);
    vec3 emission = m.emission, diffuse = m.color * (1.0 - m.metallic);
    float lit = m.lit;
    m.emission = vec3(0.0);
    m.lit = 1.0;
    vec3 around = web_ambient + mix(web_ground, web_sky, 0.5 + 0.5 * dot(n, web_up));
    vec3 sum = diffuse * around * m.occlusion;
    float open[${MOST_LIGHTS}];
${[...Array(MOST_LIGHTS).keys()].map((i) => `    open[${i}] = web_lit(web_shadow_map[${i}], ` +
    `web_shadow_matrix[${i}], web_shadow[${i}], point, n);`).join('\n')}
    for (int i = 0; i < web_lights; ++i)
        sum += open[i] * web_color[i] *
               gtx_shade(m, n, eye, web_direction[i], 0.0, s.deviation);
    vec3 color = web_mapped(mix(m.color, sum * ${1 / Math.PI}, lit) + emission);
    if (web_srgb != 0)
        color = gtx_to_srgb(color);
    float depth = -dot(web_depth_row, vec4(point, 1.0));
    float fog = web_fog == 1 ? smoothstep(web_fog_reach.x, web_fog_reach.y, depth)
                : web_fog == 2 ? 1.0 - exp(-web_fog_reach.z * web_fog_reach.z * depth * depth)
                : 0.0;
    web_out = vec4(mix(color, web_fog_color, fog), albedo.a);
    gtx_write_depth(s);
}
`;

/* One for each renderer: the core, a shading, and a depth texture for lights without a shadow. */
export class Bridge {
  static #all = new WeakMap();

  static of(renderer, options) {
    if (!this.#all.has(renderer))
      this.#all.set(renderer, Geotex.create(renderer.getContext(), options)
          .then((geotex) => new Bridge(renderer, geotex)));
    return this.#all.get(renderer);
  }

  constructor(renderer, geotex) {
    Object.assign(this, {renderer, geotex, shading: geotex.shading(SHADING), frame: -1});
    this.begin();
    renderer.domElement.addEventListener?.('webglcontextrestored', () => this.begin());
  }

  begin() {
    const gl = this.geotex.gl;
    this.open = gl.createTexture();
    this.renderer.state.bindTexture(gl.TEXTURE_2D, this.open, gl.TEXTURE0 + FIRST_UNIT);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.DEPTH_COMPONENT16, 1, 1, 0, gl.DEPTH_COMPONENT,
                  gl.UNSIGNED_SHORT, new Uint16Array([65535]));
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    this.frame = -1;
  }

  light(scene, camera, receives) {
    const lights = [], ambient = [0, 0, 0], sky = [0, 0, 0], ground = [0, 0, 0];
    const up = new Vector3(0, 1, 0), at = new Vector3(), to = new Vector3();
    const add = (sum, color, intensity) =>
      color.toArray().forEach((c, k) => { sum[k] += c * intensity; });
    scene.traverseVisible((light) => {
      if (!light.isLight || !light.layers.test(camera.layers))
        return;
      if (light instanceof DirectionalLight && lights.length < MOST_LIGHTS)
        lights.push(light);
      else if (light instanceof HemisphereLight) {
        add(sky, light.color, light.intensity);
        add(ground, light.groundColor, light.intensity);
        up.setFromMatrixPosition(light.matrixWorld).normalize();
      } else if (light instanceof AmbientLight)
        add(ambient, light.color, light.intensity);
    });
    const rows = {directions: [], colors: [], matrices: [], shadows: []};
    lights.forEach((light, i) => {
      at.setFromMatrixPosition(light.matrixWorld)
          .sub(to.setFromMatrixPosition(light.target.matrixWorld)).normalize();
      rows.directions.push(...at.toArray());
      rows.colors.push(...light.color.toArray().map((c) => c * light.intensity));
      this.shadow(light, receives, i, rows);
    });
    for (let i = lights.length; i < MOST_LIGHTS; ++i) {
      rows.directions.push(0, 1, 0);
      rows.colors.push(0, 0, 0);
      this.shadow(null, false, i, rows);
    }
    return {
      web_lights: {int: lights.length}, web_ambient: ambient, web_sky: sky, web_ground: ground,
      web_up: up.toArray(), 'web_direction[0]': {vec3: rows.directions},
      'web_color[0]': {vec3: rows.colors}, 'web_shadow_matrix[0]': {mat4: rows.matrices},
      ...Object.fromEntries(rows.shadows)};
  }

  shadow(light, receives, i, rows) {
    const {renderer, geotex: {gl}} = this;
    const depth = light?.castShadow && receives && renderer.shadowMap.enabled &&
                  light.shadow.map?.depthTexture;
    const shown = depth && depth.compareFunction !== null &&
                  renderer.properties.get(depth).__webglTexture;
    const s = light?.shadow;
    rows.matrices.push(...(shown ? s.matrix : new Matrix4()).elements);
    rows.shadows.push([`web_shadow[${i}]`, shown ? [s.bias, s.normalBias, s.intensity ?? 1,
                                                    s.radius / s.mapSize.x] : [0, 0, 0, 0]],
                      [`web_shadow_map[${i}]`, {int: FIRST_UNIT + i}]);
    renderer.state.bindTexture(gl.TEXTURE_2D, shown || this.open, gl.TEXTURE0 + FIRST_UNIT + i);
  }

  output(scene, camera) {
    const {renderer} = this, target = renderer.getRenderTarget(), fog = scene.fog;
    const space = target ? (target.isXRRenderTarget ? target.texture.colorSpace
                                                    : ColorManagement.workingColorSpace)
                         : renderer.outputColorSpace;
    const color = {r: 0, g: 0, b: 0};
    fog?.color.getRGB(color, space);
    const e = camera.matrixWorldInverse.elements;
    return {
      web_tone: {int: target ? NoToneMapping : renderer.toneMapping},
      toneMappingExposure: renderer.toneMappingExposure,
      web_srgb: {int: space === SRGBColorSpace ? 1 : 0},
      web_fog: {int: fog ? (fog.isFogExp2 ? 2 : 1) : 0},
      web_fog_color: [color.r, color.g, color.b],
      web_fog_reach: [fog?.near ?? 0, fog?.far ?? 1, fog?.density ?? 0],
      web_depth_row: [e[2], e[6], e[10], e[14]]};
  }

  /* Instances in the forward pass. */
  show(object, scene, camera, more, instances) {
    this.shading.set({...this.light(scene, camera, object.receiveShadow),
                      ...this.output(scene, camera)});
    this.draw(object, camera, {...more, shading: this.shading}, instances);
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
