// SPDX-License-Identifier: MIT
// The page examples/terrain_viewer as it is, in headless Chromium, with CesiumJS from npm in place of its address: what
// it draws is terrain, at the heights of the formula.
//
//     node viewer.mjs PAGE TILES NODE_MODULES [PICTURE.png]
import path from 'path';
import { look } from '../support/browser.mjs';
import { height, post } from './heights.mjs';

const [page, tiles, modules, picture] = process.argv.slice(2);
// Runs in the page: waits until its viewer has drawn all it wants to, then looks at the canvas and at the ground below it.
async function watch() {
  const result = window.result = { failures: [], ground: [], pixels: [] };
  const { pixels, rest } = await import('/support/page.mjs');
  while (!window.viewer) await new Promise((done) => setTimeout(done, 50));
  try {
    const { scene, camera } = window.viewer;
    const drawn = () => scene.globe.tilesLoaded && scene.globe._surface._tilesToRender.length > 0;
    await rest(scene, drawn);
    const { clientWidth, clientHeight } = scene.canvas, step = 16, places = [];
    for (let y = step; y < clientHeight; y += step) {
      for (let x = step; x < clientWidth; x += step) places.push([x, y]);
    }
    for (const [x, y] of places) {
      const hit = scene.globe.pick(camera.getPickRay(new Cesium.Cartesian2(x, y)), scene);
      const at = hit && Cesium.Cartographic.fromCartesian(hit);
      result.ground.push(at ? [Cesium.Math.toDegrees(at.longitude), Cesium.Math.toDegrees(at.latitude), at.height] : null);
    }
    scene.render();
    const { width, height, data } = pixels(scene.canvas.getContext('webgl2'));
    for (const [x, y] of places) {
      const at = 4 * ((height - 1 - Math.floor(y * height / clientHeight)) * width + Math.floor(x * width / clientWidth));
      result.pixels.push(Array.from(data.slice(at, at + 3)));
    }
    result.levels = Math.max(...scene.globe._surface._tilesToRender.map((tile) => tile.level));
  } catch (error) { result.failures.push(String(error.stack || error)); }
  window.finished = true;
}
const { result, faults } = await look({
  page, modules, picture, roots: { '/page/tiles/': path.join(tiles, 'mesh') }, script: `(${watch})();`,
  mirrors: { 'https://cesium.com/downloads/cesiumjs/releases/1.140/': path.join(modules, 'cesium') } });

const seen = {};
if (result && result.failures.length === 0) {
  // Not within a degree of the raster's rim.
  const inside = result.ground.map((at, k) => [at, k]).filter(([at]) => at && at[0] > 5 && at[0] < 13.5 && at[1] > 43 && at[1] < 48.9);
  seen.share = inside.length / result.ground.length;
  seen.off_m = inside.reduce((sum, [at]) => sum + Math.abs(at[2] - height(...post(at[0], at[1]))), 0) / inside.length;
  // Dry ground is drawn in the page's colour, lit but not dazzling.
  const dry = inside.filter(([at]) => height(...post(at[0], at[1])) > 100).map(([, k]) => result.pixels[k]);
  seen.ground = dry.filter(([r, g, b]) => r > g && g > b && r > 80 && r < 230).length / dry.length;
  if (!(seen.share > 0.2)) faults.push(`the data fill ${seen.share} of the picture`);
  if (!(seen.off_m < 100)) faults.push(`what is drawn lies ${seen.off_m} m off on average`);
  if (!(seen.ground > 0.9)) faults.push(`${seen.ground} of the ground has the ground's colour`);
}
console.log(JSON.stringify({ ...seen, level: result?.levels, faults }));
process.exit(faults.length > 0 ? 1 : 0);
