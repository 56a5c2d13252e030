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

export const Method = Object.freeze({AUTO: 0, CAST: 1, PAPER: 2, LOD: 3, GRID: 4});
export const Pass = Object.freeze({FORWARD: 0, DEPTH: 1, ID: 2, GBUFFER: 3});

/* As gtx_result; 0 is no error. */
const RESULTS = {
  10: 'argument', 11: 'not-zeroed', 20: 'memory', 21: 'limit', 30: 'read', 40: 'not-gtx',
  41: 'version', 42: 'truncated', 43: 'corrupt', 45: 'unsupported', 80: 'gl', 81: 'shader', 99: 'internal'};

export class GeotexError extends Error {
  constructor(result, message) {
    super(message);
    this.name = 'GeotexError';
    this.result = result;
    this.kind = RESULTS[result] ?? 'other';
  }
}

/* The state of WebGL 2 that geotex touches. Kept here and not in the core, which knows of objects
 * only by the numbers that its glue gave them. */
const TEXTURE_UNITS = 8;
class State {
  constructor(gl) {
    const get = (name) => gl.getParameter(name);
    this.program = get(gl.CURRENT_PROGRAM);
    this.array = get(gl.VERTEX_ARRAY_BINDING);
    this.buffer = get(gl.ARRAY_BUFFER_BINDING);
    this.pixels = get(gl.PIXEL_UNPACK_BUFFER_BINDING);
    this.unit = get(gl.ACTIVE_TEXTURE);
    this.units = [];
    for (let i = 0; i < TEXTURE_UNITS; ++i) {
      gl.activeTexture(gl.TEXTURE0 + i);
      this.units.push([get(gl.TEXTURE_BINDING_2D), get(gl.TEXTURE_BINDING_2D_ARRAY),
                       get(gl.SAMPLER_BINDING)]);
    }
    this.enabled = [gl.DEPTH_TEST, gl.CULL_FACE, gl.BLEND].map((name) => [name, gl.isEnabled(name)]);
    this.depthFunc = get(gl.DEPTH_FUNC);
    this.depthMask = get(gl.DEPTH_WRITEMASK);
    this.cullFace = get(gl.CULL_FACE_MODE);
    this.frontFace = get(gl.FRONT_FACE);
    this.colorMask = get(gl.COLOR_WRITEMASK);
    this.unpack = ['ALIGNMENT', 'ROW_LENGTH', 'SKIP_ROWS', 'SKIP_PIXELS', 'SKIP_IMAGES',
                   'IMAGE_HEIGHT', 'FLIP_Y_WEBGL', 'PREMULTIPLY_ALPHA_WEBGL']
        .map((name) => gl['UNPACK_' + name]).map((name) => [name, get(name)]);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
  }

  restore(gl) {
    gl.useProgram(this.program);
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bindBuffer(gl.PIXEL_UNPACK_BUFFER, this.pixels);
    this.units.forEach(([plain, array, sampler], i) => {
      gl.activeTexture(gl.TEXTURE0 + i);
      gl.bindTexture(gl.TEXTURE_2D, plain);
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, array);
      gl.bindSampler(i, sampler);
    });
    gl.activeTexture(this.unit);
    for (const [name, on] of this.enabled)
      on ? gl.enable(name) : gl.disable(name);
    gl.depthFunc(this.depthFunc);
    gl.depthMask(this.depthMask);
    gl.cullFace(this.cullFace);
    gl.frontFace(this.frontFace);
    gl.colorMask(...this.colorMask);
    for (const [name, value] of this.unpack)
      gl.pixelStorei(name, value);
  }
}

/* An opened `.gtx`: what it says, and rays into it on the CPU. */
export class Asset {
  #geotex; #handle; #caster = 0;

  constructor(geotex, handle) {
    this.#geotex = geotex;
    this.#handle = handle;
    const core = geotex.core, at = core._gtxw_info(handle) / 8;
    const n = core.HEAPF64.slice(at, at + 22);
    Object.assign(this, {
      patchCount: n[0], pageCount: n[1], pageWidth: n[2], pageHeight: n[3], mipCount: n[4],
      heightBits: n[5], hasColor: !!n[6], hasMaterial: !!n[7], hasEmission: !!n[8],
      lodLevels: n[9], sourceTriangles: n[10], unit: n[11], min: [...n.slice(12, 15)],
      max: [...n.slice(15, 18)], anchor: [...n.slice(18, 21)], fileBytes: n[21]});
  }

  get handle() {
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
    if (!this.#handle)
      return;
    this.#geotex.core._gtxw_caster_destroy(this.#caster);
    this.#geotex.core._gtxw_close(this.#handle);
    this.#handle = this.#caster = 0;
  }
}

/* An asset on the GPU. It keeps the asset, from which it comes back after a lost context. */
export class Model {
  constructor(geotex, asset) {
    Object.assign(this, {geotex, asset, handle: 0, ready: false});
    this.prepare();
  }

