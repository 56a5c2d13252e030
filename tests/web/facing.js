/* What must hold of triangles that are picked by where they face, as rasterizers in software have
 * it: pictures are the same without the others. */
import * as THREE from 'three';
import {Geotex, Method} from 'geotex';

export const facing = ({expect, context, clear, cameraOf, read, covered, apart, WIDTH, HEIGHT}) => ({
  async triangles_that_face_away_are_left_out() {
    const gl = context(), geotex = await Geotex.create(gl);
    expect(geotex.software, 'Chromium does not say that it rasterizes in software');
    let indices = 0, draws = 0;
    for (const name of ['drawElements', 'drawElementsInstanced']) {
      const call = gl[name];
      gl[name] = (...all) => {
        indices += all[1];
        ++draws;
        return call.apply(gl, all);
      };
    }
    for (const file of ['smooth', 'sculpt']) {
      const bytes = await (await fetch(`/asset/${file}.gtx`)).arrayBuffer(), models = [];
      for (const software of [false, true]) {
        geotex.software = software;
        models.push(geotex.load(bytes));
      }
      const [{asset, model: all}, {model: picked}] = await Promise.all(models);
      for (let i = 0; i < 12; ++i) {
        const camera = cameraOf(asset, i, i % 3 ? 3 : 1.2), r = camera.far / 20, counts = [];
        const [projection, side] = [camera.projectionMatrix, i % 4 === 1 ? -1.5 : 1];
        if (i % 4 === 2)
          projection.makeOrthographic(-r, r, r, -r, camera.near, camera.far);
        const transform = new THREE.Matrix4().makeShear(0, 0, 0.3 * (i & 1), 0, 0, 0)
            .scale(new THREE.Vector3(side, 1, 1)).elements;
        const pictures = [all, picked].map((model) => {
          indices = draws = 0;
          clear(gl);
          geotex.draw({view: camera.matrixWorldInverse.elements, projection: projection.elements,
                       width: WIDTH, height: HEIGHT, method: Method.LOD, level: 1},
                      [{model, transform}]);
          expect(gl.getError() === 0, 'WebGL reports an error');
          counts.push(indices);
          return read(gl);
        });
        const differ = apart(...pictures, 0);
        expect(covered(pictures[0]) > 1000, `view ${i} of ${file} shows nothing`);
        /* Corners are rounded to parts of a pixel: edge on, a triangle may come to face the eye. */
        expect(differ < 1e-4, `view ${i} of ${file}: ${(100 * differ).toFixed(3)} % differ`);
        expect(draws <= 2, `view ${i} of ${file}: ${draws} draws`); /* of picked ones */
        expect(counts[1] < 0.7 * counts[0], `view ${i} of ${file}: ${counts[1]} of ${counts[0]}`);
      }
      for (const thing of [all, picked, asset])
        thing.dispose();
    }
    geotex.dispose();
    return gl.canvas;
  },
});
