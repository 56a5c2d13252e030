/* The page's end of worker.js: there while there is something to open, and a little longer. */
import {GeotexError} from './inside.js';

const IDLE = 1000; /* ms; starting anew takes some 100, and until then its memory is kept */

export class Workshop {
  #wasm; #worker = null; #asked = new Map(); #next = 0; #idle = 0; #broken = false;

  constructor(wasm) {
    this.#wasm = wasm;
  }

  /* What worker.js makes of a copy of the bytes; null where there can be no worker. */
  prepare(bytes, how) {
    if (!this.start())
      return Promise.resolve(null);
    const view = ArrayBuffer.isView(bytes) ? bytes : new Uint8Array(bytes);
    const copy = new Uint8Array(view.buffer, view.byteOffset, view.byteLength).slice();
    const id = this.#next++;
    clearTimeout(this.#idle);
    return new Promise((resolve, reject) => {
      this.#asked.set(id, {resolve, reject});
      this.#worker.postMessage({id, wasm: this.#wasm, bytes: copy, how}, [copy.buffer]);
    });
  }

  /* Ahead of time, for instance while bytes are still on their way. */
  start() {
    if (this.#worker || this.#broken)
      return !this.#broken;
    try {
      this.#worker = new Worker(new URL('./worker.js', import.meta.url), {type: 'module'});
    } catch {
      this.#broken = true; /* a package of another origin, or a policy of the page */
      return false;
    }
    this.#worker.onmessage = ({data: {id, made, result, message}}) => {
      const {resolve, reject} = this.#asked.get(id);
      this.#asked.delete(id);
      if (made || result === undefined)
        resolve(made ?? null);
      else
        reject(new GeotexError(result, message));
      if (!this.#asked.size)
        this.#idle = setTimeout(() => this.#stop(), IDLE);
    };
    this.#worker.onerror = () => {
      this.#broken = true;
      this.#stop();
    };
    return true;
  }

  #stop() {
    this.#worker?.terminate();
    this.#worker = null;
    for (const {resolve} of this.#asked.values())
      resolve(null);
    this.#asked.clear();
  }

  close() {
    clearTimeout(this.#idle);
    this.#broken = true;
    this.#stop();
  }
}
