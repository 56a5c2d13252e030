/* Exports in three.js: node three.mjs MODULES A.glb A.png ..., with three and puppeteer-core in
 * MODULES. Draws each in a headless Chromium, prints what the loader made of it, and fails where
 * the loader, or WebGL, has something to say. */
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {readFile, writeFile} from 'node:fs/promises';
import {extname, join, normalize, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [, , modules, ...files] = process.argv;
const {default: puppeteer} = await import(pathToFileURL(
  createRequire(resolve(modules, 'none.js')).resolve('puppeteer-core')).href);

const page_text = `<!doctype html><body style="margin:0"><script type="importmap">
{"imports": {"three": "/modules/three/build/three.module.js"}}</script>
<script type="module">
import * as THREE from 'three';
import {RoomEnvironment} from '/modules/three/examples/jsm/environments/RoomEnvironment.js';
import {GLTFLoader} from '/modules/three/examples/jsm/loaders/GLTFLoader.js';
import {DRACOLoader} from '/modules/three/examples/jsm/loaders/DRACOLoader.js';
import {KTX2Loader} from '/modules/three/examples/jsm/loaders/KTX2Loader.js';
import {MeshoptDecoder} from '/modules/three/examples/jsm/libs/meshopt_decoder.module.js';
const renderer = new THREE.WebGLRenderer({preserveDrawingBuffer: true});
renderer.setSize(480, 480);
document.body.append(renderer.domElement);
const room = new THREE.PMREMGenerator(renderer).fromScene(new RoomEnvironment()).texture;
const libs = '/modules/three/examples/jsm/libs/';
const loader = new GLTFLoader()
  .setDRACOLoader(new DRACOLoader().setDecoderPath(libs + 'draco/gltf/'))
  .setKTX2Loader(new KTX2Loader().setTranscoderPath(libs + 'basis/').detectSupport(renderer))
  .setMeshoptDecoder(MeshoptDecoder);
window.draw = async (url) => {
  const {scene: model} = await loader.loadAsync(url);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xd8dae2);
  scene.environment = room;
  scene.add(model);
  const box = new THREE.Box3().setFromObject(model), centre = box.getCenter(new THREE.Vector3());
  const radius = box.getSize(new THREE.Vector3()).length() / 2;
  const away = new THREE.Vector3(0.5, 0.4, 1).normalize();
  const camera = new THREE.PerspectiveCamera(45, 1, radius / 50, radius * 10);
  camera.position.copy(centre).addScaledVector(away, 1.1 * radius / Math.tan(Math.PI / 8));
  camera.lookAt(centre);
  const sun = new THREE.DirectionalLight(0xffffff, 2);
  sun.position.copy(centre).add(new THREE.Vector3(-1, 2, 2));
  sun.target.position.copy(centre);
  scene.add(sun, sun.target);
  renderer.render(scene, camera);
  const fault = renderer.getContext().getError();
  if (fault)
    throw new Error('WebGL error ' + fault);
  const pictures = new Set();
  model.traverse((o) => o.isMesh && Object.values(o.material).forEach((v) =>
    v?.isTexture && pictures.add(v.source)));
  return [renderer.info.render.triangles + ' triangles, ' + renderer.info.render.calls +
          ' calls, ' + pictures.size + ' images', renderer.domElement.toDataURL()];
};
</script>`;

const types = {'.js': 'text/javascript', '.wasm': 'application/wasm'};
const server = createServer(async (request, response) => {
  const [, root, ...rest] = decodeURIComponent(request.url).split('/');
  try {
    const content = root === '' ? page_text
                  : root === 'file' ? await readFile(files[Number(rest[0])])
                  : await readFile(normalize(join(modules, ...rest)));
    response.writeHead(200, {'content-type': root === '' ? 'text/html'
                     : types[extname(request.url)] ?? 'application/octet-stream'});
    response.end(content);
  } catch {
    response.writeHead(root === 'favicon.ico' ? 204 : 404).end();
  }
});
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', headless: true,
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
         '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist']});
let faults = 0;
try {
  const page = await browser.newPage();
  const complain = (text) => {
    if (!/GPU stall|GroupMarkerNotSet|swiftshader/i.test(text)) {
      console.log('# ' + text);
      ++faults;
    }
  };
  page.on('console', (m) => ['error', 'warn', 'warning'].includes(m.type()) && complain(m.text()));
  page.on('pageerror', (error) => complain(error.message));
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  await page.waitForFunction('window.draw', {timeout: 60000});
  for (let i = 0; i < files.length; i += 2) {
    const [told, picture] = await page.evaluate((n) => draw('/file/' + n), i);
    await writeFile(files[i + 1], Buffer.from(picture.split(',')[1], 'base64'));
    console.log('made: ' + told);
  }
} finally {
  await browser.close();
  server.close();
}
process.exit(faults ? 1 : 0);
