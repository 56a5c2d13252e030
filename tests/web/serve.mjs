/* A server of folders and a Chromium, for the checks and the bench: give the roots by their names. */
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {readFile} from 'node:fs/promises';
import {extname, join, normalize, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const types = {'.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm'};

/* `modules`: the folder node_modules, which lies below every root too. */
export async function open(modules, roots) {
  const {default: puppeteer} = await import(pathToFileURL(
    createRequire(resolve(modules, 'none.js')).resolve('puppeteer-core')).href);
  const server = createServer(async (request, response) => {
    const [, root, ...rest] = decodeURIComponent(request.url.split('?')[0]).split('/');
    try {
      const inside = rest[0] === 'node_modules' ? [modules, ...rest.slice(1)]
          : [roots[root], ...rest];
      const path = normalize(join(...inside));
      const content = await readFile(path);
      const type = {'content-type': types[extname(path)] ?? 'application/octet-stream'};
      /* "?ranges" is a server that grants them; "?first=1000" one that gives up. */
      const [, from, to] = request.headers.range?.match(/^bytes=(\d+)-(\d*)$/) ?? [];
      const first = +from, last = Math.min(+to || Infinity, content.length - 1);
      if (/[?&]ranges$/.test(request.url) && first <= last) {
        response.writeHead(206, {...type, etag: `"${content.length}"`, 'content-range':
          `bytes ${first}-${last}/${content.length}`});
        response.end(content.subarray(first, last + 1));
        return;
      }
      response.writeHead(200, type);
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
  const page = await browser.newPage();
  page.on('pageerror', (error) => console.log('# ' + error.message));
  page.on('response', (r) => r.status() < 400 || console.log(`# ${r.status()} ${r.url()}`));
  const network = await page.createCDPSession();
  await network.send('Network.enable');
  /* A line of so many bits a second; 0: as fast as it goes. */
  await page.exposeFunction('link', (bits) => network.send('Network.emulateNetworkConditions', {
    offline: false, latency: bits ? 20 : 0, uploadThroughput: -1,
    downloadThroughput: bits ? bits / 8 : -1}));
  return {page, address: `http://127.0.0.1:${server.address().port}`,
          close: () => browser.close().then(() => server.close())};
}
