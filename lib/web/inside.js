/* What the page and its worker both do with a core: bytes go in, numbers and errors come out. */

/* As gtx_result; 0 is no error. */
const RESULTS = {
  10: 'argument', 11: 'not-zeroed', 20: 'memory', 21: 'limit', 30: 'read', 40: 'not-gtx',
  41: 'version', 42: 'truncated', 43: 'corrupt', 45: 'unsupported', 60: 'input', 61: 'empty', 80: 'gl',
  81: 'shader', 99: 'internal'};

export class GeotexError extends Error {
  constructor(result, message) {
    super(message);
    this.name = 'GeotexError';
    this.result = result;
    this.kind = RESULTS[result] ?? 'other';
  }
}

/* What the last call failed by. */
export const failure = (core) =>
  new GeotexError(core._gtxw_result(), core.UTF8ToString(core._gtxw_message()));

/* Calls with a copy of the bytes in the core's memory. */
export function withBytes(core, bytes, call) {
  const from = ArrayBuffer.isView(bytes)
      ? new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength) : new Uint8Array(bytes);
  const pointer = core._malloc(from.length || 1);
  if (!pointer)
    throw new GeotexError(20, 'no memory for ' + from.length + ' bytes');
  core.HEAPU8.set(from, pointer);
  const given = call(pointer, from.length);
  core._free(pointer);
  return given;
}

/* Of a file's first bytes, and of two pieces {first, bytes} of what is behind them, or none. */
export function openPrefix(core, bytes, pieces) {
  const told = core._malloc(48), places = told + 16;
  const open = (at, size, more) => core._gtxw_open_prefix(at, size, more, places, told);
  const more = pieces && new Uint8Array(pieces[0].bytes.length + pieces[1].bytes.length);
  pieces?.forEach(({first, bytes: {length}, bytes: piece}, i) => {
    core.HEAPF64.set([first, length], places / 8 + 2 * i);
    more.set(piece, i * pieces[0].bytes.length);
  });
  const handle = withBytes(core, bytes, (at, size) =>
    more ? withBytes(core, more, (from) => open(at, size, from)) : open(at, size, 0));
  const [needed, fileBytes] = core.HEAPF64.slice(told / 8, told / 8 + 2);
  core._free(told);
  if (!handle && core._gtxw_result())
    throw failure(core);
  return {handle, needed, fileBytes};
}

/* A file's bytes; its first, with `prefix`, and pieces of the rest; or, with the bytes of a
 * gtx_stream_request, what was read for that. Gives a handle, and of a prefix what to wait for. */
export function openBytes(core, bytes, {prefix, pieces, request} = {}) {
  if (!request && prefix)
    return openPrefix(core, bytes, pieces);
  const handle = request
      ? withBytes(core, request, (asked) =>
          withBytes(core, bytes, (at, size) => core._gtxw_world_open(asked, at, size)))
      : withBytes(core, bytes, core._gtxw_open);
  if (!handle)
    throw failure(core);
  return {handle};
}

/* As Asset of geotex.d.ts has them. */
export function infoOf(core, handle) {
  const at = core._gtxw_info(handle) / 8, n = core.HEAPF64.slice(at, at + 24);
  return {
    patchCount: n[0], pageCount: n[1], pageWidth: n[2], pageHeight: n[3], mipCount: n[4],
    heightBits: n[5], hasColor: !!n[6], hasMaterial: !!n[7], hasEmission: !!n[8],
    lodLevels: n[9], sourceTriangles: n[10], unit: n[11], min: [...n.slice(12, 15)],
    max: [...n.slice(15, 18)], anchor: [...n.slice(18, 21)], fileBytes: n[21], lodError: n[22],
    normalError: n[23]};
}

const SLOTS = 7, OF_A_SLOT = 15, BUFFERS = 4;

/* What a model has for the GPU: textures, whose place is their slot, and buffers. `bytes(from,
 * size)` gives what lies in the core's memory there, now or later. */
export function resourcesOf(core, model, bytes = null) {
  bytes ??= (from, size) => () => core.HEAPU8.subarray(from, from + size);
  const at = core._gtxw_model_resources(model) / 4;
  const n = [...core.HEAPU32.subarray(at, at + SLOTS * OF_A_SLOT + 2 * BUFFERS)];
  const textures = [];
  for (let slot = 0; slot < SLOTS; ++slot, n.splice(0, OF_A_SLOT)) {
    const [format, texelSize, width, height, layers, levels, isArray, ...places] = n;
    textures.push({format, texelSize, width, height, layers, isArray: !!isArray,
                   levels: places.slice(0, levels).map((from, k) =>
                     bytes(from, (width >> k) * (height >> k) * layers * texelSize))});
  }
  const buffers = [];
  for (let i = 0; i < BUFFERS; ++i)
    buffers.push(bytes(n[2 * i], n[2 * i + 1]));
  return {textures, buffers};
}
