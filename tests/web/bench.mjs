/* node bench.mjs APP FOLDER NAME...: of each NAME.drc, .gtx and, where they are there, .glb and .nxz in
 * FOLDER, one line and a page of its own in one Chromium: bytes, seconds to the first and to the last
 * picture at 10 Mbit/s, a frame, memory, and how near pictures are to Draco's; then a frame of what has
 * next to no triangles. */
import {existsSync} from 'node:fs';
import {stat} from 'node:fs/promises';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {writeFile} from 'node:fs/promises';
import {open} from './serve.mjs';

const [, , app, folder, ...names] = process.argv;
const KINDS = {'Draco': ['draco', 'drc'], 'meshopt': ['meshopt', 'glb'],
               'Nexus, 1 px': ['nexus', 'nxz', 1], 'Nexus, 2 px': ['nexus', 'nxz', 2],
               '.gtx, 1 px': ['gtx', 'gtx', 1], '.gtx, 2 px': ['gtx', 'gtx', 2]};
const {page, address, close} = await open(join(app, 'node_modules'), {
  modules: join(app, 'node_modules'), tests: dirname(fileURLToPath(import.meta.url)), folder});
await page.setCacheEnabled(false);
page.on('console', (m) => console.error(m.text()));
try {
  console.log('| model | file | KB | read, KB | first picture, s | full, s | longest task, ms | frame, ms: full | all bytes |' +
              ' memory, MB | IoU | PSNR, dB: full | all bytes |');
  console.log('|---|---|---|---|---|---|---|---|---|---|---|---|---|');
  for (const name of names) {
    let least = Infinity;
    for (const [title, [kind, end, error]] of Object.entries(KINDS)) {
      if (!existsSync(join(folder, `${name}.${end}`)))
        continue;
      await page.goto(`${address}/tests/bench.html`);
      await page.waitForFunction('window.measure', {timeout: 60000});
      const {size} = await stat(join(folder, `${name}.${end}`));
      const m = await page.evaluate((...a) => measure(...a), kind, `/folder/${name}.${end}`, 10e6, error,
                                    `/folder/${name}.drc`);
      least = Math.min(least, m.least);
      const seconds = (ms) => (ms / 1000).toFixed(3);
      console.log(`| ${name} | ${title} | ${Math.round(size / 1000)} |` +
                  ` ${Math.round((m.bytes ?? size) / 1000)} | ${seconds(m.first)} | ${seconds(m.full)} |` +
                  ` ${m.task.toFixed(0)} | ${m.frame.toFixed(1)} | ${m.wholeFrame?.toFixed(1) ?? ''} |` +
                  ` ${(m.memory / 1e6).toFixed(1)} |` +
                  ` ${m.iou.toFixed(4)} | ${m.psnr?.toFixed(1) ?? ''} | ${m.wholePsnr?.toFixed(1) ?? ''} |`);
      const picture = await page.evaluate(() => shot());
      await writeFile(join(folder, `${name}-${kind}-${error ?? 0}.png`),
                      Buffer.from(picture.slice(picture.indexOf(',') + 1), 'base64'));
    }
    console.log(`| ${name} | a ball of as many pixels | | | | | | ${least.toFixed(1)} | | | | | |`);
  }
} finally {
  await close();
}
