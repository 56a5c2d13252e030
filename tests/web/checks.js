/* What must hold in a browser. Each check throws what is wrong, and may leave a picture. */
import * as THREE from 'three';
import {Geotex, GeotexError, Method, Pass} from 'geotex';
import {GeotexLoader, GeotexModel} from 'geotex/three';
import {facing} from './facing.js';
import {shadings} from './shadings.js';
import {streaming} from './streaming.js';
import {worlds} from './worlds.js';

const WIDTH = 480, HEIGHT = 360;
const address = new URLSearchParams(location.search).get('asset');
const bytes = await (await fetch(address)).arrayBuffer();

function expect(holds, what) {
  if (!holds)
    throw new Error(what);
}

function context() {
  const canvas = document.createElement('canvas');
  Object.assign(canvas, {width: WIDTH, height: HEIGHT});
  const gl = canvas.getContext('webgl2', {antialias: false, preserveDrawingBuffer: true});
  gl.enable(gl.DEPTH_TEST);
  return gl;
}

/* A camera that sees all of an asset, as two matrices. */
function cameraOf(asset, azimuth = 0.5, distance = 3) {
  const box = new THREE.Box3(new THREE.Vector3(...asset.min), new THREE.Vector3(...asset.max));
  const ball = box.getBoundingSphere(new THREE.Sphere()), r = ball.radius;
  const camera = new THREE.PerspectiveCamera(40, WIDTH / HEIGHT, r / 20, r * 20);
  camera.position.set(Math.sin(azimuth), 0.5, Math.cos(azimuth)).normalize()
      .multiplyScalar(r * distance).add(ball.center);
  camera.lookAt(ball.center);
  camera.updateMatrixWorld();
  return camera;
}

function viewOf(asset, more) {
  const camera = cameraOf(asset);
  return {view: camera.matrixWorldInverse.elements, projection: camera.projectionMatrix.elements,
          width: WIDTH, height: HEIGHT, ...more};
}

