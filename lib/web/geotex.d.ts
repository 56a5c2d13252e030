/** Ways of drawing (gtx_method): AUTO takes for each part what is fastest within the error. */
export const Method: Readonly<{AUTO: 0, CAST: 1, PAPER: 2, LOD: 3, GRID: 4}>;
/** What a draw writes besides depth (gtx_pass). */
export const Pass: Readonly<{FORWARD: 0, DEPTH: 1, ID: 2, GBUFFER: 3}>;

/** `result` is a gtx_result of geotex.h, `kind` its name. */
export class GeotexError extends Error {
  result: number;
  kind: string;
}

export type Numbers = ArrayLike<number> & Iterable<number>;

export interface Hit {
  /** In units of the ray's direction. */
  t: number;
  point: number[];
  /** Unit, of the normal map, in the asset's space. */
  normal: number[];
  /** Unit, of the height field. */
  facet: number[];
  /** Linear red, green, blue, alpha. */
  color: number[];
}

/** An opened `.gtx`. Lengths are object units, relative to `anchor`. */
export class Asset {
  readonly patchCount: number;
  readonly pageCount: number;
  readonly pageWidth: number;
  readonly pageHeight: number;
  readonly mipCount: number;
  readonly heightBits: 8 | 16;
  readonly hasColor: boolean;
  readonly hasMaterial: boolean;
  readonly hasEmission: boolean;
  readonly lodLevels: number;
  readonly sourceTriangles: number;
  /** Metres per object unit. */
  readonly unit: number;
  readonly min: number[];
  readonly max: number[];
  readonly anchor: number[];
  /** Bytes that were opened: of a beginning fewer than the file has. */
  readonly fileBytes: number;
  /** Of the finest LOD mesh, object units: how far it is from the surface. */
  readonly lodError: number;
  /** How far normals of its vertices stray from the maps, in radians; infinite where it has none. */
  readonly normalError: number;
  /** The nearest hit, on the CPU; null where nothing is hit. */
  raycast(origin: Numbers, direction: Numbers,
          options?: {near?: number, far?: number, twoSided?: boolean}): Hit | null;
  dispose(): void;
}

/** An asset on the GPU. Keep the asset for as long: after a lost context it is read again. */
export class Model {
  readonly asset: Asset;
  readonly ready: boolean;
  readonly gpuBytes: number;
  /** Sends up to `maxBytes`, 0 for all; returns whether that was the rest. Draws send all. */
  upload(maxBytes?: number): boolean;
  /** Of a view, whose matrix takes the asset's coordinates to clip space, and the picture's height:
   * pixels of a unit where a patch in it is nearest, and of a texel where they are most. */
  need(clip: Numbers, height: number): {unit: number, texel: number};
  /** Blends a colour (sRGB, 0 to 1) into those around a point, less towards `radius`, by `strength`
   * (1); the asset keeps it. False where it meets nothing, or there are no colours. */
  paint(point: Numbers, radius: number, color: number[], strength?: number): boolean;
  dispose(): void;
}

/** Fragment mains of your own: GLSL as gtx_shading_create takes it. With `later` there is a program
 * only once something is drawn by it, and what is wrong with it is told by that draw. */
export class Shading {
  readonly programs: WebGLProgram[];
  set(uniforms: Record<string, number | Numbers | {int: number} | {vec3: Numbers} |
                               {mat4: Numbers}>): void;
  dispose(): void;
}

export interface View {
  /** Column-major, world to eye, and eye to clip. */
  view: Numbers;
  projection: Numbers;
  /** Of the viewport, in pixels. */
  width?: number;
  height?: number;
  /** World space, towards the light; none is a headlight. */
  light?: Numbers;
  /** Share of colour without light; 0.2. */
  ambient?: number;
  /** Pixels; 0.5. */
  maxError?: number;
  method?: number;
  pass?: number;
  level?: number;
  /** 1: reversed depth; 2: depth from 0 to 1. */
  flags?: number;
  shading?: Shading;
  /** WebGL's state, where the page knows it and a browser would wait for the GPU's process. */
  known?: {depthFunc?: number, depthMask?: boolean, cullFace?: number, frontFace?: number,
           colorMask?: boolean[]};
}

export interface Instance {
  model: Model;
  /** Column-major and affine; none is the identity. */
  transform?: Numbers;
  /** Multiplies the colour; none is white. */
  tint?: Numbers;
}

export class Geotex {
  /** `gl` stays the page's: its state is left as it was by every call. */
  static create(gl: WebGL2RenderingContext,
                options?: {wasm?: string, log?: (line: string) => void}): Promise<Geotex>;
  /** Throws GeotexError where the bytes are no whole, sound `.gtx`. They are not kept. */
  open(bytes: ArrayBuffer | ArrayBufferView): Asset;
  /** The first bytes of a file: an asset of what is there, without heights, null where nothing can
   * be shown yet; so many first bytes that show more, 0 for a whole file; and the file's size, 0
   * while that is unknown. */
  openPrefix(bytes: ArrayBuffer | ArrayBufferView):
      {asset: Asset | null, needed: number, fileBytes: number};
  model(asset: Asset): Model;
  /** Opened and prepared by a worker, where the page may have one: no long task here. The bytes are
   * kept as they are, for rays and for a lost context: the first of either opens them here, too. With
   * `prefix` the bytes are a file's first, as openPrefix has them, and `pieces` are its heights and
   * its normals, from the byte numbered `first` on: then the model is drawn as that of the whole file
   * by its LOD meshes. */
  load(bytes: ArrayBuffer | ArrayBufferView): Promise<{asset: Asset, model: Model}>;
  load(bytes: ArrayBuffer | ArrayBufferView,
       how: {prefix: true, pieces?: {first: number, bytes: Uint8Array}[]}):
      Promise<{asset: Asset | null, model: Model | null, needed: number, fileBytes: number}>;
  shading(text: string, later?: boolean): Shading;
  draw(view: View, instances: Instance[]): void;
  dispose(): void;
}
