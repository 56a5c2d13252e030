/* Assets out of a download: of its first bytes, coarse, then finer, then the whole.
 *
 *   for await (const asset of assetsOf(geotex, await fetch('model.gtx')))
 *     ...                              the last is the file's, as geotex.open gives it
 *
 * Each is the caller's to dispose. A file that ends early, or is broken, throws. */
import {GeotexError} from './geotex.js';

/* What has come so far, in one piece. */
class Gathered {
  bytes = new Uint8Array(1 << 16);
  length = 0;

  /* `expected`: of the whole file, 0 where nobody has said. */
  add(chunk, expected) {
    const length = this.length + chunk.length;
    if (length > this.bytes.length) {
      const grown = new Uint8Array(Math.max(length, expected || 2 * this.bytes.length));
      grown.set(this.bytes.subarray(0, this.length));
      this.bytes = grown;
    }
    this.bytes.set(chunk, this.length);
    this.length = length;
  }

  get all() {
    return this.bytes.subarray(0, this.length);
  }
}

/* Told by a file's own head, which anybody may have written: room is made for no more at once. */
const MOST_EXPECTED = 1 << 26;

/* `onProgress(bytes, of)` is called as bytes come; `of` is 0 while the file's size is unknown. */
export async function* assetsOf(geotex, response, onProgress = () => {}) {
  if (!response.ok)
    throw new GeotexError(30, `${response.url}: ${response.status} ${response.statusText}`);
  const gathered = new Gathered(), reader = response.body.getReader();
  let needed = 1, size = 0, whole = 0, ended = false;
  try {
    while (!ended) {
      const {value, done} = await reader.read();
      ended = done;
      if (value)
        gathered.add(value, Math.min(size, MOST_EXPECTED));
      onProgress(gathered.length, size);
      if (ended || gathered.length < needed || size && gathered.length >= size)
        continue;
      const prefix = geotex.openPrefix(gathered.all);
      size = prefix.fileBytes;
      whole = prefix.needed ? 0 : gathered.length;
      /* Twice as much each time: all beginnings together take no longer than the last two. */
      needed = Math.max(prefix.needed, prefix.asset ? 2 * gathered.length : 0);
      if (prefix.asset)
        yield prefix.asset;
    }
    /* A line that broke: what it did bring is shown, and then the error. */
    const rest = gathered.length < size ? geotex.openPrefix(gathered.all).asset : null;
    if (rest)
      yield rest;
    if (!whole || whole !== gathered.length)
      yield geotex.open(gathered.all);
  } finally {
    if (!ended)
      reader.cancel().catch(() => {});
  }
}
