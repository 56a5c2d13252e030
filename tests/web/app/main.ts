/* What a page with a bundler writes: typed, built by Vite, opened by browser.mjs. */
import {DirectionalLight, PerspectiveCamera, Raycaster, Scene, Vector2, WebGLRenderer} from 'three';
import {GeotexError} from 'geotex';
import {GeotexLoader, Method} from 'geotex/three';
import {GeotexTilesPlugin} from 'geotex/tiles';
import {GeotexWorld} from 'geotex/world';
import wasm from 'geotex/core.wasm?url';

const renderer = new WebGLRenderer({preserveDrawingBuffer: true});
const scene = new Scene(), camera = new PerspectiveCamera(40, 4 / 3, 0.01, 100);
renderer.setSize(320, 240);
document.body.append(renderer.domElement);
try {
  const file = new URLSearchParams(location.search).get('asset')!;
  const model = await (await new GeotexLoader(renderer, {wasm}).stream(file)).complete;
  const [size, middle] = [0, 1].map((k) => model.asset.max.map(
    (high, i) => k ? (high + model.asset.min[i]) / 2 : high - model.asset.min[i]));
  model.method = Method.CAST;
  camera.position.set(middle[0], middle[1], middle[2] + 2.5 * Math.max(...size));
  scene.add(model, new DirectionalLight(0xffffff, 3));
  renderer.render(scene, camera);
  const ray = new Raycaster();
  ray.setFromCamera(new Vector2(0, 0), camera);
  /* That their types hold, and a bundler finds them. */
  const rest: unknown[] = [GeotexTilesPlugin, GeotexWorld.open];
  document.title = ray.intersectObject(model).length && rest.length ? 'drawn' : 'nothing is hit';
} catch (error) {
  document.title = error instanceof GeotexError ? `${error.kind}: ${error.message}` : String(error);
}
