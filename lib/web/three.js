/* geotex in three.js: models that are drawn in three's own order, by its cameras and lights.
 *
 *   const model = await new GeotexLoader(renderer).loadAsync('bunny.gtx');
 *   scene.add(model); */
import {FileLoader, Loader, Matrix4, Mesh, Vector4} from 'three';
import {boundsOf, Bridge, meet} from './bridge.js';
import {Method, Pass} from './geotex.js';
import {isBlurred, modelsOf} from './load.js';

const SLICE = 1 << 20;                 /* bytes sent at once: 2 ms in software; at double, 4 */

/* An asset and its model, until better ones of the same file take their place. */
class Content {
  disposed = false;
  whole = false;
  complete = Promise.resolve();
  #frame = -1; #need = 0; #texel = 0; #demanded = false; #wake = () => {};

  constructor(geotex, model) {
    Object.assign(this, {geotex, model});
  }

  get asset() {
    return this.model.asset;
  }

  /* A frame shows it with an error so many times what is allowed, of what is there and at most, and
   * texels of so many pixels. */
  seen(frame, need, texel) {
    const same = frame === this.#frame;
    this.#need = same ? Math.max(this.#need, need) : need;
    this.#texel = same ? Math.max(this.#texel, texel) : texel;
    this.#frame = frame;
    if (need > 1 || isBlurred(this.model, this.finest))
      this.#wake();
  }

  /* The finest mip level that was looked up, of those of the model and finer ones. */
  get finest() {
    return Math.floor(0.5 - Math.log2(Math.max(this.#texel, 1e-9)));
  }

  demand() {
    this.#demanded = true;
    this.#wake();
  }

  /* Of what no frame has shown yet, and of what the last one did too coarsely; else a promise. */
  wanted(frame) {
    return this.#demanded || this.#frame < 0 || this.#frame >= frame - 1 && this.#need > 1 ||
           new Promise((wake) => { this.#wake = () => wake(true); });
  }

  /* All that a download still brings. */
  async follow(models) {
    for await (const model of models)
      await this.replace(model);
    this.whole = true;
  }

  /* Sent in slices, so that no frame waits for it; until all is there the old one is drawn. */
  async replace(model) {
    while (!this.disposed && !this.geotex.gl.isContextLost() && !model.upload(SLICE))
      await new Promise((next) => setTimeout(next));
    if (!this.disposed) {
      [this.model, model] = [model, this.model];
      /* What the last frame would have needed of it. */
      this.#need *= this.asset.lodError / model.asset.lodError || 0;
      this.#texel *= model.asset.pageWidth / this.asset.pageWidth;
    }
    model.dispose();
    model.asset.dispose();
  }

  dispose() {
    this.disposed = true;
    this.demand();
    this.stop?.();
    this.asset.dispose();
    this.model.dispose();
  }
}

export class GeotexModel extends Mesh {
  #bridge;

  /* `content`: what clones share, an asset and its model, replaced as better ones come. */
  constructor(bridge, content) {
    super(boundsOf(content.asset), bridge.material);
    this.#bridge = bridge;
    Object.assign(this, {type: 'GeotexModel', content, method: Method.AUTO, maxError: 1});
    const clip = new Matrix4();
    this.onAfterRender = (renderer, scene, camera, geometry, material) => {
      const {unit, texel} = this.model.need(
          clip.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse)
              .multiply(this.matrixWorld).elements,
          renderer.getCurrentViewport(new Vector4()).w);
      content.seen(renderer.info.render.frame, unit * this.asset.lodError / this.maxError, texel);
      bridge.show(this, scene, camera, material, this.way, this.placed);
    };
    this.onAfterShadow = (renderer, object, camera, shadowCamera) =>
      bridge.draw(this, shadowCamera, {...this.way, pass: Pass.DEPTH}, this.placed);
  }

  /* LOD meshes are all that a beginning has. */
  get way() {
    return {method: this.content.whole ? this.method : Method.AUTO};
  }

  get placed() {
    return [{model: this.model, transform: this.matrixWorld.elements}];
  }

  get asset() {
    return this.content.asset;
  }

  get model() {
    return this.content.model;
  }

  get complete() {
    this.content.demand();
    return this.content.complete.then(() => this);
  }

  clone(recursive) {
    return new GeotexModel(this.#bridge, this.content).copy(this, recursive);
  }

  copy(source, recursive) {
    const {geometry, material} = this;
    super.copy(source, recursive);
    Object.assign(this, {geometry, material, method: source.method, maxError: source.maxError});
    return this;
  }

  raycast(raycaster, intersects) {
    meet(this.asset, this.matrixWorld, this, raycaster, intersects);
  }

  /* Blends a colour into those around a point of the world; clones show it, too. */
  paint(point, radius, color, strength) {
    const place = this.worldToLocal(point.clone()), scale = this.matrixWorld.getMaxScaleOnAxis();
    return this.model.paint(place.toArray(), radius / scale,
                            color.clone().convertLinearToSRGB().toArray(), strength);
  }

  /* Frees the model and its asset, which clones share. */
  dispose() {
    this.content.dispose();
    this.geometry.dispose();
  }
}

/* Loads a `.gtx`. `options.wasm`: where core.wasm lies. */
export class GeotexLoader extends Loader {
  constructor(renderer, options, manager) {
    super(manager);
    this.renderer = renderer;
    this.options = options;
  }

  load(url, onLoad, onProgress, onError) {
    const files = new FileLoader(this.manager);
    files.setPath(this.path).setResponseType('arraybuffer')
        .setRequestHeader(this.requestHeader).setWithCredentials(this.withCredentials);
    const fail = (error) => {
      (onError ?? console.error)(error);
      this.manager.itemError(url);
    };
    files.load(url, (bytes) => this.parseAsync(bytes).then(onLoad, fail), onProgress, onError);
  }

  async parseAsync(bytes) {
    const bridge = await Bridge.of(this.renderer, this.options);
    const content = new Content(bridge.geotex, (await bridge.geotex.load(bytes)).model);
    content.whole = true;
    return new GeotexModel(bridge, content);
  }

  /* Gives the model as soon as the file's first bytes show something; more of them make it finer, as
   * long as it is seen too coarsely, where the server grants ranges. `complete` asks for the rest,
   * and tells when all is there, or why not: then what was there stays. */
  async stream(url, onProgress, signal) {
    const stop = new AbortController(), {manager} = this;
    const failed = (error) => {
      manager.itemError(url);
      manager.itemEnd(url);
      throw error;
    };
    signal?.addEventListener('abort', () => stop.abort(signal.reason));
    manager.itemStart(url);
    try {
      const bridge = await Bridge.of(this.renderer, this.options);
      bridge.geotex.workshop.start();
      const models = modelsOf(bridge.geotex, (headers) => fetch(manager.resolveURL(this.path + url), {
        headers: {...this.requestHeader, ...headers}, signal: stop.signal,
        credentials: this.withCredentials ? 'include' : 'same-origin'}), {
          onProgress, wanted: () => content.wanted(this.renderer.info.render.frame),
          finest: () => content.finest});
      const content = new Content(bridge.geotex, (await models.next()).value);
      content.stop = () => stop.abort();
      content.complete = content.follow(models).then(
          () => manager.itemEnd(url),
          (error) => content.disposed ? manager.itemEnd(url) : failed(error));
      content.complete.catch(() => {});
      return new GeotexModel(bridge, content);
    } catch (error) {
      stop.abort();
      return failed(error);
    }
  }
}

export {Method};
