import type {Loader, LoadingManager, Mesh, WebGLRenderer} from 'three';
import type {Asset, Model} from './geotex.js';

export {Method} from './geotex.js';

/** Drawn in three's order by its cameras; lit by its directional lights (the first four) and their
 * shadows (PCFShadowMap), ambient and hemisphere lights, with its fog and tone mapping. */
export class GeotexModel extends Mesh {
  readonly asset: Asset;
  readonly model: Model;
  /** One of Method. */
  method: number;
  /** Pixels that what is drawn may be off. */
  maxError: number;
  /** Frees the model and its asset, which clones share. */
  dispose(): void;
}

export class GeotexLoader extends Loader<GeotexModel> {
  constructor(renderer: WebGLRenderer, options?: {wasm?: string, log?: (line: string) => void},
              manager?: LoadingManager);
  parseAsync(bytes: ArrayBuffer): Promise<GeotexModel>;
}
