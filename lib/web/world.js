/* A world of tiles (`gtx world`) in three.js: what the camera needs of it is read, drawn, and dropped
 * again, within budgets of memory.
 *
 *   scene.add(await GeotexWorld.open(renderer, 'world/'));
 *
 * Its space is that of the tiles' coordinates less `origin`, the middle of the world: +Y is up. */
import {Matrix4, Mesh} from 'three';
import {boundsOf, Bridge, meet} from './bridge.js';
import {Pass} from './geotex.js';
import {failure, GeotexError, withBytes} from './inside.js';

const COUNTS = 11, OF_A_REQUEST = 6, OF_AN_UPLOAD = 3, OF_A_DRAW = 2; /* as in world.c */

/* Bytes of a file from one on: by a range, or out of all where the server grants none. */
async function read(ask, kept, bytes) {
  const first = kept.length, headers = {Range: `bytes=${first}-${bytes - 1}`};
  const response = await ask(headers), out = new Uint8Array(bytes);
  if (!response.ok)
    throw new GeotexError(30, `${response.url}: ${response.status} ${response.statusText}`);
  const reader = response.body.getReader();
  let at = response.status === 206 ? first : 0;
  out.set(kept);
  while (at < bytes) {
    const {value, done} = await reader.read();
    if (done)
      throw new GeotexError(42, `${response.url} has ended after ${at} bytes of ${bytes}`);
    out.set(value.subarray(0, bytes - at), at);
    at += value.length;
  }
  reader.cancel().catch(() => {});
  return out;
}

export class GeotexWorld extends Mesh {
  #bridge; #folder; #options; #stream = 0; #number; #payloads = new Map(); #next = 1;
  #released = []; #draws = []; #stop = new AbortController();

  /* `options`: cpuBytes, gpuBytes, uploadBytes a frame, tileError in pixels, maxRequests; requests
   * (of fetch); onError(uri, error); wasm and log. */
  static async open(renderer, folder, options = {}) {
    const place = new URL(folder.replace(/\/?$/, '/'), document.baseURI);
    const [bridge, response] = await Promise.all([
      Bridge.of(renderer, options), fetch(new URL('tiles.gtw', place), options.requests)]);
    if (!response.ok)
      throw new GeotexError(30, `${response.url}: ${response.status} ${response.statusText}`);
    return new GeotexWorld(bridge, place, await response.arrayBuffer(), options);
  }

