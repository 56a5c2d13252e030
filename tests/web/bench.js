/* An asset beside its mesh as Draco in three.js: what a reader of a page waits for, and pays. */
import * as THREE from 'three';
import {DRACOLoader} from 'three/addons/loaders/DRACOLoader.js';
import {GeotexLoader} from 'geotex/three';

const WIDTH = 640, HEIGHT = 480, FRAMES = 15;
const renderer = new THREE.WebGLRenderer({preserveDrawingBuffer: true});
renderer.setSize(WIDTH, HEIGHT, false);
const gl = renderer.getContext(), scene = new THREE.Scene();
const camera = new THREE.PerspectiveCamera(40, WIDTH / HEIGHT, 0.01, 10);
const light = new THREE.DirectionalLight(0xffffff, 3);
light.position.set(1, 2, 1.5);
scene.add(light, new THREE.HemisphereLight(0xffffff, 0x604020, 0.6));
const ours = new GeotexLoader(renderer);
const draco = new DRACOLoader().setDecoderPath('/modules/three/examples/jsm/libs/draco/').preload();

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

/* Until it is in the picture: a pixel is read, so that the GPU has ended. */
function frame(object) {
  const begin = performance.now();
  const ball = new THREE.Box3().setFromObject(object).getBoundingSphere(new THREE.Sphere());
  Object.assign(camera, {near: ball.radius / 20, far: ball.radius * 20});
  camera.position.set(0.5, 0.5, 0.9).normalize().multiplyScalar(3 * ball.radius).add(ball.center);
  camera.lookAt(ball.center);
  camera.updateProjectionMatrix();
  scene.add(object);
  renderer.render(scene, camera);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  scene.remove(object);
  frames.push([begin, performance.now()]);
}

const kinds = {
  async gtx(url, first) {
    const model = await ours.stream(url);
    first(model);
    await model.complete;
    /* The module's heap, what is on the GPU, and the file, from which a lost context comes back. */
    const heap = model.model.geotex.core.HEAPU8.length;
    console.log(`${heap} bytes of heap, of these ${model.model.cpuBytes} of the plan; ` +
                `${model.model.gpuBytes} on the GPU`);
    return {object: model, memory: heap + model.model.gpuBytes + model.asset.fileBytes,
            close: () => model.dispose()};
  },
  async draco(url, first) {
    const geometry = await draco.loadAsync(url), {attributes, index} = geometry;
    if (!attributes.normal)
      geometry.computeVertexNormals();
    const object = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({roughness: 1}));
    first(object);
    const bytes = [...Object.values(attributes), index].reduce((n, a) => n + a.array.byteLength, 0);
    return {object, memory: 2 * bytes, close: () => geometry.dispose()}; /* three keeps a copy */
  },
};

/* Loaded once at full speed, so that modules, workers and shaders are there, then on the line. */
window.measure = async (kind, url, bits) => {
  (await kinds[kind](url + '?warm', frame)).close();
  await link(bits);
  const start = performance.now();
  let first = 0;
  const {object, memory, close} = await kinds[kind](url + '?slow', (shown) => {
    frame(shown);
    first = performance.now() - start;
  });
  frame(object);
  const full = performance.now() - start, times = [];
  await link(0);
  for (let i = 0; i < FRAMES; ++i) {
    const begin = performance.now();
    frame(object);
    times.push(performance.now() - begin);
  }
  close();
  return {first, full, task: longest(start, start + full), frame: times.sort((a, b) => a - b)[FRAMES >> 1], memory};
};
