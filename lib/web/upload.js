/* What a model has for the GPU, sent in slices: of the core's memory, or of what a worker gave. */
import {GeotexError} from './inside.js';

/* By gtx_format: how WebGL names it, whether it is filtered, and what it is sent as. */
const FORMATS = [null,
  ['R8', 'RED', 'UNSIGNED_BYTE', false, Uint8Array],
  ['RG8', 'RG', 'UNSIGNED_BYTE', true, Uint8Array],
  ['RGBA8', 'RGBA', 'UNSIGNED_BYTE', true, Uint8Array],
  ['SRGB8', 'RGB', 'UNSIGNED_BYTE', true, Uint8Array],
  ['SRGB8_ALPHA8', 'RGBA', 'UNSIGNED_BYTE', true, Uint8Array],
  ['R8UI', 'RED_INTEGER', 'UNSIGNED_BYTE', false, Uint8Array],
  ['R16UI', 'RED_INTEGER', 'UNSIGNED_SHORT', false, Uint16Array],
  ['RGBA32F', 'RGBA', 'FLOAT', false, Float32Array]];
const INDEX_BUFFERS = new Set([1, 3]);

/* As gtx_slot. */
export const Slot = Object.freeze({COLORS: 3});

export function unpackPlainly(gl) {
  gl.bindBuffer(gl.PIXEL_UNPACK_BUFFER, null);
  for (const name of ['ROW_LENGTH', 'SKIP_ROWS', 'SKIP_PIXELS', 'SKIP_IMAGES', 'IMAGE_HEIGHT'])
    gl.pixelStorei(gl['UNPACK_' + name], 0);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.activeTexture(gl.TEXTURE0);
}

/* The glue's number of an object, which the core knows it by. */
function named(GL, table, object) {
  const name = GL.getNewId(table);
  object.name = name;
  table[name] = object;
  return name;
}

const bytesOf = (held) => typeof held === 'function' ? held() : held;

export class Upload {
  #gl; #GL; #pieces = [];

  /* Makes the textures and buffers, still empty. */
  constructor({gl, core: {GL}}, {textures, buffers}) {
    this.#gl = gl;
    this.#GL = GL;
    const side = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    const most = gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS);
    for (const {width: w, height: h, layers} of textures)
      if (Math.max(w, h) > side || layers > most)
        throw new GeotexError(21, `a texture of ${w} x ${h} x ${layers} is beyond this GPU's ` +
                                  `${side} x ${side} x ${most}`);
    this.array = gl.createVertexArray(); /* whose element buffer is nobody's */
    gl.activeTexture(gl.TEXTURE0);
    this.names = textures.map((t) => t.levels.length ? this.#texture(t) : 0);
    gl.bindVertexArray(this.array);
    buffers.forEach((held, i) => this.names.push(this.#buffer(held, INDEX_BUFFERS.has(i))));
  }

  #texture(t) {
    const gl = this.#gl, [inner, format, type, filtered, Values] = FORMATS[t.format];
    const target = t.isArray ? gl.TEXTURE_2D_ARRAY : gl.TEXTURE_2D, texture = gl.createTexture();
    gl.bindTexture(target, texture);
    for (const [name, value] of [
      ['MAX_LEVEL', t.levels.length - 1], ['MAG_FILTER', filtered ? gl.LINEAR : gl.NEAREST],
      ['MIN_FILTER', filtered ? gl.LINEAR_MIPMAP_NEAREST : gl.NEAREST],
      ['WRAP_S', gl.CLAMP_TO_EDGE], ['WRAP_T', gl.CLAMP_TO_EDGE]])
      gl.texParameteri(target, gl['TEXTURE_' + name], value);
    t.levels.forEach((held, level) => {
      const width = t.width >> level, height = t.height >> level;
      const size = t.isArray ? [width, height, t.layers] : [width, height];
      gl[t.isArray ? 'texImage3D' : 'texImage2D'](target, level, gl[inner], ...size, 0, gl[format],
                                                  gl[type], null);
      this.#pieces.push({held, at: 0, row: width * t.texelSize, rows: height * t.layers,
                         put: (bytes, y, count) => {
        const values = new Values(bytes.buffer, bytes.byteOffset,
                                  bytes.length / Values.BYTES_PER_ELEMENT);
        gl.bindTexture(target, texture);
        gl[t.isArray ? 'texSubImage3D' : 'texSubImage2D'](
            target, level, 0, y % height, ...(t.isArray ? [Math.floor(y / height)] : []), width,
            count, ...(t.isArray ? [1] : []), gl[format], gl[type], values);
      }, most: (y) => height - y % height});
    });
    return named(this.#GL, this.#GL.textures, texture);
  }

  #buffer(held, isIndices) {
    const gl = this.#gl, target = isIndices ? gl.ELEMENT_ARRAY_BUFFER : gl.ARRAY_BUFFER;
    const buffer = gl.createBuffer(), {length} = bytesOf(held);
    gl.bindBuffer(target, buffer);
    gl.bufferData(target, length, gl.STATIC_DRAW);
    this.#pieces.push({held, at: 0, row: 1, rows: length, put: (bytes, at) => {
      gl.bindBuffer(target, buffer);
      gl.bufferSubData(target, at, bytes);
    }, most: (at) => length - at});
    return named(this.#GL, this.#GL.buffers, buffer);
  }

  /* Up to so many bytes, but a row at least. Whether that was the rest. */
  send(bytes) {
    const gl = this.#gl;
    unpackPlainly(gl);
    gl.bindVertexArray(this.array);
    while (this.#pieces.length && bytes > 0) {
      const piece = this.#pieces[this.#pieces.length - 1], {row, rows, at} = piece;
      if (at === rows) {
        this.#pieces.pop();
        continue;
      }
      const count = Math.max(1, Math.min(piece.most(at), Math.floor(bytes / row)));
      piece.put(bytesOf(piece.held).subarray(at * row, (at + count) * row), at, count);
      piece.at += count;
      bytes -= count * row;
    }
    const done = !this.#pieces.length;
    if (done)
      gl.deleteVertexArray(this.array);
    return done;
  }

  /* Gives back what nobody has taken. */
  stop() {
    const gl = this.#gl, GL = this.#GL;
    gl.deleteVertexArray(this.array);
    this.names.forEach((name, i) => {
      const table = i < this.names.length - 4 ? GL.textures : GL.buffers;
      if (name)
        table === GL.textures ? gl.deleteTexture(table[name]) : gl.deleteBuffer(table[name]);
      table[name] = null;
    });
  }
}
