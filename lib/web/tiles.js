/* geotex in 3d-tiles-renderer: tilesets whose content is `.gtx`, as `gtx world` makes them.
 *
 *   tiles.registerPlugin(new GeotexTilesPlugin(renderer)); */
import {Matrix4, Vector3} from 'three';
import {GeotexLoader} from './three.js';

export class GeotexTilesPlugin {
  name = 'GEOTEX_TILES_PLUGIN';
  #models = new Set();

  /* `options` as GeotexLoader has them. */
  constructor(renderer, options) {
    this.loader = new GeotexLoader(renderer, options);
  }

  parseToMesh(buffer, tile, extension, url, signal) {
    return extension?.toLowerCase() === 'gtx' ? this.#parse(buffer, signal) : null;
  }

  /* +Y is up in a `.gtx`, +Z in a tileset. */
  async #parse(buffer, signal) {
    const model = await this.loader.parseAsync(buffer), up = new Matrix4().makeRotationX(Math.PI / 2);
    model.applyMatrix4(up.multiply(new Matrix4().makeTranslation(
        new Vector3(...model.asset.anchor))));
    this.#models.add(model);
    if (signal?.aborted)
      this.#free(model);
    return model;
  }

  #free(model) {
    if (this.#models.delete(model))
      model.dispose();
  }

  calculateBytesUsed(tile, scene) {
    return this.#models.has(scene) ? scene.model.gpuBytes + scene.asset.fileBytes : 0;
  }

  disposeTile({engineData}) {
    this.#free(engineData?.scene);
  }

  /* The renderer of tiles has ended, or is to go on without geotex. */
  dispose() {
    for (const model of [...this.#models])
      this.#free(model);
  }
}
