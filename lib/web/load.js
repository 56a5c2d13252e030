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

/* Of a file whose table is there: its sections, each with its type, as little-endian characters,
 * level, and the numbers of its first byte and of the one behind it. */
const LODM = 0x4d444f4c, COLR = 0x524c4f43, MATL = 0x4c54414d, EMIT = 0x54494d45, HGHT = 0x54484748, NRML = 0x4c4d524e;
const viewOf = ({buffer, byteOffset, byteLength}) => new DataView(buffer, byteOffset, byteLength);
function sectionsOf(bytes) {
  const view = viewOf(bytes), count = view.getUint32(28, true);
  return Array.from({length: count}, (_, i) => 192 + 64 * i).map((at) => {
    const first = Number(view.getBigUint64(at + 16, true));
    return {type: view.getUint32(at, true), level: view.getUint32(at + 8, true), first,
            end: first + Number(view.getBigUint64(at + 24, true))};
  });
}

/* Where heights lie, and normals of all levels, which are coded against them. */
function placesIn(bytes) {
  return [HGHT, NRML].map((kind) => {
    const all = sectionsOf(bytes).filter(({type}) => type === kind);
    return {first: all[0].first, end: all[all.length - 1].end};
  });
}

/* Normals of an LOD mesh's vertices take the place of maps from which they stray by 4 degrees or less,
 * as they do where models are lit at vertices (lib/frame/lod_normals.c). */
const MAX_NORMAL_ERROR = 4 * Math.PI / 180;

/* Whether maps would show more than the normals of a model whose mip level `finest` is shown: those of
 * vertices, whose distance is up to two texels. */
export const isBlurred = ({asset}, finest) =>
  finest < 1 && !(asset.normalError <= MAX_NORMAL_ERROR);

/* How many first bytes hold all LOD meshes, if they and what is before them are fewer than the maps of
 * placesIn; else 0. */
function lodEnd(bytes) {
  const end = Math.max(0, ...sectionsOf(bytes).filter(({type}) => type === LODM).map((s) => s.end));
  return end < placesIn(bytes).reduce((n, place) => n + place.end - place.first, 0) ? end : 0;
}

/* How many first bytes hold the colours that a mip level of the file's takes, and where that is the
 * finest all else that shows. */
function lookEnds(bytes, level) {
  const coarsest = viewOf(bytes).getUint32(68, true) - 1;
  return Math.max(0, ...sectionsOf(bytes)
      .filter((s) => s.type === COLR && s.level >= Math.min(level, coarsest) ||
                     level <= 0 && (s.type === MATL || s.type === EMIT)).map(({end}) => end));
}

/* A file that is being read: from its beginning, or where the server grants ranges from a byte on,
 * to the last before `end`. */
class Source {
  static async open(ask, before, first = 0, end = 0) {
    const headers = {Range: `bytes=${first}-${end ? end - 1 : ''}`};
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
const MAX_EXPECTED = 1 << 26;
/* Bytes up to something that take no longer than asking for it: 20 ms at 25 Mbit/s. */
const NEAR = 1 << 16;

/* `ask(headers)` asks for the file; `onProgress(bytes, of)` is called as bytes come: `of` is 0 while
 * the file's size is unknown. Where the server grants ranges, a finer model is waited for only once
 * `wanted(model)` holds, or the promise that it gives does: until then nothing is read but colours as far
 * as `finest(model)`, the mip level of its own that is shown, asks for, and normals where that is
 * blurred: first those of finer LOD meshes, then maps. */
export async function* modelsOf(geotex, ask, {onProgress = () => {}, wanted = () => true,
                                              finest = () => 1} = {}) {
  const blurred = (model) => isBlurred(model, finest(model));
  const gathered = new Gathered();
  let held = []; /* pieces of what is behind it */
  let source = await Source.open(ask, null), needed = 1, size = 0, whole = 0;
  const tell = () => onProgress(held.reduce((n, {bytes}) => n + bytes.length, gathered.length), size);
  /* What is next, up to what is there already. */
  const open = async () => {
    while (held.length && held[0].first === gathered.length)
      gathered.add(held.shift().bytes);
    source = await Source.open(ask, source, gathered.length, held[0]?.first);
    if (source.begins) {
      gathered.length = 0;
      held = [];
    }
  };
  try {
    for (;;) {
      const chunk = await source.read();
      if (chunk) {
        gathered.add(chunk, Math.min(size, MAX_EXPECTED));
      } else if (held.length && gathered.length === held[0].first) {
        await open();
        continue;
      }
      tell();
      if (!chunk || size && gathered.length >= size)
        break;
      if (gathered.length < needed)
        continue;
      const {model, ...told} = await geotex.load(gathered.all, {prefix: true, pieces: held[1] && held});
      if (size !== told.fileBytes) {
        size = told.fileBytes;
        tell();
      }
      whole = told.needed ? 0 : gathered.length;
      needed = told.needed;
      if (!model)
        continue;
      /* About twice as much each time, to a section's end: all beginnings together take no longer than
       * the last two, and what makes a model finer is not waited for longer than it takes. */
      for (const {end} of sectionsOf(gathered.all))
        needed = end <= 2 * gathered.length ? Math.max(needed, end) : needed;
      yield model;
      if (!source.grants || whole)
        continue;
      let fine = wanted(model), shown = model;
      if (fine === true)
        continue;
      if (gathered.length < lodEnd(gathered.all) && blurred(model)) {
        needed = Math.min(needed, lodEnd(gathered.all));
        continue;
      }
      const look = () => lookEnds(gathered.all, finest(shown) + Math.round(Math.log2(
          viewOf(gathered.all).getUint32(60, true) / shown.asset.pageWidth)));
      if (gathered.length < look()) {
        needed = Math.min(needed, look());
        continue;
      }
      for (; fine !== true && gathered.length >= look(); fine = wanted(shown)) {
        if (held.length || !blurred(shown)) {
          source.stop();
          await fine;
          continue;
        }
        const places = placesIn(gathered.all);
        if (places[0].first - gathered.length > NEAR)
          source.stop();
        held = await Promise.all(places.map(async ({first, end}, i) => {
          while (!i && gathered.length < end && !source.ended) {
            const chunk = await source.read();
            if (chunk)
              gathered.add(chunk, Math.min(size, MAX_EXPECTED));
          }
          if (!i)
            source.stop(); /* it would take its share of the line */
          if (gathered.length >= end)
            return {first, bytes: gathered.bytes.slice(first, end)};
          const asked = await Source.open(ask, source, first, end), piece = new Gathered();
          if (!asked.grants)
            return asked.stop() ?? {};
          for (let chunk; (chunk = await asked.read());)
            piece.add(chunk);
          return {first, bytes: piece.all};
        }));
        source.stop();
        gathered.length = Math.min(gathered.length, held[0].first ?? 0);
        if (!held.every(({bytes}) => bytes)) {
          held = []; /* another file by now */
          break;
        }
        tell();
        shown = (await geotex.load(gathered.all, {prefix: true, pieces: held})).model;
        yield shown;
      }
      if (fine !== true)
        needed = Math.min(needed, look() || needed);
      await open();
    }
    /* A line that broke: what it did bring is shown, and then the error. */
    if (gathered.length < size) {
      const {model} = await geotex.load(gathered.all, {prefix: true, pieces: held[1] && held});
      if (model)
        yield model;
    }
    if (!whole || whole !== gathered.length)
      yield (await geotex.load(gathered.all)).model;
  } finally {
    source.stop();
  }
}
