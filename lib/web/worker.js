/* A core of its own in a worker: opens what the page sends it and prepares it, and gives back what
 * the page needs to draw it. Nothing stays. */
import createCore from './core.js';
import {failure, GeotexError, infoOf, openBytes, resourcesOf} from './inside.js';

let core = null;

function prepare(bytes, how) {
  const told = openBytes(core, bytes, how), {handle} = told, given = [];
  if (!handle)
    return {made: {told, info: null}, given};
  const copy = (from, size) => {
    const out = core.HEAPU8.slice(from, from + size);
    given.push(out.buffer);
    return out;
  };
  const model = core._gtxw_model_prepare(handle, how.software);
  try {
    if (!model)
      throw failure(core);
    const size = core._malloc(4), plan = core._gtxw_model_pack(model, size);
    if (!plan)
      throw new GeotexError(20, 'no memory to hand a model over');
    const made = {told, info: infoOf(core, handle), plan: copy(plan, core.HEAPU32[size / 4]),
                  resources: resourcesOf(core, model, copy)};
    core._free(plan);
    core._free(size);
    return {made, given};
  } finally {
    core._gtxw_model_destroy(0, model);
    core._gtxw_close(handle);
  }
}

onmessage = async ({data: {id, wasm, bytes, how}}) => {
  try {
    core ??= createCore({locateFile: () => wasm, onLog: () => {}});
    core = await core;
    const {made, given} = prepare(bytes, how);
    postMessage({id, made}, given);
  } catch (error) {
    postMessage({id, result: error.result, message: String(error.message ?? error)});
  }
};
