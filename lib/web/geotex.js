/* geotex in a page: geometry textures drawn into a WebGL 2 context that the page owns.
 *
 *   const geotex = await Geotex.create(gl);
 *   const asset = geotex.open(await (await fetch('bunny.gtx')).arrayBuffer());
 *   const model = geotex.model(asset);
 *   geotex.draw({view, projection, width, height}, [{model, transform}]);
 *
 * Every draw writes true depth from the page's own matrices, and leaves WebGL's state as it was.
 * Types and units are in geotex.d.ts. */
import createCore from './core.js';
import {failure, GeotexError, infoOf, openBytes, openPrefix, resourcesOf, withBytes} from './inside.js';
import {State} from './state.js';
import {Slot, unpackPlainly, Upload} from './upload.js';
import {Workshop} from './workshop.js';

export {GeotexError};

export const Method = Object.freeze({AUTO: 0, CAST: 1, PAPER: 2, LOD: 3, GRID: 4});
export const Pass = Object.freeze({FORWARD: 0, DEPTH: 1, ID: 2, GBUFFER: 3});

/* What rasterizes on the CPU: there triangles that face away are left out before they are drawn. */
const SOFTWARE = /SwiftShader|llvmpipe|softpipe|Basic Render/;

/* An opened `.gtx`: what it says, and rays into it on the CPU. One that a worker has opened is opened
 * here too once that is needed: by a ray, or after a lost context. */
export class Asset {
  #geotex; #open; #handle; #caster = 0;

  constructor(geotex, info, handle, open = null) {
    this.#geotex = geotex;
    this.#handle = handle;
    this.#open = open;
    Object.assign(this, info);
  }

