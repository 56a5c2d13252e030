/* node shaders.mjs FILE...: shader files as lib/frame/shaders.h has them, in C: without comments
 * and indentation, which are half of what a page would wait for. */
import {readFileSync} from 'node:fs';
import {basename} from 'node:path';

/* WebGL has no texture buffers, for which tiles wait, and the page no rays in shaders. */
const without = /^geotex_(tiles[.]|rays|lighting)/;
const bare = (text) => text.replace(/\/\*[^]*?\*\/|\/\/.*/g, '').split('\n')
    .map((line) => line.replace(/\s+/g, ' ').trim()).filter(Boolean).join('\n') + '\n';
/* Nor does it define these: what depends on them goes. */
const never = /^#ifdef (VULKAN|GTX_RHI|GTX_MULTIVIEW|GTX_GATHER|GTX_GATHER_CODES)$/;
function reachable(text) {
  const around = [], out = []; /* of each #if: 'drop', then 'keep' from #else on; '' where it stays */
  for (let line of text.split('\n')) {
    const top = around.length - 1;
    if (/^#if/.test(line)) {
      around.push(never.test(line) ? 'drop' : '');
    } else if (/^#elif/.test(line) && around[top] === 'drop') {
      around[top] = '';
      line = line.replace('#elif', '#if');
    } else if (/^#else/.test(line) && around[top]) {
      around[top] = 'keep';
      continue;
    } else if (/^#endif/.test(line) && around.pop()) {
      continue;
    }
    if (!around.includes('drop'))
      out.push(line);
  }
  return out.join('\n');
}
console.log('#include "frame/shaders.h"\nconst gtx_shader_file gtx_shader_files[] = {');
for (const file of process.argv.slice(2))
  console.log(`{"${basename(file)}", ` +
      `${JSON.stringify(without.test(basename(file)) ? '' : reachable(bare(readFileSync(file, 'utf8'))))}},`);
console.log('{0, 0}};');
