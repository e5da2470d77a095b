// SPDX-License-Identifier: MIT
// A pyramid as 3D Tiles in CesiumJS, in headless Chromium: it fills the picture, its finest tiles are shown from near,
// and heights sampled from what is drawn are those of the formula at the posts.
//
//     node tiles3d.mjs TILESET NODE_MODULES [PICTURE.png]
import path from 'path';
import { fileURLToPath } from 'url';
import { look } from '../support/browser.mjs';
import { grid, height, latitude, longitude, step } from './heights.mjs';

const [tiles, modules, picture] = process.argv.slice(2);
// Some posts of the finest zoom there is, 4: every second of the raster's, counted from 180 degrees west.
const even = (degrees) => Math.round(degrees / step) % 2 === 0;
const posts = [];
for (let i = 20; i < grid.columns - 20; ++i) {
  for (let j = 20; j < grid.rows - 20; ++j) {
    if (i % 64 < 2 && j % 64 < 2 && even(longitude(i) + 180) && even(latitude(j) + 90)) posts.push([i, j]);
  }
}
const { result, faults } = await look({
  page: path.join(path.dirname(fileURLToPath(import.meta.url)), 'tiles3d.html'), modules, picture,
  init: { places: posts.map(([i, j]) => [longitude(i), latitude(j)]), eye: [9.2, 46, 250000] }, roots: { '/tiles/': tiles } });
let most = 0;
if (result && result.failures.length === 0) {
  posts.forEach(([i, j], k) => { most = Math.max(most, Math.abs((result.heights[k] ?? NaN) - height(i, j)) || 0); });
  const sampled = result.heights.filter(Number.isFinite).length;
  if (posts.length < 20 || sampled !== posts.length) faults.push(`only ${sampled} of ${posts.length} places have a height`);
  if (!(most <= 45)) faults.push(`a sample is off by ${most} m, asked were 40 m`);
  if (!(result.seen.covered > 0.99)) faults.push(`the terrain covers ${result.seen.covered} of the picture`);
  if (!(Math.min(...result.seen.color) > 25 && Math.max(...result.seen.color) < 240)) faults.push(`it is drawn in ${result.seen.color}`);
  if (!result.files['4']) faults.push(`the finest tiles are not shown: ${JSON.stringify(result.files)}`);
}
console.log(JSON.stringify({ samples: posts.length, most_m: most, seen: result?.seen, tiles: result?.files, faults }));
process.exit(faults.length > 0 ? 1 : 0);
