export interface CookOptions {
  /** Its ending tells the format where the bytes do not: glb, gltf, drc, ply, obj, off, stl, each also
   * followed by .gz. Files that a model refers to are not read. */
  name?: string;
  /** 0 to 1, never falling, and what is being done. */
  onProgress?: (fraction: number, stage: string) => void;
  /** A sentence of what was left out, mended or found. */
  onWarning?: (sentence: string) => void;
  /** Ends the cook at once: it rejects with the signal's reason. */
  signal?: AbortSignal;
  /** Where cooker.wasm lies, if not beside cook.js. */
  wasm?: string;
  /** As `gtx cook` has them, and gtx_cook_desc of geotex/cook.h: 0 is each one's default, but 0
   * lodLevels is none. */
  partition?: 'default' | 'cuts' | 'vsa' | 'pgp' | 'layers' | 'relief' | 'auto';
  charts?: number;
  resolution?: number;
  heightBits?: number;
  dilation?: number;
  mips?: number;
  lodLevels?: number;
  zstdLevel?: number;
  /** Greatest RMS distance, as a fraction of the bounding diagonal. */
  error?: number;
  /** Metres per object unit. */
  unit?: number;
  zUp?: boolean;
  adaptive?: boolean;
  closed?: boolean;
  strict?: boolean;
  /** What it may take at most (gtx_limits); the module itself has 2 GB. */
  memory?: number;
  triangles?: number;
  texels?: number;
  patches?: number;
  work?: number;
}

/** The bytes of a `.gtx`, those that `gtx cook` makes of the same bytes and options. `bytes` stay as
 * they are. Throws GeotexError: of a broken model, a limit, no memory; or if the package was built
 * without the cooker. */
export function cook(bytes: ArrayBuffer | ArrayBufferView, options?: CookOptions): Promise<Uint8Array>;
