import type {Asset, Geotex} from './geotex.js';

/** Assets of a download's first bytes, coarse, then finer; the last is the file's, or an error is
 * thrown. Each is the caller's to dispose. `of` is 0 while the file's size is unknown. */
export function assetsOf(geotex: Geotex, response: Response,
                         onProgress?: (bytes: number, of: number) => void):
    AsyncGenerator<Asset, void, void>;