  prepare() {
    this.ready = false;
    this.handle = this.geotex.must(this.geotex.core._gtxw_model_prepare(this.asset.handle));
    this.gpuBytes = this.geotex.core._gtxw_model_gpu_bytes(this.handle);
  }

  /* Sends up to maxBytes, 0 for all. Returns whether that was the rest. */
  upload(maxBytes = 0) {
    const g = this.geotex;
    if (!this.handle)
      this.prepare();
    if (!this.ready) {
      const done = g.around(() => g.core._gtxw_model_upload(g.renderer, this.handle, maxBytes));
      if (done < 0)
        g.must(0);
      this.ready = done === 1;
    }
    return this.ready;
  }

  dispose() {
    this.geotex.models.delete(this);
    if (!this.handle)
      return;
    this.geotex.around(() => this.geotex.core._gtxw_model_destroy(this.geotex.renderer,
                                                                  this.handle));
    this.handle = 0;
    this.ready = false;
  }
}

/* Fragment mains of the page's own (gtx_shading_create). `program(method)` is the WebGLProgram. */
export class Shading {
  constructor(geotex, text) {
    Object.assign(this, {geotex, text, handle: 0});
    this.create();
  }

  create() {
    const g = this.geotex, core = g.core, size = core.lengthBytesUTF8(this.text) + 1;
    const pointer = core._malloc(size);
    core.stringToUTF8(this.text, pointer, size);
    this.handle = g.around(() => core._gtxw_shading_create(g.renderer, pointer));
    core._free(pointer);
    g.must(this.handle);
    this.programs = [Method.CAST, Method.LOD, Method.GRID].map((method) =>
      core.GL.programs[core._gtxw_shading_program(this.handle, method)]);
  }

  /* Numbers and rows of 2, 3, 4 or 16 of them; arrays of vec3 and mat4 as {vec3: [...]}, {mat4:
   * [...]}; samplers and other whole numbers as {int: n}. */
  set(uniforms) {
    const gl = this.geotex.gl, before = gl.getParameter(gl.CURRENT_PROGRAM);
    for (const program of this.programs) {
      gl.useProgram(program);
      for (const [name, value] of Object.entries(uniforms)) {
        const at = gl.getUniformLocation(program, name);
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
    }
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
    const core = await createCore({
      locateFile: (name) => wasm ?? new URL('./' + name, import.meta.url).href, onLog: log});
    return new Geotex(gl, core);
  }

  constructor(gl, core) {
    Object.assign(this, {gl, core, models: new Set(), shadings: new Set(), numbers: 0, room: 0});
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
      for (const model of this.models) {
        this.core._gtxw_model_destroy(this.renderer, model.handle);
        model.handle = 0;
        model.ready = false;
      }
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
      throw new GeotexError(this.core._gtxw_result(),
                            this.core.UTF8ToString(this.core._gtxw_message()));
    return given;
  }

  /* Calls with WebGL's state kept, and the core's context current. */
  around(call) {
    if (this.gl.isContextLost()) {
      this.core.GL.makeContextCurrent(this.context);
      return call();
    }
    const state = new State(this.gl);
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
    return new Asset(this, this.must(this.withBytes(bytes, this.core._gtxw_open)));
  }

  /* The first bytes of a file: an asset of what is there, or null, and what to wait for. */
  openPrefix(bytes) {
    const {core} = this;
    return this.withNumbers([0, 0, 0, 0], (told) => {
      const handle = this.withBytes(bytes, (at, size) => core._gtxw_open_prefix(at, size, told));
      const [needed, fileBytes] = core.HEAPF64.slice(told / 8, told / 8 + 2);
      if (!handle && core._gtxw_result())
        this.must(0);
      return {asset: handle ? new Asset(this, handle) : null, needed, fileBytes};
    });
  }

  withBytes(bytes, call) {
    const from = bytes instanceof ArrayBuffer ? new Uint8Array(bytes)
        : new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const pointer = this.core._malloc(from.length || 1);
    if (!pointer)
      throw new GeotexError(20, 'no memory for ' + from.length + ' bytes');
    this.core.HEAPU8.set(from, pointer);
    const given = call(pointer, from.length);
    this.core._free(pointer);
    return given;
  }

  /* Uploaded by the first draw, or before it in slices by upload(). */
  model(asset) {
    const model = new Model(this, asset);
    this.models.add(model);
    return model;
  }

  shading(text) {
    const shading = new Shading(this, text);
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
    this.withNumbers(floats, (f, w) => {
      if (this.around(() => this.core._gtxw_draw(this.renderer, f, w, shading, w + 24, f + 148,
                                                 handles.length)))
        this.must(0);
    }, whole);
  }

  dispose() {
    this.gl.canvas.removeEventListener?.('webglcontextlost', this.lost);
    this.gl.canvas.removeEventListener?.('webglcontextrestored', this.restored);
    for (const thing of [...this.models, ...this.shadings])
      thing.dispose();
    this.around(() => this.core._gtxw_renderer_destroy(this.renderer));
    this.core.GL.deleteContext(this.context);
    this.core._free(this.numbers);
    this.renderer = this.numbers = this.room = 0;
  }
}

const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
