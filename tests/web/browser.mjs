/* The npm package in a real Chromium: node browser.mjs APP ASSET PICTURES [NAME]
 *   APP       the project of app/, built, with the package among its modules
 *   ASSET     a `.gtx` with LOD meshes       PICTURES  a folder for what was drawn
 *   NAME      only the checks whose names hold it
 * Each check of checks.js is a line "ok NAME" or "not ok NAME: why"; the exit status counts. */
import {mkdir, writeFile} from 'node:fs/promises';
import {basename, dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {open} from './serve.mjs';

const [, , app, asset, pictures, only = ''] = process.argv;
const modules = join(app, 'node_modules'), here = dirname(fileURLToPath(import.meta.url));
const {page, address, close} = await open(modules, {
  modules, tests: here, app: join(app, 'dist'), asset: dirname(asset),
  samples: join(here, '../../samples/web')});
let failed = 0, workers = 0, refused = 0; /* by WebGL */
page.on('workercreated', () => ++workers);
try {
  await mkdir(pictures, {recursive: true});
  page.on('console', (message) => {
    console.log('# ' + message.text());
    refused += /GL_INVALID|INVALID_OPERATION/.test(message.text()) ? 1 : 0;
  });
  await page.goto(`${address}/tests/checks.html?asset=/asset/${basename(asset)}`);
  const names = await page.waitForFunction('window.checks && Object.keys(checks)',
                                           {timeout: 60000}).then((h) => h.jsonValue());
  const tell = (name, fault) => {
    console.log(fault ? `not ok ${name}: ${fault}` : `ok ${name}`);
    failed += fault ? 1 : 0;
  };
  for (const name of names.filter((n) => n.includes(only))) {
    const {fault, picture} = await page.evaluate((n) => run(n), name);
    tell(name, fault);
    if (picture)
      await writeFile(join(pictures, name + '.png'), Buffer.from(picture.split(',')[1], 'base64'));
  }
  workers = 0;
  await page.goto(`${address}/app/index.html?asset=/asset/${basename(asset)}`);
  await page.waitForFunction('document.title !== "loading"', {timeout: 60000});
  const title = await page.title();
  tell('a_bundler_takes_the_package', title === 'drawn' && workers ? '' : `${title}, ${workers} workers`);
  await page.goto(`${address}/samples/viewer.html?asset=/asset/${basename(asset)}`);
  await page.waitForFunction('document.title === "shown"', {timeout: 60000})
      .then(() => new Promise((seen) => setTimeout(seen, 1000)))
      .then(() => page.screenshot({path: join(pictures, 'viewer.png')}))
      .then(() => tell('the_viewer_shows_it', ''), (fault) => tell('the_viewer_shows_it', fault));
  const museum = async () => {
    await page.goto(`${address}/samples/museum.html?asset=/asset/${basename(asset)},/asset/small.gtx`);
    await page.waitForFunction('document.title === "shown"', {timeout: 60000});
    const shot = (name) => page.screenshot({path: join(pictures, name + '.png')});
    await new Promise((seen) => setTimeout(seen, 1000));
    const {width, height} = page.viewport();
    await shot('museum');
    await page.mouse.move(width * 0.48, height * 0.42);
    await page.mouse.down();
    await page.mouse.move(width * 0.54, height * 0.44, {steps: 2});
    await page.mouse.up();
    await page.waitForFunction('document.title === "painted"', {timeout: 60000});
    await new Promise((seen) => setTimeout(seen, 1000));
    await shot('museum_painted');
  };
  await museum().then(() => tell('the_museum_is_painted', ''),
                      (fault) => tell('the_museum_is_painted', fault));
  tell('webgl_takes_all_that_is_asked', refused ? `${refused} calls are refused` : '');
} finally {
  await close();
}
process.exit(failed ? 1 : 0);
