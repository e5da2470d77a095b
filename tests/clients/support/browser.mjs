// SPDX-License-Identifier: MIT
// Opens a page in headless Chromium over a server on the loopback interface; nothing else is asked for anything.
//
//     const { result, faults, requested } = await look({ page, roots, modules, query, init, picture, mirrors, script });
//
// page: an HTML file. The server maps /page/ to its folder, /support/ to this one, /modules/ to `modules`, and what `roots`
// adds ({ '/tiles/': folder }). The page sets window.result and then window.finished = true; `init` is there before as
// window.question. `faults` lists what was not found, scripts that failed, and result.failures; `requested`, the names
// served. `picture` keeps a screenshot. `mirrors` ({ 'https://host/path/': folder }) stands in for addresses that a page
// names; `script` is JavaScript that runs in the page before its own.
import fs from 'fs';
import http from 'http';
import path from 'path';
import { createRequire } from 'module';
import { fileURLToPath } from 'url';

const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.json': 'application/json',
                '.css': 'text/css', '.wasm': 'application/wasm', '.glb': 'model/gltf-binary',
                '.terrain': 'application/vnd.quantized-mesh' };

async function serve(roots, requested, missing) {
  const server = http.createServer((request, response) => {
    const name = decodeURIComponent(new URL(request.url, 'http://host').pathname);
    const root = Object.keys(roots).sort((a, b) => b.length - a.length).find((prefix) => name.startsWith(prefix));
    fs.readFile(root ? path.join(roots[root], name.slice(root.length)) : '', (error, data) => {
      if (error) {
        if (name !== '/favicon.ico') missing.push(name);
        response.writeHead(404);
        return response.end();
      }
      requested.push(name);
      const headers = { 'Content-Type': types[path.extname(name)] || 'application/octet-stream' };
      if (name.endsWith('.terrain')) headers['Content-Encoding'] = 'gzip';
      response.writeHead(200, headers);
      response.end(data);
    });
  });
  await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
  return server;
}

export async function look({ page: file, roots, modules, query = '', init = null, picture = null, mirrors = {}, script = '' }) {
  const { chromium } = createRequire(path.resolve(modules, 'here.js'))('playwright-core');
  const all = { '/page/': path.dirname(path.resolve(file)), '/support/': path.dirname(fileURLToPath(import.meta.url)),
                '/modules/': path.resolve(modules) };
  for (const [prefix, folder] of Object.entries(roots)) all[prefix] = path.resolve(folder);
  const requested = [], missing = [], said = [];
  const server = await serve(all, requested, missing);
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM || '/usr/bin/chromium', headless: true,
    args: ['--no-sandbox', '--disable-dev-shm-usage', '--use-angle=gl-egl', '--ignore-gpu-blocklist'] });
  let result = null;
  try {
    const page = await browser.newPage({ viewport: { width: 400, height: 300 } });
    page.on('pageerror', (error) => said.push(error.message));
    await page.route((url) => url.hostname !== '127.0.0.1' && url.protocol.startsWith('http'), (route) => {
      missing.push(route.request().url());
      route.abort();
    });
    for (const [address, folder] of Object.entries(mirrors)) {
      await page.route((url) => url.href.startsWith(address), (route) => {
        const name = new URL(route.request().url().slice(address.length), 'http://host/').pathname.slice(1);
        requested.push(address + name);
        return route.fulfill({ path: path.join(path.resolve(folder), name), headers: { 'Access-Control-Allow-Origin': '*' } });
      });
    }
    if (script) await page.addInitScript(script);
    await page.addInitScript((question) => { window.question = question; }, init);
    await page.goto(`http://127.0.0.1:${server.address().port}/page/${path.basename(file)}${query}`);
    await page.waitForFunction('window.finished === true', null, { timeout: 200000 });
    result = await page.evaluate('window.result');
    if (picture) await page.screenshot({ path: picture });
  } catch (error) {
    said.push(error.message.split('\n')[0]);
  }
  await browser.close();
  server.close();
  const faults = [...missing.map((name) => `not found: ${name}`), ...said, ...(result ? result.failures : [])];
  return { result, faults, requested };
}
