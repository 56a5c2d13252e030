/* What must hold of worlds of tiles: ours, and tilesets in 3d-tiles-renderer. */
import * as THREE from 'three';
import {TilesRenderer} from '3d-tiles-renderer';
import {GeotexLoader} from 'geotex/three';
import {GeotexTilesPlugin} from 'geotex/tiles';
import {GeotexWorld} from 'geotex/world';
import {likeness, stage as stageOf} from './pictures.js';

const WORLD = '/asset/world/', WHOLE = '/asset/small.gtx'; /* of the same model */

export const worlds = (checks) => {
  const {expect, cameraOf, WIDTH, HEIGHT} = checks;

  async function stage() {
    const made = stageOf(checks, new THREE.HemisphereLight(0xffffff, 0x604020, 3));
    const whole = await new GeotexLoader(made.renderer).loadAsync(WHOLE);
    return {...made, whole, later: () => new Promise((next) => setTimeout(next, 20))};
  }

  function same(a, b, what, least = 0.98, most = 12) {
    const {overlap, off} = likeness(a, b);
    console.log(`${what}: silhouettes overlap by ${overlap.toFixed(3)}, colours are off by ` +
                `${off.toFixed(1)} of 255`);
    expect(overlap > least && off < most, `${what}: overlap ${overlap}, off by ${off}`);
  }

  return {
    async worlds_are_drawn_by_tiles_within_budgets() {
      const {renderer, whole, picture, later} = await stage();
      let near = 0;
      for (const [options, distance] of [[{}, 3], [{}, 100], [{gpuBytes: 6e6, cpuBytes: 8e6}, 3]]) {
        const faults = [];
        const world = await GeotexWorld.open(renderer, WORLD, {
          ...options, onError: (uri, error) => faults.push(`${uri}: ${error.message}`)});
        const camera = cameraOf(whole.asset, 0.5, distance), seen = camera.clone();
        camera.far = seen.far *= distance;
        [camera, seen].forEach((c) => c.updateProjectionMatrix());
        /* Its space begins in the middle. */
        whole.position.set(...whole.asset.anchor.map((c, k) => c - world.origin[k]));
        const move = new THREE.Vector3(...world.origin.map((o, k) => whole.asset.anchor[k] - o));
        seen.position.add(move);
        seen.updateMatrixWorld();
        let shown;
        for (let i = 0; i < 1000; ++i, await later()) {
          shown = picture(world, seen);
          const {pending, withoutRoom, gpuBytes, cpuBytes} = world.state;
          expect(gpuBytes <= (options.gpuBytes ?? 1e9) && cpuBytes <= (options.cpuBytes ?? 1e9),
                 `${gpuBytes} and ${cpuBytes} bytes are taken`);
          if (i && pending === withoutRoom)
            break;
        }
        const {pending, withoutRoom, resident, gpuBytes} = world.state;
        expect(pending === withoutRoom && !faults.length, `${pending} pending; ${faults}`);
        console.log(`${world.tileCount} tiles, from ${distance} radii ${resident} payloads, ` +
                    `${Math.round(gpuBytes / 1000)} KB on the GPU, ${withoutRoom} without room`);
        near ||= resident;
        expect(distance > 10 ? resident < near : options.gpuBytes ? withoutRoom : near > 3,
               `${resident} payloads, ${withoutRoom} without room`);
        if (distance < 10)
          same(picture(whole, seen), shown, 'a world', ...(options.gpuBytes ? [0.94, 20] : []));
        const hit = new THREE.Raycaster();
        hit.setFromCamera(new THREE.Vector2(0, 0), seen);
        world.updateMatrixWorld();
        whole.updateMatrixWorld();
        if (!options.gpuBytes && distance < 10) {
          const [ours] = hit.intersectObject(world), [wanted] = hit.intersectObject(whole);
          expect(ours && Math.abs(ours.distance - wanted.distance) < 0.01 * wanted.distance,
                 `a ray goes ${ours?.distance}, and should ${wanted.distance}`);
        }
        world.dispose();
      }
      whole.dispose();
      renderer.dispose();
      return renderer.domElement;
    },

    async tiles_renderer_shows_gtx_by_a_plugin() {
      const {renderer, scene, whole, picture, later} = await stage();
      const tiles = new TilesRenderer(WORLD + 'tileset.json'), faults = [];
      tiles.registerPlugin(new GeotexTilesPlugin(renderer));
      tiles.addEventListener('load-error', ({error}) => faults.push(error.message));
      tiles.errorTarget = 2;
      tiles.group.rotation.x = -Math.PI / 2; /* +Z is up in a tileset */
      scene.add(tiles.group);
      const camera = cameraOf(whole.asset), group = new THREE.Group();
      whole.position.set(...whole.asset.anchor);
      camera.position.add(whole.position);
      camera.updateMatrixWorld();
      tiles.setCamera(camera);
      tiles.setResolution(camera, WIDTH, HEIGHT);
      let shown;
      for (let i = 0, still = 0; i < 1000 && still < 10; ++i, await later()) {
        tiles.update();
        shown = picture(group, camera);
        const {downloading, parsing, queued} = tiles.stats;
        still = tiles.root && !downloading && !parsing && !queued ? still + 1 : 0;
      }
      expect(!faults.length && tiles.visibleTiles.size > 1,
             `${tiles.visibleTiles.size} tiles are shown; ${faults}`);
      scene.remove(tiles.group);
      same(picture(whole, camera), shown, `${tiles.visibleTiles.size} tiles of a tileset`);
      const models = [];
      tiles.forEachLoadedModel((model) => models.push(model));
      tiles.dispose();
      expect(models.length && models.every((m) => m.content.disposed), 'models are left');
      whole.dispose();
      renderer.dispose();
      return renderer.domElement;
    },
  };
};