function read(gl) {
  const pixels = new Uint8Array(4 * WIDTH * HEIGHT);
  gl.readPixels(0, 0, WIDTH, HEIGHT, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return pixels;
}

function clear(gl) {
  gl.viewport(0, 0, WIDTH, HEIGHT);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
}

const covered = (pixels) => pixels.filter((_, i) => i % 4 === 3 && pixels[i] > 0).length;

/* Share of covered pixels in which two pictures differ by more than `step` of 255. */
function apart(a, b, step) {
  let differ = 0;
  for (let i = 0; i < a.length; i += 4)
    differ += [0, 1, 2, 3].some((k) => Math.abs(a[i + k] - b[i + k]) > step);
  return differ / Math.max(covered(a), 1);
}

const checks = {
  async every_method_draws_the_same() {
    const gl = context(), geotex = await Geotex.create(gl, {log: console.log});
    const asset = geotex.open(bytes), model = geotex.model(asset);
    const pictures = [Method.CAST, Method.AUTO, Method.LOD, Method.GRID]
        .map((method) => {
          clear(gl);
          geotex.draw(viewOf(asset, {method}), [{model}]);
          expect(gl.getError() === 0, 'WebGL reports an error');
          return read(gl);
        });
    expect(covered(pictures[0]) > WIDTH * HEIGHT / 10, 'nothing is drawn');
    pictures.forEach((picture, i) => {
      const off = apart(pictures[0], picture, 24);
      expect(off < 0.06, `method ${i}: ${(100 * off).toFixed(1)} % of the pixels differ`);
    });
    geotex.dispose();
    return gl.canvas;
  },

  async state_is_left_as_it_was() {
    const gl = context(), geotex = await Geotex.create(gl);
    const asset = geotex.open(bytes), model = geotex.model(asset);
    const array = gl.createVertexArray(), indices = gl.createBuffer(), texture = gl.createTexture();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
    gl.activeTexture(gl.TEXTURE3);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.enable(gl.BLEND);
    gl.depthFunc(gl.LEQUAL);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, true);
    geotex.draw(viewOf(asset), [{model}]);
    for (const [name, value] of [
      ['VERTEX_ARRAY_BINDING', array], ['ELEMENT_ARRAY_BUFFER_BINDING', indices],
      ['ACTIVE_TEXTURE', gl.TEXTURE3], ['TEXTURE_BINDING_2D', texture], ['BLEND', true],
      ['DEPTH_FUNC', gl.LEQUAL], ['UNPACK_FLIP_Y_WEBGL', true], ['CURRENT_PROGRAM', null]])
      expect(gl.getParameter(gl[name]) === value, name + ' has changed');
    geotex.dispose();
  },

  async broken_assets_are_refused_by_a_sentence() {
    const gl = context(), geotex = await Geotex.create(gl);
    const cut = bytes.slice(0, bytes.byteLength / 2), turned = new Uint8Array(bytes.slice(0));
    turned[turned.length >> 1] ^= 0x55;
    for (const [name, broken] of Object.entries({
      'not-gtx': new Uint8Array(100), truncated: cut, corrupt: turned, empty: new Uint8Array(0)})) {
      try {
        geotex.open(broken);
        expect(false, `${name}: opened`);
      } catch (error) {
        expect(error instanceof GeotexError && error.message.length > 10 && error.kind !== 'other' &&
               error.kind !== 'internal', `${name}: ${error.kind}: ${error.message}`);
      }
    }
    geotex.dispose();
  },

  async rays_meet_what_is_drawn() {
    const gl = context(), geotex = await Geotex.create(gl);
    const asset = geotex.open(bytes), model = geotex.model(asset), camera = cameraOf(asset);
    clear(gl);
    geotex.draw(viewOf(asset, {method: Method.CAST}), [{model}]);
    const pixels = read(gl), from = camera.position.toArray();
    let wrong = 0, hits = 0;
    for (let y = 4; y < HEIGHT; y += 8)
      for (let x = 4; x < WIDTH; x += 8) {
        const to = new THREE.Vector3((x + 0.5) / WIDTH * 2 - 1, (y + 0.5) / HEIGHT * 2 - 1, 0.5)
            .unproject(camera).sub(camera.position).normalize();
        const hit = asset.raycast(from, to.toArray());
        hits += hit ? 1 : 0;
        wrong += !!hit !== pixels[4 * (y * WIDTH + x) + 3] > 0 ? 1 : 0;
      }
    expect(hits > 100 && wrong <= hits / 100, `${wrong} of ${hits} rays see something else`);
    geotex.dispose();
  },

  async a_lost_context_comes_back() {
    const gl = context(), geotex = await Geotex.create(gl);
    const {asset, model} = await geotex.load(bytes);
    clear(gl);
    geotex.draw(viewOf(asset), [{model}]);
    const before = read(gl), lose = gl.getExtension('WEBGL_lose_context');
    const event = (name) => new Promise((done) =>
      gl.canvas.addEventListener(name, () => setTimeout(done, 50), {once: true}));
    const lost = event('webglcontextlost');
    lose.loseContext();
    await lost;
    geotex.draw(viewOf(asset), [{model}]);
    const restored = event('webglcontextrestored');
    lose.restoreContext();
    await restored;
    gl.enable(gl.DEPTH_TEST);
    clear(gl);
    geotex.draw(viewOf(asset), [{model}]);
    expect(apart(before, read(gl), 1) === 0, 'the picture is another');
    geotex.dispose();
  },

  async memory_is_back_after_fifty_loads() {
    const gl = context(), geotex = await Geotex.create(gl);
    const sizes = [];
    for (let i = 0; i < 50; ++i) {
      const asset = geotex.open(bytes), model = geotex.model(asset);
      model.upload();
      model.dispose();
      asset.dispose();
      sizes.push(geotex.core.HEAPU8.length);
    }
    expect(sizes[49] === sizes[1], `${sizes[1]} bytes have become ${sizes[49]}`);
    expect(geotex.core.GL.buffers.filter(Boolean).length < 20 &&
           geotex.core.GL.textures.filter(Boolean).length < 20, 'objects of WebGL are left');
    geotex.dispose();
  },

  async a_worker_opens_and_prepares() {
    const gl = context(), geotex = await Geotex.create(gl), {core} = geotex;
    const pictures = [], calls = [];
    for (const name of ['_gtxw_open', '_gtxw_open_prefix', '_gtxw_model_prepare']) {
      const call = core[name];
      core[name] = (...all) => {
        calls.push(name);
        return call(...all);
      };
    }
    for (const there of [true, false]) {
      const {asset, model} = await geotex.load(bytes);
      const part = await geotex.load(bytes.slice(0, 100000), {prefix: true});
      expect(part.model && part.needed > 100000 && part.fileBytes === bytes.byteLength, 'no prefix');
      expect(!calls.length === there, `here: ${calls}`);
      for (const m of [model, part.model]) {
        clear(gl);
        geotex.draw(viewOf(asset), [{model: m}]);
        pictures.push(read(gl));
      }
      expect(!calls.length === there, `to draw: ${calls}`);
      expect(asset.raycast(cameraOf(asset).position.toArray(), cameraOf(asset).getWorldDirection(
        new THREE.Vector3()).toArray()), 'a ray meets nothing');
      const why = await geotex.load(new Uint8Array(100)).then(() => null, (error) => error);
      expect(why instanceof GeotexError && why.kind === 'not-gtx', `${why?.kind}: ${why?.message}`);
      geotex.workshop.close();
    }
    expect(covered(pictures[0]) > WIDTH * HEIGHT / 10, 'nothing is drawn');
    expect(apart(pictures[0], pictures[2], 0) + apart(pictures[1], pictures[3], 0) === 0,
           'a worker makes something else');
    geotex.dispose();
  },

  async paint_stays_where_it_was_put() {
    const gl = context(), geotex = await Geotex.create(gl), {asset, model} = await geotex.load(bytes);
    const camera = cameraOf(asset), from = camera.position.toArray();
    const to = camera.getWorldDirection(new THREE.Vector3()).toArray();
    const shown = (method) => {
      clear(gl);
      geotex.draw(viewOf(asset, {method, ambient: 1}), [{model}]);
      expect(gl.getError() === 0, 'WebGL reports an error');
      return read(gl);
    };
    for (const method of [Method.CAST, Method.LOD]) {
      const before = shown(method), hit = asset.raycast(from, to);
      const color = method === Method.CAST ? [1, 0, 0] : [0, 0, 1], radius = asset.max[0] / 8;
      expect(model.paint(hit.point, radius, color), 'nothing is met');
      const after = shown(method), middle = 4 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
      const differ = apart(before, after, 8), painted = asset.raycast(from, to).color;
      expect(differ > 0.005 && differ < 0.3, `${(100 * differ).toFixed(1)} % are painted`);
      expect([0, 1, 2].every((k) => Math.abs(after[middle + k] - 255 * color[k]) < 70),
             `${after.slice(middle, middle + 3)} in the middle`);
      expect([0, 1, 2].every((k) => Math.abs(painted[k] - color[k]) < 0.2), `a ray sees ${painted}`);
    }
    expect(!model.paint([1e6, 0, 0], 1, [0, 0, 0]), 'something is met in nowhere');
    geotex.dispose();
    return gl.canvas;
  },

  async uploads_come_in_slices() {
    const gl = context(), geotex = await Geotex.create(gl);
    const asset = geotex.open(bytes), model = geotex.model(asset);
    let calls = 1;
    while (!model.upload(65536))
      ++calls;
    expect(calls > model.gpuBytes / 65536 / 2, `${calls} slices of ${model.gpuBytes} bytes`);
    geotex.dispose();
  },
};

