/* An asset beside its mesh as Draco and meshopt in three.js: what a page's reader waits for, and pays. */
import * as THREE from 'three';
import {DRACOLoader} from 'three/addons/loaders/DRACOLoader.js';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';
import {MeshoptDecoder} from 'three/addons/libs/meshopt_decoder.module.js';
import {GeotexLoader} from 'geotex/three';

const WIDTH = 640, HEIGHT = 480, FRAMES = 15;
const MAX_APART = 1e-4, CODES = 2;   /* of pixels; as much as no picture of "full" is off */
const QUIET = 1500;                   /* ms without a finer model: the view has all that it needs */
const renderer = new THREE.WebGLRenderer({preserveDrawingBuffer: true});
renderer.setSize(WIDTH, HEIGHT, false);
const gl = renderer.getContext(), scene = new THREE.Scene();
scene.background = new THREE.Color(0x0000ff);
const camera = new THREE.PerspectiveCamera(40, WIDTH / HEIGHT, 0.01, 10);
const light = new THREE.DirectionalLight(0xffffff, 2);
light.position.set(1, 2, 1.5);
scene.add(light, new THREE.HemisphereLight(0xffffff, 0x604020, 0.4));
const ours = new GeotexLoader(renderer);
const draco = new DRACOLoader().setDecoderPath('/modules/three/examples/jsm/libs/draco/').preload();
const glb = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);

/* Tasks of more than 50 ms, but those of frames, for which the page waits here. */
const tasks = [], frames = [];
const seen = (list) => tasks.push(...list.map((t) => [t.startTime, t.startTime + t.duration]));
const observer = new PerformanceObserver((list) => seen(list.getEntries()));
observer.observe({entryTypes: ['longtask']});
function longest(from, to) {
  seen(observer.takeRecords());
  return Math.max(0, ...tasks.filter(([a, b]) => a >= from && b <= to &&
      !frames.some(([c, d]) => c < b && a < d)).map(([a, b]) => b - a));
}

/* All look at the model from where the first of them did. */
let ball = null;
function look(object) {
  ball ??= new THREE.Box3().setFromObject(object).getBoundingSphere(new THREE.Sphere());
  Object.assign(camera, {near: ball.radius / 20, far: ball.radius * 20});
  camera.position.set(0.5, 0.5, 0.9).normalize().multiplyScalar(3 * ball.radius).add(ball.center);
  camera.lookAt(ball.center);
  camera.updateProjectionMatrix();
}

/* Until it is in the picture: a pixel is read, so that the GPU has ended. */
function frame(object) {
  const begin = performance.now();
  look(object);
  scene.add(object);
  renderer.render(scene, camera);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  scene.remove(object);
  frames.push([begin, performance.now()]);
  return performance.now() - begin;
}

function picture() {
  const out = new Uint8Array(4 * WIDTH * HEIGHT);
  gl.readPixels(0, 0, WIDTH, HEIGHT, gl.RGBA, gl.UNSIGNED_BYTE, out);
  return out;
}

/* The share of pixels that differ, and the intersection over union of what is not background. */
function compare(a, b) {
  let apart = 0, both = 0, either = 0;
  for (let i = 0; i < a.length; i += 4) {
    apart += [0, 1, 2].some((k) => Math.abs(a[i + k] - b[i + k]) > CODES);
    const [x, y] = [a, b].map((p) => p[i] + p[i + 1] > 0 || p[i + 2] !== 255);
    both += x && y;
    either += x || y;
  }
  return {apart: apart / (WIDTH * HEIGHT), iou: both / either, shown: either};
}

/* dB, where one of them shows the model. */
function psnr(a, b) {
  let sum = 0, count = 0;
  for (let i = 0; i < a.length; i += 4) {
    if (![a, b].some((p) => p[i] + p[i + 1] > 0 || p[i + 2] !== 255))
      continue;
    count += 3;
    for (let k = 0; k < 3; ++k)
      sum += (a[i + k] - b[i + k]) ** 2;
  }
  return 10 * Math.log10(255 ** 2 * count / sum);
}

/* Its worker and its modules are files of their own; where there are none it is not asked for. */
const nexus = (name) => import('/folder/nexus/' + name);

const later = (ms) => new Promise((next) => setTimeout(next, ms));

