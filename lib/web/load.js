/* Models out of a download: of its first bytes, coarse, then finer, then the whole.
 *
 *   for await (const model of modelsOf(geotex, (headers) => fetch('model.gtx', {headers})))
 *     ...                              the last is the file's, as geotex.load gives it
 *
 * Each, and its asset, is the caller's to dispose. A file that ends early, or is broken, throws. */
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

/* A file that is being read: from its beginning, or from a byte on where the server grants ranges. */
class Source {
  static async open(ask, before, first = 0) {
    const headers = {Range: `bytes=${first}-`};
    if (before?.tag)
      headers['If-Range'] = before.tag;
    const response = await ask(headers);
    if (!response.ok)
      throw new GeotexError(30, `${response.url}: ${response.status} ${response.statusText}`);
    return new Source(response);
  }

  constructor(response) {
    this.reader = response.body.getReader();
    /* From where is asked for alone: a server that has another file by now sends all of it. */
    this.grants = response.status === 206;
    this.begins = !this.grants;
    this.tag = response.headers.get('etag') ?? response.headers.get('last-modified');
  }

  async read() {
    const {value, done} = await this.reader.read();
    this.ended = done;
    return value;
  }

  stop() {
    if (!this.ended)
      this.reader.cancel().catch(() => {});
    this.ended = true;
  }
}

/* Told by a file's own head, which anybody may have written: room is made for no more at once. */
const MOST_EXPECTED = 1 << 26;

/* `ask(headers)` asks for the file; `onProgress(bytes, of)` is called as bytes come: `of` is 0 while
 * the file's size is unknown. Where the server grants ranges, a finer model is waited for only once
 * `wanted(model)` holds, or the promise that it gives does: until then nothing is read. */
export async function* modelsOf(geotex, ask, {onProgress = () => {}, wanted = () => true} = {}) {
  const gathered = new Gathered();
  let source = await Source.open(ask, null), needed = 1, size = 0, whole = 0;
  try {
    for (;;) {
      const chunk = await source.read();
      if (chunk)
        gathered.add(chunk, Math.min(size, MOST_EXPECTED));
      onProgress(gathered.length, size);
      if (!chunk || size && gathered.length >= size)
        break;
      if (gathered.length < needed)
        continue;
      const {model, ...told} = await geotex.load(gathered.all, true);
      size = told.fileBytes;
      whole = told.needed ? 0 : gathered.length;
      /* Twice as much each time: all beginnings together take no longer than the last two. */
      needed = Math.max(told.needed, model ? 2 * gathered.length : 0);
      if (!model)
        continue;
      yield model;
      if (!source.grants || whole)
        continue;
      let fine = wanted(model);
      if (fine === true)
        continue;
      source.stop();
      while (fine !== true)
        await fine, fine = wanted(model);
      source = await Source.open(ask, source, gathered.length);
      if (source.begins)
        gathered.length = 0;
    }
    /* A line that broke: what it did bring is shown, and then the error. */
    const rest = gathered.length < size ? (await geotex.load(gathered.all, true)).model : null;
    if (rest)
      yield rest;
    if (!whole || whole !== gathered.length)
      yield (await geotex.load(gathered.all)).model;
  } finally {
    source.stop();
  }
}
