/* Models into assets, in the page: `await cook(bytes, {name: 'bunny.ply'})` gives the bytes of a `.gtx`,
 * the same as `gtx cook` makes of that file. Nothing is uploaded. The cooker, a module of its own, is
 * loaded by the first call, and each runs in a worker. Types and options are in cook.d.ts. */
import {GeotexError} from './inside.js';

const PARTITIONS = {default: 0, cuts: 1, vsa: 2, pgp: 3, layers: 4, relief: 5, auto: 6};
const NO_LODS = 0xffffffff;

/* Options as the numbers of a gtx_cook_desc. */
function numbersOf({partition = 'default', lodLevels, ...rest}) {
  if (!(partition in PARTITIONS))
    throw new GeotexError(10, `no partition "${partition}": ${Object.keys(PARTITIONS).join(', ')}`);
  const numbers = {...rest, partition: PARTITIONS[partition]};
  if (lodLevels !== undefined)
    numbers.lodLevels = lodLevels === 0 ? NO_LODS : lodLevels;
  for (const [key, value] of Object.entries(numbers)) {
    numbers[key] = Number(value);
    if (!isFinite(numbers[key]) || numbers[key] < (key === 'zstdLevel' ? -1 : 0))
      throw new GeotexError(10, `"${key}" is no number from 0 on`);
  }
  return Object.entries(numbers);
}

export async function cook(bytes, {name = 'model.ply', wasm, signal, onProgress = () => {},
                                   onWarning = () => {}, ...options} = {}) {
  const numbers = numbersOf(options);
  const from = ArrayBuffer.isView(bytes) ? bytes : new Uint8Array(bytes);
  const copy = new Uint8Array(from.buffer, from.byteOffset, from.byteLength).slice();
  const place = new URL(wasm ?? new URL('./cooker.wasm', import.meta.url), document.baseURI).href;
  signal?.throwIfAborted();
  const worker = new Worker(new URL('./cook-worker.js', import.meta.url), {type: 'module'});
  let stop;
  try {
    return await new Promise((resolve, reject) => {
      stop = () => reject(signal.reason);
      signal?.addEventListener('abort', stop);
      worker.onerror = (event) =>
        reject(new GeotexError(45, `the cooker is not there: ${event.message ?? place}`));
      worker.onmessage = ({data: {stage, fraction, asset, warnings, result, message}}) => {
        if (stage)
          return onProgress(fraction, stage);
        if (!asset)
          return reject(new GeotexError(result, message));
        warnings.forEach((sentence) => onWarning(sentence));
        resolve(asset);
      };
      worker.postMessage({wasm: place, bytes: copy, name, numbers}, [copy.buffer]);
    });
  } finally {
    signal?.removeEventListener('abort', stop);
    worker.terminate();
  }
}
