/* The state of WebGL 2 that geotex touches. Kept here and not in the core, which knows of objects
 * only by the numbers that its glue gave them. A browser asks the GPU's process for some of it, and
 * waits: `known` is what a page knows of it where something is drawn, and all else only unpacks. */
const TEXTURE_UNITS = 8;

export class State {
  constructor(gl, known) {
    const get = (name) => gl.getParameter(name);
    this.program = get(gl.CURRENT_PROGRAM);
    this.array = get(gl.VERTEX_ARRAY_BINDING);
    this.buffer = get(gl.ARRAY_BUFFER_BINDING);
    this.pixels = get(gl.PIXEL_UNPACK_BUFFER_BINDING);
    this.unit = get(gl.ACTIVE_TEXTURE);
    this.units = [];
    for (let i = 0; i < TEXTURE_UNITS; ++i) {
      gl.activeTexture(gl.TEXTURE0 + i);
      this.units.push([get(gl.TEXTURE_BINDING_2D), get(gl.TEXTURE_BINDING_2D_ARRAY),
                       get(gl.SAMPLER_BINDING)]);
    }
    if (known) {
      this.enabled = [gl.DEPTH_TEST, gl.CULL_FACE, gl.BLEND].map((name) => [name, gl.isEnabled(name)]);
      this.depthFunc = known.depthFunc ?? get(gl.DEPTH_FUNC);
      this.depthMask = known.depthMask ?? get(gl.DEPTH_WRITEMASK);
      this.cullFace = known.cullFace ?? get(gl.CULL_FACE_MODE);
      this.frontFace = known.frontFace ?? get(gl.FRONT_FACE);
      this.colorMask = known.colorMask ?? get(gl.COLOR_WRITEMASK);
      return;
    }
    this.unpack = ['ALIGNMENT', 'ROW_LENGTH', 'SKIP_ROWS', 'SKIP_PIXELS', 'SKIP_IMAGES',
                   'IMAGE_HEIGHT', 'FLIP_Y_WEBGL', 'PREMULTIPLY_ALPHA_WEBGL']
        .map((name) => gl['UNPACK_' + name]).map((name) => [name, get(name)]);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
  }

  restore(gl) {
    gl.useProgram(this.program);
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bindBuffer(gl.PIXEL_UNPACK_BUFFER, this.pixels);
    this.units.forEach(([plain, array, sampler], i) => {
      gl.activeTexture(gl.TEXTURE0 + i);
      gl.bindTexture(gl.TEXTURE_2D, plain);
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, array);
      gl.bindSampler(i, sampler);
    });
    gl.activeTexture(this.unit);
    for (const [name, value] of this.unpack ?? [])
      gl.pixelStorei(name, value);
    if (!this.enabled)
      return;
    for (const [name, on] of this.enabled)
      on ? gl.enable(name) : gl.disable(name);
    gl.depthFunc(this.depthFunc);
    gl.depthMask(this.depthMask);
    gl.cullFace(this.cullFace);
    gl.frontFace(this.frontFace);
    gl.colorMask(...this.colorMask);
  }
}
