/* The cooker in a real Chromium: node cook.mjs APP FOLDER PICTURES NAME...
 *   APP       the project of app/, built, with the package and its cooker among its modules
 *   FOLDER    models by these names, each beside NAME.gtx, what `gtx cook` made of it
 * A line "ok NAME" or "not ok NAME: why" for each check; the exit status counts. */
import {createHash} from 'node:crypto';
import {readFile} from 'node:fs/promises';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {open} from './serve.mjs';

const [, , app, folder, pictures, ...names] = process.argv;
const modules = join(app, 'node_modules'), here = dirname(fileURLToPath(import.meta.url));
const {page, address, close} = await open(modules, {
  modules, tests: here, folder, samples: join(here, '../../samples/web')});
let failed = 0;
const tell = (name, fault) => {
  console.log(fault ? `not ok ${name}: ${fault}` : `ok ${name}`);
  failed += fault ? 1 : 0;
};
const cooked = (name, options) =>
  page.evaluate((...a) => cooked(...a), `/folder/${name}`, options);

async function same(name, options, file) {
  const wanted = createHash('sha256').update(await readFile(join(folder, file))).digest('hex');
  const {hash, message, progress, seconds} = await cooked(name, options);
  if (hash !== wanted)
    return message ?? 'other bytes than gtx cook makes';
  console.log(`# ${name}: ${seconds.toFixed(1)} s`);
  const falls = progress.some(({fraction}, i) => i && fraction < progress[i - 1].fraction);
  return falls || progress.length < 10 || progress[progress.length - 1].fraction !== 1
      ? 'progress is not told from 0 to 1' : '';
}

/* An error of this kind, with a sentence that says what. */
async function refused(name, options, kind, sentence) {
  const told = await cooked(name, options);
  return !told.hash && told.kind === kind && sentence.test(told.message) ? ''
      : `${told.kind}: ${told.message ?? 'cooked'}`;
}

try {
  await page.goto(`${address}/tests/cook.html`);
  await page.waitForFunction('window.ready', {timeout: 60000});
  for (const name of names)
    tell(`${name}_has_the_bytes_of_the_command`, await same(name, {}, `${name}.gtx`));
  const [name] = names;
  tell('options_are_the_commands', await same(name, {
    partition: 'layers', resolution: 96, lodLevels: 2, heightBits: 16}, `${name}.options.gtx`));
  tell('a_text_is_no_model', await refused('notes.txt', {}, 'unsupported', /none of OBJ, PLY/));
  tell('a_model_that_ends_early', await refused('short.ply', {}, 'input', /ends in vertex/));
  tell('memory_has_a_limit', await refused(name, {memory: 5e6}, 'limit', /memory/));
  tell('work_has_a_limit', await refused(name, {work: 5000}, 'limit', /work|steps/));
  tell('an_option_that_is_none', await refused(name, {resolutoin: 1}, 'argument', /resolutoin/));
  tell('a_partition_that_is_none', await refused(name, {partition: 'x'}, 'argument', /relief/));
  tell('a_signal_stops_it', await refused(name, {stopAt: 0.1}, undefined, /^stopped$/));
  tell('no_cooker_is_an_error', await refused(name, {wasm: '/nowhere.wasm'}, 'unsupported', /cooker/));
  await page.goto(`${address}/samples/viewer.html`);
  const input = await page.waitForSelector('#file');
  await input.uploadFile(resolve(folder, name));
  await page.waitForFunction('document.title === "shown"', {timeout: 60000})
      .then(() => new Promise((seen) => setTimeout(seen, 1000)))
      .then(() => page.screenshot({path: join(pictures, 'cooked.png')}))
      .then(() => tell('the_viewer_cooks_a_model', ''), (fault) => tell('the_viewer_cooks_a_model', fault));
} finally {
  await close();
}
process.exit(failed ? 1 : 0);
