// SPDX-License-Identifier: MIT
// CesiumJS in headless Chromium: sampleTerrain at 1,000 random posts against the heights the pyramid was made from, and
// one picture with terrain in view.
//
//     node look.mjs TILES NODE_MODULES [PICTURE.png]
import fs from 'fs';
import http from 'http';
import path from 'path';
import { createRequire } from 'module';
import { fileURLToPath } from 'url';
import { grid, height, latitude, longitude } from './heights.mjs';

const [tiles, modules, picture] = process.argv.slice(2);
const { chromium } = createRequire(path.join(modules, 'here.js'))('playwright-core');
const roots = { '/page/': path.dirname(fileURLToPath(import.meta.url)), '/tiles/': path.resolve(tiles, 'mesh'), '/modules/': path.resolve(modules) };
const types = { '.html': 'text/html', '.js': 'text/javascript', '.json': 'application/json', '.css': 'text/css',
                '.wasm': 'application/wasm', '.terrain': 'application/vnd.quantized-mesh' };
const missing = [];
const server = http.createServer((request, response) => {
  const name = decodeURIComponent(new URL(request.url, 'http://host').pathname);
  const root = Object.keys(roots).find((prefix) => name.startsWith(prefix));
  fs.readFile(root ? path.join(roots[root], name.slice(root.length)) : '', (error, data) => {
    if (error) {
      if (name !== '/favicon.ico') missing.push(name);
      response.writeHead(404);
      return response.end();
    }
    const headers = { 'Content-Type': types[path.extname(name)] || 'application/octet-stream' };
    if (name.endsWith('.terrain')) headers['Content-Encoding'] = 'gzip';
    response.writeHead(200, headers);
    response.end(data);
  });
});
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));

let seed = 12345;
const random = (count) => { seed = (seed * 1103515245 + 12345) % 2147483648; return Math.floor(seed / 2147483648 * count); };
// Not within a sample of the raster's rim, where tiles may have a ragged border.
const posts = Array.from({ length: 1000 }, () => [2 + random(grid.columns - 4), 2 + random(grid.rows - 4)]);
const question = { level: 5, places: posts.map(([i, j]) => [longitude(i), latitude(j)]), view: [9.2, 43.6, 90000] };

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM || '/usr/bin/chromium', headless: true,
  args: ['--no-sandbox', '--disable-dev-shm-usage', '--use-angle=gl-egl', '--ignore-gpu-blocklist'] });
const page = await browser.newPage({ viewport: { width: 400, height: 300 } });
const faults = [];
page.on('pageerror', (error) => faults.push(error.message));
await page.route((url) => url.hostname !== '127.0.0.1' && url.protocol.startsWith('http'), (route) => {
  missing.push(route.request().url());
  route.abort();
});
await page.addInitScript((asked) => { window.question = asked; }, question);
let result = null;
try {
  await page.goto(`http://127.0.0.1:${server.address().port}/page/cesium.html`);
  await page.waitForFunction('window.finished === true', null, { timeout: 200000 });
  result = await page.evaluate('window.result');
  if (picture) await page.screenshot({ path: picture });
} catch (error) {
  faults.push(error.message.split('\n')[0]);
}
await browser.close();
server.close();

let most = 0;
if (result) {
  faults.push(...result.failures);
  posts.forEach(([i, j], k) => { most = Math.max(most, Math.abs((result.heights[k] ?? NaN) - height(i, j)) || 0); });
  const sampled = result.heights.filter(Number.isFinite).length;
  if (sampled !== posts.length) faults.push(`only ${sampled} of ${posts.length} places have a height`);
  if (!(most <= 20.5)) faults.push(`a sample is off by ${most} m, asked were 20 m`);
  if (!result.normals) faults.push('the provider sees no normals');
  if (!(result.covered > 0.4)) faults.push(`terrain covers ${result.covered} of the picture`);
  if (!(result.shades > 8)) faults.push(`the picture has ${result.shades} shades: no relief`);
}
faults.push(...missing.map((name) => `not found: ${name}`));
console.log(JSON.stringify({ samples: posts.length, most_m: most, ...result, heights: undefined, faults }));
process.exit(faults.length > 0 ? 1 : 0);
