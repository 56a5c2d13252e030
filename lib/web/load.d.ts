import type {Geotex, Model} from './geotex.js';

/** Models of a download's first bytes, coarse, then finer; the last is the file's, or an error is
 * thrown. Each, and its asset, is the caller's to dispose. `ask` sends a request with the headers. */
export function modelsOf(geotex: Geotex, ask: (headers: Record<string, string>) => Promise<Response>,
                         options?: {
  /** `of` is 0 while the file's size is unknown. */
  onProgress?: (bytes: number, of: number) => void,
  /** Whether something finer than `model` is wanted, or a promise to be asked again: until then
   * nothing is read, where the server grants ranges (206). Without it: always. */
  wanted?: (model: Model) => true | PromiseLike<unknown>,
  /** The finest mip level that is shown, of those of `model`, below 0 of finer ones. Below 1 its normals
   * are read, too, from within the file, unless those of vertices are as good. Without it: 1. */
  finest?: (model: Model) => number,
}): AsyncGenerator<Model, void, void>;
