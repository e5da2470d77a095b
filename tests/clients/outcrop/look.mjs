// SPDX-License-Identifier: MIT
// Opens a tileset in a real client in headless Chromium and checks what it shows.
//
//     node look.mjs three|cesium TILESET_FOLDER NODE_MODULES [PICTURE_PREFIX]
//
// Ends with 1 and says why if a request failed, if the client does not load finer tiles as it comes nearer, or if the
// pictures are not of rock. Nothing but the loopback interface is asked for anything.
import fs from 'fs';
import http from 'http';
import path from 'path';
import { createRequire } from 'module';
import { fileURLToPath } from 'url';

const [client, tileset, modules, pictures] = process.argv.slice(2);
const { chromium } = createRequire(path.join(modules, 'here.js'))('playwright-core');
const here = path.dirname(fileURLToPath(import.meta.url));
const roots = { '/page/': here, '/tiles/': path.resolve(tileset), '/modules/': path.resolve(modules) };
const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.json': 'application/json',
                '.glb': 'model/gltf-binary', '.wasm': 'application/wasm', '.css': 'text/css' };
const distances = [6, 2, 0.6];

const missing = [];
let asked = 0;
const server = http.createServer((request, response) => {
  const name = decodeURIComponent(new URL(request.url, 'http://host').pathname);
  const root = Object.keys(roots).find((prefix) => name.startsWith(prefix));
  fs.readFile(root ? path.join(roots[root], name.slice(root.length)) : '', (error, data) => {
    if (error) {
      if (name !== '/favicon.ico') missing.push(name);
      response.writeHead(404);
      return response.end();
    }
    if (name.startsWith('/tiles/tiles/')) ++asked;
    response.writeHead(200, { 'Content-Type': types[path.extname(name)] || 'application/octet-stream' });
    response.end(data);
  });
});
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM || '/usr/bin/chromium', headless: true,
  args: ['--no-sandbox', '--disable-dev-shm-usage', '--use-angle=gl-egl', '--ignore-gpu-blocklist'] });
const page = await browser.newPage({ viewport: { width: 400, height: 300 } });
const said = [];
page.on('pageerror', (error) => said.push(error.message));
await page.route((url) => url.hostname !== '127.0.0.1' && url.protocol.startsWith('http'), (route) => {
  missing.push(route.request().url());
  route.abort();
});
// How much of the picture is not background (magenta), and its mean colour.
await page.addInitScript(() => {
  window.summary = (data) => {
    let covered = 0;
    const sum = [0, 0, 0];
    for (let i = 0; i < data.length; i += 4) {
      if (data[i] > 200 && data[i + 1] < 60 && data[i + 2] > 200) continue;
      ++covered;
      for (let c = 0; c < 3; ++c) sum[c] += data[i + c];
    }
    return { covered: covered / (data.length / 4), color: sum.map((s) => Math.round(s / Math.max(1, covered))) };
  };
});
let result = null;
try {
  const port = server.address().port;
  await page.goto(`http://127.0.0.1:${port}/page/${client}.html?tileset=/tiles/tileset.json&distances=${distances.join(',')}`);
  await page.waitForFunction('window.finished === true', null, { timeout: 150000 });
  result = await page.evaluate('window.result');
  if (pictures) await page.screenshot({ path: `${pictures}_${client}.png` });
} catch (error) {
  said.push(error.message.split('\n')[0]);
}
await browser.close();
server.close();

const faults = [...missing.map((name) => `not found: ${name}`), ...said, ...(result ? result.failures : [])];
const views = result ? result.views : [];
if (views.length !== distances.length) faults.push('not every view came out');
for (const [i, view] of views.entries()) {
  console.log(JSON.stringify(view));
  if (view.tiles === 0 || view.triangles === 0) faults.push(`nothing is shown from ${view.distance} radii`);
  if (view.covered < [0.003, 0.03, 0.15][i]) faults.push(`the rock covers only ${view.covered} of the picture from ${view.distance} radii`);
  const [r, g, b] = view.color;
  if (Math.min(r, g, b) < 30 || Math.max(r, g, b) > 225 || r < b) faults.push(`the colour from ${view.distance} radii is not that of rock: ${view.color}`);
  const finest = (one) => Math.min(...Object.keys(one.levels).map(Number));
  if (i > 0 && finest(view) > finest(views[i - 1])) faults.push('coarser tiles are shown nearer by');
}
const levels = new Set(views.flatMap((view) => Object.keys(view.levels)));
if (views.length > 0 && levels.size < 2) faults.push('only one level was ever shown');
const total = JSON.parse(fs.readFileSync(path.join(tileset, 'build.json'))).format;
if (total !== 'lodestone outcrop') faults.push('the folder is not one of ours');
console.log(JSON.stringify({ client, requested: asked, faults }));
process.exit(faults.length > 0 ? 1 : 0);
