// SPDX-License-Identifier: MIT
// CesiumJS in headless Chromium: sampleTerrain at 1,000 random posts against the heights the pyramid was made from; and
// pictures from above, in which every pixel must be as light as the slope there by the formula of the heights makes it.
//
//     node look.mjs TILES NODE_MODULES [PICTURE.png]
import path from 'path';
import { fileURLToPath } from 'url';
import { look } from '../support/browser.mjs';
import { grid, height, latitude, longitude, post } from './heights.mjs';

const [tiles, modules, picture] = process.argv.slice(2);
let seed = 12345;
const random = (count) => { seed = (seed * 1103515245 + 12345) % 2147483648; return Math.floor(seed / 2147483648 * count); };
// Not within a sample of the raster's rim, where tiles may have a ragged border.
const posts = Array.from({ length: 1000 }, () => [2 + random(grid.columns - 4), 2 + random(grid.rows - 4)]);
const question = { level: 5, places: posts.map(([i, j]) => [longitude(i), latitude(j)]), eye: [9.2, 46, 350000],
                   azimuths: [-0.8, 0.8, 2.4], elevation: 0.5, exaggeration: 10, step: 8 };
const { result, faults } = await look({
  page: path.join(path.dirname(fileURLToPath(import.meta.url)), 'cesium.html'), modules, init: question, picture,
  roots: { '/tiles/': path.join(tiles, 'mesh') } });

// Lightness of the ground by the formula: the cosine between the light and the slope, stretched upwards as the scene is.
function lightness([east, north], azimuth) {
  const [i, j] = post(east, north);
  const meters = 6371000 * Math.PI / 180;
  const rise = (a, b) => height(i + a, j + b) * question.exaggeration;
  const run = (longitude(1) - longitude(0)) * meters;
  const dx = (rise(0.5, 0) - rise(-0.5, 0)) / (run * Math.cos(north * Math.PI / 180)), dy = (rise(0, 0.5) - rise(0, -0.5)) / run;
  const light = [Math.sin(azimuth) * Math.cos(question.elevation), Math.cos(azimuth) * Math.cos(question.elevation), Math.sin(question.elevation)];
  return Math.max(0, (light[2] - dx * light[0] - dy * light[1]) / Math.hypot(dx, dy, 1));
}
function correlation(a, b) {
  const mean = (list) => list.reduce((sum, one) => sum + one, 0) / list.length;
  const [ma, mb] = [mean(a), mean(b)];
  const dot = (f, g) => a.reduce((sum, _, k) => sum + f(k) * g(k), 0);
  const [da, db] = [(k) => a[k] - ma, (k) => b[k] - mb];
  return dot(da, db) / Math.sqrt(dot(da, da) * dot(db, db));
}

const seen = {};
if (result && result.failures.length === 0) {
  let most = 0;
  posts.forEach(([i, j], k) => { most = Math.max(most, Math.abs((result.heights[k] ?? NaN) - height(i, j)) || 0); });
  const sampled = result.heights.filter(Number.isFinite).length;
  if (sampled !== posts.length) faults.push(`only ${sampled} of ${posts.length} places have a height`);
  if (!(most <= 20.5)) faults.push(`a sample is off by ${most} m, asked were 20 m`);
  if (!result.normals) faults.push('the provider sees no normals');
  const hits = result.ground.map((at, k) => [at, k]).filter(([at]) => at !== null);
  seen.covered = hits.length / result.ground.length;
  if (!(seen.covered > 0.99)) faults.push(`the terrain covers ${seen.covered} of the picture`);
  seen.off_m = hits.reduce((sum, [at]) => sum + Math.abs(at[2] - height(...post(at[0], at[1]))), 0) / hits.length;
  if (!(seen.off_m < 40)) faults.push(`what is drawn lies ${seen.off_m} m off on average`);
  // Each picture against the light it was taken in, and against the light of the next.
  seen.own = [], seen.other = [];
  question.azimuths.forEach((azimuth, n) => {
    const grey = hits.map(([, k]) => result.pictures[n][k]);
    const by = (one) => correlation(grey, hits.map(([at]) => lightness(at, one)));
    seen.own.push(by(azimuth));
    seen.other.push(by(question.azimuths[(n + 1) % question.azimuths.length]));
  });
  if (!(Math.min(...seen.own) > 0.7)) faults.push(`the pictures do not show this relief: correlations ${seen.own}`);
  if (!(Math.max(...seen.other) < 0.5)) faults.push(`the pictures do not depend on the light: correlations ${seen.other}`);
  seen.most_m = most;
}
console.log(JSON.stringify({ samples: posts.length, levels: result?.levels, ...seen, faults }));
process.exit(faults.length > 0 ? 1 : 0);
