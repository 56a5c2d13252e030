/* What must hold of a page's own shadings, whose programs are compiled at once or when they draw. */
import {Geotex, GeotexError, Method} from 'geotex';

const TEXT = `
uniform vec3 page_color;
layout(location = 0) out vec4 page_out;
void main()
{
    gtx_surface s;
    if (!gtx_find(s))
        discard;
    page_out = vec4(page_color * (0.5 + 0.5 * gtx_world_normal(s)), 1.0);
    gtx_write_depth(s);
}
`;

export const shadings = ({expect, address, context, clear, viewOf, read, covered, apart}) => ({
  async programs_are_compiled_once_they_draw() {
    const gl = context(), geotex = await Geotex.create(gl);
    const asset = geotex.open(await (await fetch(address)).arrayBuffer()), model = geotex.model(asset);
    const now = geotex.shading(TEXT), later = geotex.shading(TEXT, true);
    expect(now.programs.length > 3 && !later.programs.length, `${later.programs.length} from the start`);
    for (const shading of [now, later])
      shading.set({page_color: [1, 0.8, 0.6]});
    [Method.LOD, Method.CAST, Method.LOD].forEach((method, i) => {
      const [a, b] = [now, later].map((shading) => {
        clear(gl);
        geotex.draw(viewOf(asset, {method, shading}), [{model}]);
        expect(gl.getError() === 0, 'WebGL reports an error');
        return read(gl);
      });
      expect(covered(a) > 1000 && apart(a, b, 0) === 0, `picture ${i} is not the same`);
      expect(later.programs.length === Math.min(i + 1, 2), `${later.programs.length} programs`);
    });
    const wrong = geotex.shading('no main', true);
    let why = null;
    try {
      geotex.draw(viewOf(asset, {method: Method.LOD, shading: wrong}), [{model}]);
    } catch (error) {
      why = error;
    }
    expect(why instanceof GeotexError && why.kind === 'shader', `${why?.kind}: ${why?.message}`);
    geotex.dispose();
    return gl.canvas;
  },
});
