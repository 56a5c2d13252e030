/* What must hold while a file comes down a line: `link(bits)` of browser.mjs makes it slow. */
import * as THREE from 'three';
import {GeotexLoader} from 'geotex/three';
import {likeness, stage as stageOf} from './pictures.js';

const LINK = 10e6, FIRST_BYTES = 150e3;

export const streaming = (checks) => {
  const {expect, address, cameraOf, apart, WIDTH, HEIGHT} = checks;

  function stage() {
    const light = new THREE.DirectionalLight(0xffffff, 3);
    light.position.set(1, 2, 1.5);
    const {renderer, picture} =
        stageOf(checks, light, new THREE.HemisphereLight(0xffffff, 0x604020, 0.6));
    return {renderer, picture: (model) => picture(model, cameraOf(model.asset)),
            loader: new GeotexLoader(renderer)};
  }

  function sideBySide(...pictures) {
    const canvas = document.createElement('canvas'), pen = canvas.getContext('2d');
    Object.assign(canvas, {width: pictures.length * WIDTH, height: HEIGHT});
    pictures.forEach((picture, i) => pen.drawImage(picture, i * WIDTH, 0));
    return canvas;
  }

  return {
    async a_slow_link_shows_a_coarse_picture_first() {
      const {renderer, picture, loader} = stage();
      const whole = await loader.loadAsync(address), wanted = picture(whole);
      await link(LINK);
      try {
        const start = performance.now();
        let come = 0, size = 0;
        const model = await loader.stream(address + '?slow', (bytes, of) => {
          come = bytes;
          size = of || size;
        });
        const first = {bytes: come, at: performance.now() - start}, copy = model.clone();
        const coarse = picture(model);
        expect(first.bytes <= FIRST_BYTES && first.bytes < size / 4,
               `a first picture after ${first.bytes} of ${size} bytes`);
        expect(likeness(wanted, coarse).overlap > 0.75, 'the first picture is another model');
        expect(apart(wanted, coarse, 0) > 0.05, 'nothing was left to come');
        expect(await model.complete === model && copy.asset === model.asset, 'it has stayed coarse');
        const at = performance.now() - start;
        expect(model.asset.fileBytes === whole.asset.fileBytes, 'not all is there');
        expect(apart(wanted, picture(model), 0) === 0, 'the last picture is another');
        expect(apart(wanted, picture(copy), 0) === 0, 'a clone has stayed coarse');
        console.log(`at ${LINK / 1e6} Mbit/s: first picture after ${first.bytes} bytes, ` +
                    `${Math.round(first.at)} ms; all ${size} after ${Math.round(at)} ms`);
        model.dispose();
      } finally {
        await link(0);
        whole.dispose();
        renderer.dispose();
      }
    },

    async the_first_bytes_are_recognised() {
      const {renderer, picture, loader} = stage();
      const whole = await loader.loadAsync(address), wanted = picture(whole);
      const shown = await createImageBitmap(renderer.domElement);
      const model = await loader.stream(`${address}?first=${FIRST_BYTES}`);
      await model.complete.catch(() => {});
      const {overlap, off} = likeness(wanted, picture(model));
      console.log(`${model.asset.fileBytes} of ${whole.asset.fileBytes} bytes: silhouettes ` +
                  `overlap by ${overlap.toFixed(3)}, colours are off by ${off.toFixed(1)} of 255`);
      expect(model.asset.fileBytes <= FIRST_BYTES, 'more than the first bytes');
      expect(overlap > 0.95 && off < 25, 'nobody recognises it');
      [model, whole].forEach((m) => m.dispose());
      renderer.dispose();
      return sideBySide(renderer.domElement, shown);
    },

    async a_download_that_breaks_off_leaves_what_was_there() {
      const {renderer, picture, loader} = stage();
      const model = await loader.stream(address + '?first=200000');
      const why = await model.complete.then(() => null, (error) => error);
      expect(why?.kind === 'truncated', `${why?.kind}: ${why?.message}`);
      expect(picture(model).some((c, i) => i % 4 < 3 && c > 64), 'it is gone');
      const none = await loader.stream(address + '.none').then(() => null, (error) => error);
      expect(none?.kind === 'read' && /404/.test(none.message), `${none?.kind}: ${none?.message}`);
      model.dispose();
      renderer.dispose();
    },

    async far_models_stay_coarse_where_ranges_are_granted() {
      const {renderer, picture, loader} = stage(), scene = new THREE.Scene();
      const later = (ms) => new Promise((next) => setTimeout(next, ms));
      const show = async (model, distance, ms, until = () => false) => {
        const camera = cameraOf(model.asset, 0.5, distance);
        camera.far *= distance;
        camera.updateProjectionMatrix();
        scene.add(model);
        for (const end = performance.now() + ms; performance.now() < end && !until(); await later(20))
          renderer.render(scene, camera);
      };
      const whole = await loader.loadAsync(address), wanted = picture(whole);
      const size = whole.asset.fileBytes;
      await link(LINK);
      try {
        let come = 0, anew = false;
        const told = (bytes) => { anew ||= bytes < come; come = bytes; };
        const model = await loader.stream(address + '?ranges', told);
        await show(model, 100, 1500);
        const far = come;
        await show(model, 100, 500);
        expect(come === far && far < size / 4, `${far}, then ${come} of ${size} bytes came`);
        await show(model, 3, 20000, () => model.content.whole);
        expect(model.asset.fileBytes === size && !anew, `${come} of ${size} bytes, anew: ${anew}`);
        expect(apart(wanted, picture(model), 0) === 0, 'the last picture is another');
        const plain = await loader.stream(address + '?plain');
        await show(plain, 100, 20000, () => plain.content.whole);
        expect(plain.asset.fileBytes === size, 'without ranges it has stayed coarse');
        [model, plain].forEach((m) => m.dispose());
      } finally {
        await link(0);
      }
      whole.dispose();
      renderer.dispose();
    },

    /* LOD meshes that will do, colours and normals: no outlines, and no cells to cast. */
    async parts_of_a_file_give_its_picture() {
      const {renderer, picture, loader} = stage(), PIXELS = 32;
      const whole = await loader.loadAsync(address);
      whole.maxError = PIXELS;
      const wanted = picture(whole), size = whole.asset.fileBytes;
      let come = 0, fell = false;
      await link(LINK);
      const model = await loader.stream(address + '?ranges', (bytes) => {
        fell ||= bytes < come;
        come = bytes;
      });
      model.maxError = PIXELS;
      /* Normals of the file come with their mip levels. */
      for (const end = performance.now() + 20000;
           model.asset.mipCount === 1 && performance.now() < end;
           await new Promise((next) => setTimeout(next, 20)))
        picture(model);
      await link(0);
      const parts = picture(model), {gpuBytes} = model.model;
      console.log(`${come} of ${size} bytes, ${gpuBytes} of ${whole.model.gpuBytes} on the GPU`);
      expect(!model.content.whole && come < size, `${come} of ${size} bytes came`);
      expect(gpuBytes < 0.7 * whole.model.gpuBytes, `${gpuBytes} bytes are on the GPU`);
      expect(apart(wanted, parts, 0) === 0, 'the picture is another');
      await model.complete;
      expect(!fell && come === size, `${come} of ${size} bytes came; fell: ${fell}`);
      expect(apart(wanted, picture(model), 0) === 0, 'the last picture is another');
      [model, whole].forEach((m) => m.dispose());
      renderer.dispose();
    },

    /* Of two that are as smooth, one has relief in its normal map alone. */
    async maps_are_read_for_what_vertices_do_not_tell() {
      const {renderer, picture, loader} = stage(), QUIET = 1500, PIXELS = 4;
      const later = (ms) => new Promise((next) => setTimeout(next, ms));
      for (const [name, relief] of [['smooth', false], ['relief', true]]) {
        const file = address.replace('sculpt', name), whole = await loader.loadAsync(file);
        whole.maxError = PIXELS;
        const wanted = picture(whole), size = whole.asset.fileBytes;
        let come = 0, changed = performance.now();
        await link(LINK);
        const model = await loader.stream(file + '?ranges', (bytes) => {
          come = bytes;
          changed = performance.now();
        });
        model.maxError = PIXELS;
        for (; performance.now() - changed < QUIET; await later(20))
          picture(model);
        await link(0);
        const {off} = likeness(wanted, picture(model)), {normalError, mipCount} = model.asset;
        console.log(`${name}: ${come} of ${size} bytes, colours are off by ${off.toFixed(2)} of 255, ` +
                    `normals by ${normalError.toFixed(4)}`);
        expect(!model.content.whole, 'all has come');
        expect(relief === (normalError === Infinity), `normals are off by ${normalError}`);
        expect(relief === mipCount > 1, relief ? 'its relief is not seen' : 'maps have come');
        expect(relief || come < size / 2, `${come} of ${size} bytes came`);
        expect(off < (relief ? 0.01 : 2), 'the picture is another');
        [model, whole].forEach((m) => m.dispose());
      }
      renderer.dispose();
    },

    async disposing_stops_the_download() {
      const {renderer, loader} = stage();
      await link(LINK / 4);
      try {
        let come = 0, size = 0;
        const model = await loader.stream(address + '?stopped', (bytes, of) => {
          come = bytes;
          size = of;
        });
        model.dispose();
        await model.complete;
        expect(come < size / 2, `${come} of ${size} bytes came`);
      } finally {
        await link(0);
      }
      renderer.dispose();
    },
  };
};
