import type {WebGLRenderer} from 'three';

/** For 3d-tiles-renderer: `tiles.registerPlugin(new GeotexTilesPlugin(renderer))`. */
export class GeotexTilesPlugin {
  readonly name: string;
  constructor(renderer: WebGLRenderer, options?: {wasm?: string, log?: (line: string) => void});
}
