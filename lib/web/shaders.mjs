/* node shaders.mjs FILE...: shader files as lib/frame/shaders.h has them, in C: without comments
 * and indentation, which are half of what a page would wait for. */
import {readFileSync} from 'node:fs';
import {basename} from 'node:path';

/* WebGL has no texture buffers, for which tiles wait, and the page no rays in shaders. */
const without = /^geotex_(tiles[.]|rays|lighting)/;
const bare = (text) => text.replace(/\/\*[^]*?\*\/|\/\/.*/g, '').split('\n')
    .map((line) => line.replace(/\s+/g, ' ').trim()).filter(Boolean).join('\n') + '\n';
console.log('#include "frame/shaders.h"\nconst gtx_shader_file gtx_shader_files[] = {');
for (const file of process.argv.slice(2))
  console.log(`{"${basename(file)}", ` +
      `${JSON.stringify(without.test(basename(file)) ? '' : bare(readFileSync(file, 'utf8')))}},`);
console.log('{0, 0}};');