  constructor(bridge, folder, index, options) {
    const {core} = bridge.geotex, worlds = core.worlds ??= new Map();
    const number = worlds.size ? Math.max(...worlds.keys()) + 1 : 1;
    const limits = ['cpuBytes', 'gpuBytes', 'uploadBytes', 'tileError', 'maxRequests']
        .map((name) => options[name] ?? 0);
    const stream = bridge.geotex.withNumbers(limits, (at) =>
      withBytes(core, index, (bytes, size) => core._gtxw_world_create(bytes, size, number, at)));
    bridge.geotex.must(stream);
    const from = core._gtxw_world_info(stream) / 8, n = [...core.HEAPF64.subarray(from, from + 10)];
    const origin = [2, 3, 4].map((k) => (n[k] + n[k + 3]) / 2);
    const [min, max] = [2, 5].map((first) => origin.map((o, k) => n[first + k] - o));
    super(boundsOf({min, max}), bridge.material);
    worlds.set(number, this);
    this.#bridge = bridge;
    this.#folder = folder;
    this.#options = options;
    this.#stream = stream;
    this.#number = number;
    Object.assign(this, {type: 'GeotexWorld', origin, min, max, tileCount: n[0], unit: n[1],
                         fileBytes: n[9], maxError: 0.5, state: {}});
    this.onBeforeRender = (renderer, scene, camera) => this.update(camera);
    this.onAfterRender = (renderer, scene, camera, geometry, material) =>
      bridge.show(this, scene, camera, material, {}, this.#placed());
    this.onAfterShadow = (renderer, object, camera, shadowCamera) =>
      bridge.draw(this, shadowCamera, {pass: Pass.DEPTH}, this.#placed());
  }

  /* For what a camera sees; a frame does so by itself. */
  update(camera) {
    const {renderer, geotex} = this.#bridge, {core} = geotex;
    if (!this.#stream)
      return;
    const seen = new Matrix4().multiplyMatrices(camera.matrixWorldInverse, this.matrixWorld);
    const height = renderer.getRenderTarget()?.height ?? renderer.getContext().drawingBufferHeight;
    const at = geotex.withNumbers(
        [...seen.elements, ...camera.projectionMatrix.elements, height], (floats) =>
      core._gtxw_world_update(this.#stream, floats, ...this.origin)) / 8;
    geotex.must(at);
    const take = (from, count) => [...core.HEAPF64.subarray(from, from + count)];
    const [requests, uploads, draws, pending, withoutRoom, givenUp, resident, underWay, cpuBytes,
           gpuBytes, requestBytes] = take(at, COUNTS);
    this.state = {pending, withoutRoom, givenUp, resident, underWay, cpuBytes, gpuBytes};
    const rows = (from, count, of) =>
      [...Array(count).keys()].map((i) => take(from + i * of, of));
    const second = at + COUNTS + OF_A_REQUEST * requests, third = second + OF_AN_UPLOAD * uploads;
    const asked = rows(at + COUNTS, requests, OF_A_REQUEST).map((row) => ({
      row, request: core.HEAPU8.slice(row[5], row[5] + requestBytes),
      uri: core.UTF8ToString(core._gtxw_world_uri(row[5]))}));
    const sent = rows(second, uploads, OF_AN_UPLOAD);
    this.#draws = rows(third, draws, OF_A_DRAW).map(([, payload]) => this.#payloads.get(payload));
    this.#clear();
    for (const {row, request, uri} of asked)
      this.#read(row, request, uri);
    for (const [tile, number, bytes] of sent) {
      const {model, cpu} = this.#payloads.get(number);
      if (model.upload(bytes))
        core._gtxw_world_ready(this.#stream, tile, cpu);
    }
  }

  async #read([id, , bytes, beginning, more], request, uri) {
    const {geotex} = this.#bridge, {core} = geotex;
    try {
      const ask = (headers) => fetch(new URL(uri, this.#folder), {
        ...this.#options.requests, signal: this.#stop.signal,
        headers: {...this.#options.requests?.headers, ...headers}});
      const kept = this.#payloads.get(beginning)?.bytes ?? new Uint8Array();
      const data = await read(ask, kept, bytes);
      const {asset, model} = await geotex.load(data, {prefix: !!more, request});
      const number = this.#next++, cpu = data.length + model.cpuBytes;
      const [x, y, z] = asset.anchor.map((c, k) => c - this.origin[k]);
      this.#payloads.set(number, {bytes: data, asset, model, cpu,
                                  place: new Matrix4().makeTranslation(x, y, z)});
      if (this.#stream)
        core._gtxw_world_deliver(this.#stream, id, number, cpu, model.gpuBytes);
      else
        this.#released.push(number);
    } catch (error) {
      if (this.#stream)
        this.#fail(id, error);
    }
    this.#clear();
  }

  #fail(id, error) {
    const {core} = this.#bridge.geotex, text = String(error.message ?? error);
    const at = core._malloc(core.lengthBytesUTF8(text) + 1);
    core.stringToUTF8(text, at, core.lengthBytesUTF8(text) + 1);
    core._gtxw_world_fail(this.#stream, id, error.result ?? 30, at);
    core._free(at);
  }

  /* The core is done with a payload. */
  released(number) {
    this.#released.push(number);
  }

  reported(uri, result, message, triesLeft) {
    this.#options.onError?.(uri, new GeotexError(result, message), triesLeft);
  }

  #clear() {
    for (const number of this.#released.splice(0)) {
      const {asset, model} = this.#payloads.get(number);
      this.#draws = this.#draws.filter((shown) => shown.model !== model);
      this.#payloads.delete(number);
      asset.dispose();
      model.dispose();
    }
  }

  #placed() {
    return this.#draws.map(({model, place}) => ({
      model, transform: new Matrix4().multiplyMatrices(this.matrixWorld, place).elements}));
  }

  /* Meets what the last frame showed, as far as it has heights. */
  raycast(raycaster, intersects) {
    for (const {asset, place} of this.#draws)
      meet(asset, new Matrix4().multiplyMatrices(this.matrixWorld, place), this, raycaster,
           intersects);
  }

  dispose() {
    const {geotex} = this.#bridge;
    this.#stop.abort();
    geotex.core._gtxw_world_destroy(this.#stream);
    geotex.core.worlds.delete(this.#number);
    this.#stream = 0;
    this.#clear();
    this.geometry.dispose();
  }
}
