/* The npm package in a real Chromium: node browser.mjs APP ASSET PICTURES [NAME]
 *   APP       the project of app/, built, with the package among its modules
 *   ASSET     a `.gtx` with LOD meshes       PICTURES  a folder for what was drawn
 *   NAME      only the checks whose names hold it
 * Each check of checks.js is a line "ok NAME" or "not ok NAME: why"; the exit status counts. */
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {mkdir, readFile, writeFile} from 'node:fs/promises';
import {basename, dirname, extname, join, normalize, resolve} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';

const [, , app, asset, pictures, only = ''] = process.argv;
const modules = join(app, 'node_modules');
const here = dirname(fileURLToPath(import.meta.url));
const {default: puppeteer} = await import(pathToFileURL(
  createRequire(resolve(modules, 'none.js')).resolve('puppeteer-core')).href);

const roots = {modules, tests: here, app: join(app, 'dist'), asset: dirname(asset),
               samples: join(here, '../../samples/web')};
const types = {'.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm'};
const server = createServer(async (request, response) => {
  const [, root, ...rest] = decodeURIComponent(request.url.split('?')[0]).split('/');
  try {
    const inside = rest[0] === 'node_modules' ? [modules, ...rest.slice(1)] : [roots[root], ...rest];
    const path = normalize(join(...inside));
    const content = await readFile(path);
    response.writeHead(200, {'content-type': types[extname(path)] ?? 'application/octet-stream'});
    /* "?first=1000" is a server that gives up. */
    response.end(content.subarray(0, request.url.match(/[?]first=(\d+)$/)?.[1] ?? content.length));
  } catch {
    response.writeHead(root === 'favicon.ico' ? 204 : 404).end();
  }
});
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', headless: true,
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
         '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist']});
let failed = 0;
try {
  await mkdir(pictures, {recursive: true});
  const page = await browser.newPage();
  const address = `http://127.0.0.1:${server.address().port}`;
  page.on('console', (message) => console.log('# ' + message.text()));
  page.on('response', (r) => r.status() < 400 || console.log(`# ${r.status()} ${r.url()}`));
  page.on('pageerror', (error) => console.log('# ' + error.message));
  const network = await page.createCDPSession();
  await network.send('Network.enable');
  await page.exposeFunction('link', (bits) => network.send('Network.emulateNetworkConditions', {
    offline: false, latency: bits ? 20 : 0, uploadThroughput: -1,
    downloadThroughput: bits ? bits / 8 : -1}));
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
  await page.goto(`${address}/app/index.html?asset=/asset/${basename(asset)}`);
  await page.waitForFunction('document.title !== "loading"', {timeout: 60000});
  const title = await page.title();
  tell('a_bundler_takes_the_package', title === 'drawn' ? '' : title);
  await page.goto(`${address}/samples/viewer.html?asset=/asset/${basename(asset)}`);
  await page.waitForFunction('document.title === "shown"', {timeout: 60000})
      .then(() => new Promise((seen) => setTimeout(seen, 1000)))
      .then(() => page.screenshot({path: join(pictures, 'viewer.png')}))
      .then(() => tell('the_viewer_shows_it', ''), (fault) => tell('the_viewer_shows_it', fault));
} finally {
  await browser.close();
  server.close();
}
process.exit(failed ? 1 : 0);