/* ---- three.js ---- */

async function stage(shadows = false) {
  const renderer = new THREE.WebGLRenderer({preserveDrawingBuffer: true});
  renderer.setSize(WIDTH, HEIGHT, false);
  renderer.shadowMap.enabled = shadows;
  const scene = new THREE.Scene(), loader = new GeotexLoader(renderer);
  const model = await loader.loadAsync(address), camera = cameraOf(model.asset);
  const r = new THREE.Vector3(...model.asset.max).distanceTo(
    new THREE.Vector3(...model.asset.min)) / 2;
  scene.add(model);
  const close = () => { model.dispose(); renderer.dispose(); };
  return {renderer, scene, model, camera, r, gl: renderer.getContext(), close,
          center: new THREE.Box3().setFromObject(model).getCenter(new THREE.Vector3())};
}

Object.assign(checks, {
  async three_and_patches_share_one_depth() {
    const {renderer, scene, model, camera, r, center, gl, close} = await stage();
    scene.background = new THREE.Color(0x203040);
    const light = new THREE.DirectionalLight(0xffffff, 3);
    light.position.set(1, 2, 1.5);
    scene.add(light, new THREE.HemisphereLight(0xffffff, 0x604020, 0.6));
    const knot = new THREE.Mesh(new THREE.TorusKnotGeometry(r * 0.55, r * 0.07, 128, 16),
                                new THREE.MeshStandardMaterial({color: 0x3080d0}));
    knot.position.copy(center);
    scene.add(knot);
    renderer.render(scene, camera);
    expect(gl.getError() === 0, 'WebGL reports an error');
    const once = read(gl);
    renderer.render(scene, camera);
    expect(apart(once, read(gl), 0) === 0, 'a second frame differs');
    knot.visible = false;
    renderer.render(scene, camera);
    const without = read(gl);
    knot.visible = true;
    model.visible = false;
    renderer.render(scene, camera);
    const alone = read(gl);
    let front = 0, behind = 0;
    for (let i = 0; i < once.length; i += 4) {
      const is = (picture) => [0, 1, 2].every((k) => once[i + k] === picture[i + k]);
      front += is(alone) && !is(without);
      behind += is(without) && !is(alone);
    }
    expect(front > 500 && behind > 3000, `${front} pixels of the knot, ${behind} of the model`);
    model.visible = true;
    renderer.render(scene, camera);
    close();
    return renderer.domElement;
  },

  /* Under ambient light the asset has the colours that three gives a mesh of its colour. */
  async light_is_that_of_three() {
    const {renderer, scene, model, camera, r, gl, close} = await stage();
    const ball = new THREE.Mesh(new THREE.SphereGeometry(r * 0.2, 64, 32),
                                new THREE.MeshStandardMaterial({roughness: 1}));
    scene.add(new THREE.AmbientLight(0xff8040, 1.5));
    renderer.toneMapping = THREE.ACESFilmicToneMapping;
    renderer.toneMappingExposure = 1.3;
    scene.fog = new THREE.Fog(0x4060ff, r * 2, r * 6);
    const middle = (pixels) => {
      const at = 4 * ((HEIGHT >> 1) * WIDTH + (WIDTH >> 1));
      return [...pixels.slice(at, at + 3)];
    };
    renderer.render(scene, camera);
    const ours = middle(read(gl));
    const hit = new THREE.Raycaster();
    hit.setFromCamera(new THREE.Vector2(0, 0), camera);
    const [seen] = hit.intersectObject(model);
    expect(seen && seen.object === model, 'the raycaster meets nothing');
    expect(Math.abs(seen.distance - camera.position.distanceTo(seen.point)) < 1e-4 * r,
           'the distance is another');
    model.visible = false;
    ball.material.color.setRGB(...seen.color.slice(0, 3));
    ball.position.copy(seen.point).addScaledVector(hit.ray.direction, r * 0.2);
    scene.add(ball);
    renderer.render(scene, camera);
    const threes = middle(read(gl));
    expect(ours.every((c, k) => Math.abs(c - threes[k]) <= 12), `${ours} and three ${threes}`);
    close();
  },

  async shadows_are_cast_and_received() {
    const {renderer, scene, model, camera, r, center, gl, close} = await stage(true);
    const light = new THREE.DirectionalLight(0xffffff, 3);
    light.position.copy(center).add(new THREE.Vector3(r, 2 * r, r));
    light.target.position.copy(center);
    light.castShadow = true;
    Object.assign(light.shadow.camera, {left: -2 * r, right: 2 * r, top: 2 * r, bottom: -2 * r,
                                        near: 0.1 * r, far: 8 * r});
    light.shadow.mapSize.set(1024, 1024);
    light.shadow.normalBias = 0.02 * r;
    const floor = new THREE.Mesh(new THREE.PlaneGeometry(8 * r, 8 * r),
                                 new THREE.MeshStandardMaterial({color: 0x808080, roughness: 1}));
    floor.rotation.x = -Math.PI / 2;
    floor.position.copy(center).setY(model.asset.min[1]);
    floor.receiveShadow = true;
    const bar = new THREE.Mesh(new THREE.BoxGeometry(0.12 * r, 0.12 * r, 4 * r),
                               new THREE.MeshStandardMaterial({color: 0xd08030}));
    bar.position.copy(center).add(new THREE.Vector3(0.3 * r, 1.1 * r, 0));
    bar.castShadow = true;
    scene.add(light, light.target, new THREE.AmbientLight(0xffffff, 0.5), floor, bar);
    const frame = () => {
      renderer.render(scene, camera);
      expect(gl.getError() === 0, 'WebGL reports an error');
      return read(gl);
    };
    const darker = (a, b) => a.filter((c, i) => i % 4 === 1 && c > b[i] + 30).length;
    const none = frame();
    model.castShadow = true;
    const cast = frame();
    model.receiveShadow = true;
    const both = frame();
    expect(darker(none, cast) > 1000, `casting darkens ${darker(none, cast)} pixels`);
    expect(darker(cast, both) > 1000, `receiving darkens ${darker(cast, both)} pixels`);
    expect(darker(cast, none) + darker(both, cast) === 0, 'shadows give light');
    close();
    return renderer.domElement;
  },

  async clones_share_and_out_of_view_is_culled() {
    const {renderer, scene, model, camera, r, gl, close} = await stage();
    scene.add(new THREE.HemisphereLight(0xffffff, 0x404040, 3));
    const second = model.clone();
    second.position.x = 1.2 * r;
    scene.add(second);
    expect(second instanceof GeotexModel && second.model === model.model, 'no clone');
    renderer.render(scene, camera);
    const two = covered(read(gl).map((c, i) => i % 4 === 3 ? 0 : c).map((c, i, a) =>
      i % 4 === 3 ? a[i - 1] + a[i - 2] + a[i - 3] : c));
    let drawn = 0;
    const draw = second.onAfterRender;
    second.onAfterRender = (...all) => { ++drawn; draw(...all); };
    second.position.x = 100 * r;
    renderer.render(scene, camera);
    expect(drawn === 0, 'what is out of view is drawn');
    expect(two > WIDTH * HEIGHT / 8, `${two} pixels of two`);
    close();
  },
});

const kit = {expect, address, context, clear, cameraOf, viewOf, read, covered, apart, WIDTH, HEIGHT};
Object.assign(checks, facing(kit), shadings(kit), streaming(kit), worlds(kit));
window.checks = checks;
window.run = async (name) => {
  try {
    const canvas = await checks[name]();
    return {picture: canvas ? canvas.toDataURL() : null};
  } catch (error) {
    return {fault: String(error.message ?? error)};
  }
};
