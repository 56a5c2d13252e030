import type {Camera, Mesh, WebGLRenderer} from 'three';
import type {GeotexError} from './geotex.js';

export interface WorldOptions {
  /** Budgets; 1 GiB, 512 MiB and 8 MiB. */
  cpuBytes?: number;
  gpuBytes?: number;
  /** Sent to the GPU a frame. */
  uploadBytes?: number;
  /** Pixels that a tile may be off before its children take its place; 1. */
  tileError?: number;
  /** At once; 8. */
  maxRequests?: number;
  /** Of every request: headers, credentials. */
  requests?: RequestInit;
  /** A tile that did not come; with 0 tries left its parent stands. */
  onError?: (uri: string, error: GeotexError, triesLeft: number) => void;
  wasm?: string;
  log?: (line: string) => void;
}

/** A world of `gtx world`. Its space is that of the tiles' coordinates less `origin`; +Y is up. */
export class GeotexWorld extends Mesh {
  /** `folder` is where `tiles.gtw` lies. Without ranges from the server more is read than is kept. */
  static open(renderer: WebGLRenderer, folder: string, options?: WorldOptions): Promise<GeotexWorld>;
  readonly origin: number[];
  readonly min: number[];
  readonly max: number[];
  readonly tileCount: number;
  /** Metres per unit. */
  readonly unit: number;
  /** Of all tiles. */
  readonly fileBytes: number;
  /** Pixels that what is drawn of a tile may be off; 0.5. */
  maxError: number;
  /** Of the last frame. All that is going to come is there where `pending` is `withoutRoom`. */
  readonly state: {pending?: number, withoutRoom?: number, givenUp?: number, resident?: number,
                   underWay?: number, cpuBytes?: number, gpuBytes?: number};
  /** Asks for what a camera sees; a frame that shows the world does so by itself. */
  update(camera: Camera): void;
  dispose(): void;
}
