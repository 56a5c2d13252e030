/* The cooker in a worker of its own: one model in, one asset out; then cook.js ends it, memory and all. */
import createCooker from './cooker.js';

function place(core, bytes) {
  const at = core._malloc(bytes.length || 1);
  if (!at)
    throw {result: 20, message: `no memory for a model of ${bytes.length} bytes`};
  core.HEAPU8.set(bytes, at);
  return at;
}

function text(core, string) {
  const size = core.lengthBytesUTF8(string) + 1, at = place(core, new Uint8Array(size));
  core.stringToUTF8(string, at, size);
  return at;
}

const failed = (core) => ({result: core._gtxk_result(), message: core.UTF8ToString(core._gtxk_message())});

onmessage = async ({data: {wasm, bytes, name, numbers}}) => {
  try {
    const core = await createCooker({locateFile: () => wasm, onProgress: (stage, fraction) =>
      postMessage({stage, fraction})}).catch(({message}) => {
        throw {result: 45, message: `the cooker at ${wasm} does not start: ${message}`};
      });
    core._gtxk_begin();
    for (const [key, value] of numbers)
      if (!core._gtxk_set(text(core, key), value))
        throw {result: 10, message: `the cooker has no option "${key}"`};
    if (core._gtxk_cook(place(core, bytes), bytes.length, text(core, name)))
      throw failed(core);
    const from = core._gtxk_data(), asset = core.HEAPU8.slice(from, from + core._gtxk_size());
    const warnings = [];
    for (let i = 0, at; (at = core._gtxk_warning(i)); ++i)
      warnings.push(core.UTF8ToString(at));
    postMessage({asset, warnings}, [asset.buffer]);
  } catch (error) {
    /* Memory that ends where nothing of the cooker's asks for it stops the module. */
    const memory = error instanceof RangeError || /memory|abort/i.test(error.message ?? '');
    postMessage({result: error.result ?? (memory ? 20 : 99), message: error.result ? error.message :
      `the cooker stopped: ${error.message ?? error}`});
  }
};
