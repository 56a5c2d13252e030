import type {Color, Loader, LoadingManager, Mesh, Vector3, WebGLRenderer} from 'three';
import type {Asset, Model} from './geotex.js';

export {Method} from './geotex.js';

/** Drawn in three's order by its cameras; lit by its directional lights (the first four) and their
 * shadows (PCFShadowMap), ambient and hemisphere lights, with its fog and tone mapping. */
export class GeotexModel extends Mesh {
  readonly asset: Asset;
  readonly model: Model;
  /** Of a streamed model: asks for the rest, whether or not frames need it, and tells once all is
   * there; rejects where it does not come. */
  readonly complete: Promise<GeotexModel>;
  /** One of Method. */
  method: number;
  /** Pixels that what is drawn may be off, anywhere: 1. */
  maxError: number;
  /** Blends `color` into those around a point of the world, less towards `radius`, by `strength` (1).
   * Clones show it, too. False where it meets nothing, or the asset has no colours. The first call
   * opens the asset here. */
  paint(point: Vector3, radius: number, color: Color, strength?: number): boolean;
  /** Frees the model and its asset, which clones share. */
  dispose(): void;
}

export class GeotexLoader extends Loader<GeotexModel> {
  constructor(renderer: WebGLRenderer, options?: {wasm?: string, log?: (line: string) => void},
              manager?: LoadingManager);
  parseAsync(bytes: ArrayBuffer): Promise<GeotexModel>;
  /** The model as soon as the file's first bytes show something. More of them make it finer, and its
   * `asset` and `model` others, until it is `complete`: rays meet it from then on. Where the server
   * grants ranges, no more is read than what makes the last frame, if that showed it, the picture of
   * the whole file. */
  stream(url: string, onProgress?: (bytes: number, of: number) => void, signal?: AbortSignal):
      Promise<GeotexModel>;
}