  get handle() {
    this.#handle ||= this.#open?.() ?? 0;
    if (!this.#handle)
      throw new GeotexError(10, 'the asset has been disposed');
    return this.#handle;
  }

  raycast(origin, direction, {near = 0, far = Infinity, twoSided = false} = {}) {
    const core = this.#geotex.core;
    this.#caster ||= this.#geotex.must(core._gtxw_caster_create(this.handle));
    const ray = [...origin, near, ...direction, isFinite(far) ? far : 0];
    const at = this.#geotex.withNumbers(ray, (pointer) =>
      core._gtxw_raycast(this.#caster, this.handle, pointer, twoSided)) / 4;
    const n = core.HEAPF32.slice(at, at + 11);
    return isFinite(n[0]) ? {
      t: n[0], point: [0, 1, 2].map((k) => origin[k] + n[0] * direction[k]),
      normal: [...n.slice(1, 4)], facet: [...n.slice(4, 7)], color: [...n.slice(7, 11)]} : null;
  }

  dispose() {
    if (this.#handle) {
      this.#geotex.core._gtxw_caster_destroy(this.#caster);
      this.#geotex.core._gtxw_close(this.#handle);
    }
    this.#handle = this.#caster = 0;
    this.#open = null;
  }
}

/* An asset on the GPU. It keeps the asset, from which it comes back after a lost context. */
export class Model {
  #upload = null;

  /* `made`: what a worker has prepared, if it has. */
  constructor(geotex, asset, made = null) {
    Object.assign(this, {geotex, asset, handle: 0, ready: false});
    this.prepare(made);
  }

  prepare(made) {
    const {geotex, asset} = this, {core} = geotex;
    this.ready = false;
    core.plan = made?.plan;
    this.handle = geotex.must(made ? core._gtxw_model_unpack()
                                   : core._gtxw_model_prepare(asset.handle, geotex.software));
    core.plan = null;
    this.resources = made ? made.resources : resourcesOf(core, this.handle);
    this.cpuBytes = made?.plan.length ?? 0;
    this.gpuBytes = core._gtxw_model_gpu_bytes(this.handle);
  }

  /* Sends up to maxBytes, 0 for all. Returns whether that was the rest. */
  upload(maxBytes = 0) {
    const g = this.geotex;
    if (!this.handle)
      this.prepare();
    if (!this.ready && !g.gl.isContextLost())
      g.around(() => {
        this.#upload ??= new Upload(g, this.resources);
        if (this.#upload.send(maxBytes || Infinity))
          this.sent();
      });
    return this.ready;
  }

  sent() {
    const {core} = this.geotex;
    this.geotex.withNumbers([], (_, names) => core._gtxw_model_sent(this.handle, names),
                            this.#upload.names);
    this.names = this.#upload.names;
    this.#upload = this.resources = null;
    this.ready = true;
  }

  /* Of a view, whose matrix takes the asset's coordinates to clip space: pixels of a unit where a
   * patch in it is nearest, and of a texel where they are most. */
  need(clip, height) {
    const {core} = this.geotex;
    const at = this.geotex.withNumbers(clip, (from) =>
      core._gtxw_model_need(this.handle, from, height)) / 4;
    return {unit: core.HEAPF32[at], texel: core.HEAPF32[at + 1]};
  }

  /* Blends a colour into those around a point of the asset's space, less towards the radius: sRGB,
   * 0 to 1. The asset keeps it. False where it meets nothing, or there are no colours. */
  paint(point, radius, color, strength = 1) {
    const g = this.geotex, {core, gl} = g, {asset} = this;
    if (!this.ready || !asset.hasColor)
      return false;
    const brush = [...point, radius, ...color.map((c) => 255 * c), strength];
    const at = g.must(g.withNumbers(brush, (from) => core._gtxw_paint(asset.handle, from))) / 4;
    const count = core.HEAPU32[at], rows = core.HEAPU32.slice(at + 1, at + 1 + 5 * count);
    g.around(() => {
      unpackPlainly(gl);
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, core.GL.textures[this.names[Slot.COLORS]]);
      for (let level = 0; level < asset.mipCount; ++level) {
        const wide = asset.pageWidth >> level, high = asset.pageHeight >> level;
        const colors = core._gtxw_colors(asset.handle, level);
        gl.pixelStorei(gl.UNPACK_ROW_LENGTH, wide);
        for (let i = 0; i < 5 * count; i += 5) {
          const [x, y, w, h] = [1, 2, 3, 4].map((k) => rows[i + k] >> level), page = rows[i];
          const from = colors + 4 * ((page * high + y) * wide + x);
          gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, level, x, y, page, w, h, 1, gl.RGBA,
                           gl.UNSIGNED_BYTE, core.HEAPU8.subarray(from, from + 4 * h * wide));
        }
      }
    });
    return count > 0;
  }

  /* Frees the core's side, and what is on the GPU. */
  forget() {
    this.#upload?.stop();
    this.#upload = this.resources = null;
    this.geotex.core._gtxw_model_destroy(this.geotex.renderer, this.handle);
    this.handle = 0;
    this.ready = false;
  }

  dispose() {
    this.geotex.models.delete(this);
    if (this.handle)
      this.geotex.around(() => this.forget());
  }
}

/* Fragment mains of the page's own (gtx_shading_create). */
export class Shading {
  constructor(geotex, text, later = false) {
    Object.assign(this, {geotex, text, later, handle: 0, values: {}});
    this.create();
  }

  create() {
    const g = this.geotex, core = g.core, size = core.lengthBytesUTF8(this.text) + 1;
    const pointer = core._malloc(size);
    core.stringToUTF8(this.text, pointer, size);
    this.handle = g.around(() => core._gtxw_shading_create(g.renderer, pointer, this.later));
    core._free(pointer);
    g.must(this.handle);
    this.places = new Map();
    this.list();
  }

  get programs() {
    return [...this.places.keys()];
  }

  /* Finds its programs, which have the uniforms that were set. */
  list() {
    const {core} = this.geotex;
    for (let i = 0, name; (name = core._gtxw_shading_program(this.handle, i)); ++i)
      if (!this.places.has(core.GL.programs[name]))
        this.places.set(core.GL.programs[name], {});
    this.set(this.values);
  }

  /* Numbers and rows of 2, 3, 4 or 16 of them; arrays of vec3 and mat4 as {vec3: [...]}, {mat4:
   * [...]}; samplers and other whole numbers as {int: n}. */
  set(uniforms) {
    const gl = this.geotex.gl, before = gl.getParameter(gl.CURRENT_PROGRAM);
    Object.assign(this.values, uniforms);
    this.places.forEach((places, program) => {
      gl.useProgram(program);
      for (const [name, value] of Object.entries(uniforms)) {
        const at = places[name] ??= gl.getUniformLocation(program, name);
        if (value.int !== undefined)
          gl.uniform1i(at, value.int);
        else if (value.vec3)
          gl.uniform3fv(at, value.vec3);
        else if (value.mat4 ?? value.length === 16)
          gl.uniformMatrix4fv(at, false, value.mat4 ?? value);
        else if (value.length)
          gl[`uniform${value.length}fv`](at, value);
        else
          gl.uniform1f(at, value);
      }
    });
    gl.useProgram(before);
  }

  dispose() {
    if (!this.handle)
      return;
    this.geotex.shadings.delete(this);
    this.geotex.around(() => this.geotex.core._gtxw_shading_destroy(this.geotex.renderer,
                                                                    this.handle));
    this.handle = 0;
  }
}

export class Geotex {
  /* `wasm`: where core.wasm lies, if not beside this file. `log` gets shader logs. */
  static async create(gl, {wasm, log = () => {}} = {}) {
    if (typeof WebGL2RenderingContext === 'undefined' || !(gl instanceof WebGL2RenderingContext))
      throw new GeotexError(80, 'geotex needs a WebGL 2 context');
    const place = new URL(wasm ?? new URL('./core.wasm', import.meta.url), document.baseURI).href;
    const workshop = new Workshop(place);
    const core = await createCore({locateFile: () => place, onLog: log});
    return new Geotex(gl, core, workshop);
  }

  constructor(gl, core, workshop) {
    Object.assign(this, {gl, core, workshop, models: new Set(), shadings: new Set(), numbers: 0,
                         room: 0});
    const more = gl.getExtension('WEBGL_debug_renderer_info');
    this.software = SOFTWARE.test(gl.getParameter(more?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER));
    this.begin();
    this.lost = (event) => { event.preventDefault(); this.forget(); };
    this.restored = () => this.begin();
    gl.canvas.addEventListener?.('webglcontextlost', this.lost);
    gl.canvas.addEventListener?.('webglcontextrestored', this.restored);
  }

  /* At the start, and when a lost context is back: all that stood on the GPU is made again. */
  begin() {
    this.context = this.core.GL.registerContext(this.gl, {majorVersion: 2, minorVersion: 0});
    this.renderer = this.must(this.around(() => this.core._gtxw_renderer_create()));
    for (const shading of this.shadings)
      shading.create();
  }

  /* The context took its objects with it: the core frees its side of them. */
  forget() {
    this.around(() => {
      for (const model of this.models)
        model.forget();
      for (const shading of this.shadings)
        this.core._gtxw_shading_destroy(this.renderer, shading.handle);
      this.core._gtxw_renderer_destroy(this.renderer);
    });
    this.core.GL.deleteContext(this.context);
    this.renderer = this.context = 0;
  }

  /* Throws what the last call failed by, unless it gave something. */
  must(given) {
    if (!given)
      throw failure(this.core);
    return given;
  }

  /* Calls with WebGL's state kept, and the core's context current. */
  around(call, known) {
    if (this.gl.isContextLost()) {
      this.core.GL.makeContextCurrent(this.context);
      return call();
    }
    const state = new State(this.gl, known);
    this.core.GL.makeContextCurrent(this.context);
    try {
      return call();
    } finally {
      state.restore(this.gl);
    }
  }

  /* Numbers in the core's memory during a call: floats, and behind them whole numbers. */
  withNumbers(floats, call, whole = []) {
    const size = 4 * (floats.length + whole.length);
    if (size > this.room) {
      this.core._free(this.numbers);
      this.numbers = this.core._malloc(size);
      this.room = this.numbers ? size : 0;
      if (!this.numbers)
        throw new GeotexError(20, 'no memory for ' + size + ' bytes of numbers');
    }
    this.core.HEAPF32.set(floats, this.numbers / 4);
    this.core.HEAPU32.set(whole, this.numbers / 4 + floats.length);
    return call(this.numbers, this.numbers + 4 * floats.length);
  }

  open(bytes) {
    const handle = this.must(withBytes(this.core, bytes, this.core._gtxw_open));
    return new Asset(this, infoOf(this.core, handle), handle);
  }

  /* The first bytes of a file: an asset of what is there, or null, and what to wait for. */
  openPrefix(bytes) {
    const {handle, ...told} = openPrefix(this.core, bytes);
    return {asset: handle ? new Asset(this, infoOf(this.core, handle), handle) : null, ...told};
  }

  /* The model of a file's bytes, which stay as they are; with `prefix` of the first of them, as
   * openPrefix has it, and two `pieces` {first, bytes} of the rest; or what was read for a `request` of
   * a world. Opened and prepared by a worker, where there can be one. */
  async load(bytes, how = {}) {
    const made = await this.workshop.prepare(bytes, {...how, software: this.software});
    if (this.closed)
      throw new GeotexError(10, 'geotex has been disposed');
    if (!made) {
      const {handle, ...told} = openBytes(this.core, bytes, how);
      const asset = handle ? new Asset(this, infoOf(this.core, handle), handle) : null;
      return {asset, model: asset && this.model(asset), ...told};
    }
    const open = () => openBytes(this.core, bytes, how).handle;
    const asset = made.info && new Asset(this, made.info, 0, open);
    return {...made.told, asset, model: asset && this.model(asset, made)};
  }

  /* Uploaded by the first draw, or before it in slices by upload(). */
  model(asset, made) {
    const model = new Model(this, asset, made);
    this.models.add(model);
    return model;
  }

  /* `later`: of its programs, those that are drawn by are compiled when they first are. */
  shading(text, later) {
    const shading = new Shading(this, text, later);
    this.shadings.add(shading);
    return shading;
  }

  draw(view, instances) {
    if (this.gl.isContextLost() || !this.renderer)
      return;
    const floats = [...view.view, ...view.projection, ...(view.light ?? [0, 0, 0]),
                    view.ambient ?? 0, view.maxError ?? 0];
    const handles = [];
    for (const {model, transform, tint} of instances) {
      model.upload();
      floats.push(...(transform ?? IDENTITY), ...(tint ?? [0, 0, 0, 0]));
      handles.push(model.handle);
    }
    const whole = [view.method ?? Method.AUTO, view.flags ?? 0, view.width ?? 0, view.height ?? 0,
                   view.pass ?? Pass.FORWARD, view.level ?? 0, ...handles];
    const shading = view.shading?.handle ?? 0;
    const draw = () => this.withNumbers(floats, (f, w) => this.around(() =>
      this.core._gtxw_draw(this.renderer, f, w, shading, w + 24, f + 148, handles.length),
      view.known ?? {}), whole);
    let result = draw();
    if (result < 0) {
      view.shading.list();
      result = draw();
    }
    if (result)
      this.must(0);
  }

  dispose() {
    this.gl.canvas.removeEventListener?.('webglcontextlost', this.lost);
    this.gl.canvas.removeEventListener?.('webglcontextrestored', this.restored);
    for (const thing of [...this.models, ...this.shadings])
      thing.dispose();
    this.around(() => this.core._gtxw_renderer_destroy(this.renderer));
    this.core.GL.deleteContext(this.context);
    this.core._free(this.numbers);
    this.workshop.close();
    this.renderer = this.numbers = this.room = 0;
    this.closed = true;
  }
}

const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
