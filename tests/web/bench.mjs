/* node bench.mjs APP FOLDER NAME...: of each NAME.gtx and NAME.drc in FOLDER, one line in one
 * Chromium: bytes, seconds to the first and to the last picture at 10 Mbit/s, a frame, memory. */
import {stat} from 'node:fs/promises';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {open} from './serve.mjs';

const [, , app, folder, ...names] = process.argv;
const {page, address, close} = await open(join(app, 'node_modules'), {
  modules: join(app, 'node_modules'), tests: dirname(fileURLToPath(import.meta.url)), folder});
page.on('console', (m) => m.text().includes('heap') && console.error(m.text()));
try {
  await page.goto(`${address}/tests/bench.html`);
  await page.waitForFunction('window.measure', {timeout: 60000});
  console.log('| model | file | KB | first picture, s | full, s | longest task, ms | frame, ms | memory, MB |');
  console.log('|---|---|---|---|---|---|---|---|');
  for (const name of names)
    for (const kind of ['gtx', 'draco']) {
      const file = `${name}.${kind === 'gtx' ? 'gtx' : 'drc'}`;
      const {size} = await stat(join(folder, file));
      const m = await page.evaluate((k, u) => measure(k, u, 10e6), kind, `/folder/${file}`);
      console.log(`| ${name} | ${kind} | ${Math.round(size / 1000)} | ${(m.first / 1000).toFixed(2)} |` +
                  ` ${(m.full / 1000).toFixed(2)} | ${m.task.toFixed(0)} | ${m.frame.toFixed(0)} |` +
                  ` ${(m.memory / 1e6).toFixed(0)} |`);
    }
} finally {
  await close();
}