const ways = {
  /* Drawn anew with each finer model; all that frames need is there once none comes. */
  async gtx(url, shown, maxError) {
    let bytes = 0, changed = performance.now();
    const came = (come) => {
      bytes = come;
      changed = performance.now();
    };
    const model = await ours.stream(url, came), pictures = [];
    model.maxError = maxError;
    let last = null;
    for (; !last || performance.now() - changed < QUIET && !model.content.whole; await later(5)) {
      if (model.model === last)
        continue;
      last = model.model;
      shown(model);
      changed = performance.now();
      pictures.push({at: changed, picture: picture(), bytes});
    }
    if (model.model !== last) {
      shown(model);
      pictures.push({at: performance.now(), picture: picture(), bytes});
    }
    /* The module's heap, what is on the GPU, and of the file what a lost context comes back from. */
    const memory = model.model.geotex.core.HEAPU8.length + model.model.gpuBytes + bytes;
    return {object: model, pictures, memory, bytes, close: () => model.dispose(),
            complete: () => model.complete};
  },
  /* Drawn anew with each node, until its cut of them is within the error. */
  async nexus(url, shown, maxError) {
    const {Nexus3D, Cache} = await nexus('Nexus3D.js');
    Object.assign(Cache, {targetError: maxError, currentError: maxError, minFps: 0});
    let bytes = 0, nodes = 0, changed = performance.now();
    const pictures = [];
    const object = await new Promise((loaded) => {
      const it = new Nexus3D(null, renderer, {material: new THREE.MeshStandardMaterial({roughness: 1}),
                                              onLoad: loaded, onUpdate: () => ++nodes});
      const {httpRequest} = it.mesh;
      it.mesh.httpRequest = function (path, from, to, load, ...rest) {
        const counted = function () {
          bytes += this.response.byteLength;
          load.call(this);
        };
        return httpRequest.call(this, path, from, to, counted, ...rest);
      };
      it.open(url);
    });
    for (let drawn = -1; performance.now() - changed < QUIET; await later(5)) {
      if (nodes === drawn && nodes)
        continue;
      drawn = nodes;
      if (!nodes) { /* a frame asks for nodes */
        frame(object);
        continue;
      }
      shown(object);
      changed = performance.now();
      pictures.push({at: changed, picture: picture(), bytes});
    }
    return {object, pictures, bytes, memory: Cache.cacheSize, close: () => object.dispose()};
  },
  async mesh(object, shown, bytes) {
    shown(object);
    const {geometry: {attributes, index}} = object;
    const size = [...Object.values(attributes), index].reduce((n, a) => n + a.array.byteLength, 0);
    return {object, pictures: [{at: performance.now(), picture: picture()}], bytes,
            memory: 2 * size, close: () => object.geometry.dispose()}; /* three keeps a copy */
  },
  async draco(url, shown) {
    const geometry = await draco.loadAsync(url);
    if (!geometry.attributes.normal)
      geometry.computeVertexNormals();
    return ways.mesh(new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({roughness: 1})), shown);
  },
  async meshopt(url, shown) {
    const {scene: loaded} = await glb.loadAsync(url);
    let mesh = null;
    loaded.updateMatrixWorld();
    loaded.traverse((o) => { mesh ??= o.isMesh ? o : null; });
    mesh.matrixWorld.decompose(mesh.position, mesh.quaternion, mesh.scale);
    mesh.removeFromParent();
    if (!mesh.geometry.attributes.normal)
      mesh.geometry.computeVertexNormals();
    mesh.material = new THREE.MeshStandardMaterial({roughness: 1});
    return ways.mesh(mesh, shown);
  },
};

function medianFrame(object) {
  const times = Array.from({length: FRAMES}, () => frame(object));
  return times.sort((a, b) => a - b)[FRAMES >> 1];
}

/* The frame of a ball of few triangles that covers as many pixels: what three takes to shade these. */
function ballFrame(outline) {
  const covered = (p) => compare(p, p).shown, mesh = new THREE.Mesh(
      new THREE.SphereGeometry(ball.radius / 2, 24, 16), new THREE.MeshStandardMaterial({roughness: 1}));
  mesh.position.copy(ball.center);
  for (let i = 0; i < 8; ++i) {
    frame(mesh);
    mesh.scale.multiplyScalar(Math.sqrt(covered(outline) / covered(picture())));
  }
  const least = medianFrame(mesh);
  mesh.geometry.dispose();
  return least;
}

/* Loaded twice on the line, so that modules, workers and shaders are there the second time: those of
 * coarse models, too; but memory as if this were all, for heaps keep what whole files have taken. Outlines
 * and pictures are compared with those of `mesh`, a Draco file. */
let last = '';
window.measure = async (kind, url, bits, maxError, mesh) => {
  const drawn = await ways.draco(mesh, frame), outline = picture();
  drawn.close();
  await link(bits);
  const warm = await ways[kind](url + '?warm&ranges', frame, maxError);
  await warm.complete?.(); /* what a stopped download has sent would count for the next */
  warm.close();
  const start = performance.now();
  let first = 0;
  const all = await ways[kind](url + '?ranges', (shown) => {
    frame(shown);
    first ||= performance.now() - start;
  }, maxError);
  await link(0);
  const {object, pictures, close} = all;
  const end = pictures[pictures.length - 1];
  last = renderer.domElement.toDataURL('image/png');
  const shown = medianFrame(object);
  await all.complete?.();
  frame(object);
  const final = picture(), whole = all.complete && medianFrame(object);
  /* The first picture from which on none differs from the last one, after which nothing is asked for. */
  let full = pictures.length;
  while (full && compare(pictures[full - 1].picture, end.picture).apart <= MAX_APART)
    --full;
  const {iou} = compare(final, outline);
  close();
  for (const {at, picture: p, bytes} of pictures)
    console.log(`${url}: at ${(at - start).toFixed(0)} ms, ${bytes ?? 'all'} bytes: ` +
                `${(100 * compare(p, final).apart).toFixed(4)} % off`);
  return {first, full: pictures[full].at - start, iou, psnr: psnr(end.picture, outline),
          wholePsnr: psnr(final, outline),
          task: longest(start, end.at), bytes: all.bytes,
          frame: shown, wholeFrame: whole, least: ballFrame(outline),
          memory: Math.min(warm.memory, all.memory)};
};
window.shot = () => last;
