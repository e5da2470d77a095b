// SPDX-License-Identifier: MIT
// Opens a tileset in a real client in headless Chromium and checks what it shows.
//
//     node look.mjs three|cesium TILESET_FOLDER NODE_MODULES [PICTURE_PREFIX]
//
// Ends with 1 and says why if a request failed, if the client does not load finer tiles as it comes nearer, or if the
// pictures are not of rock. Nothing but the loopback interface is asked for anything.
import fs from 'fs';
import path from 'path';
import { fileURLToPath } from 'url';
import { look } from '../support/browser.mjs';

const [client, tileset, modules, pictures] = process.argv.slice(2);
const distances = [6, 2, 0.6];
const { result, faults, requested } = await look({
  page: path.join(path.dirname(fileURLToPath(import.meta.url)), `${client}.html`), modules, roots: { '/tiles/': tileset },
  query: `?tileset=/tiles/tileset.json&distances=${distances.join(',')}`,
  picture: pictures ? `${pictures}_${client}.png` : null });
const asked = requested.filter((name) => name.startsWith('/tiles/tiles/')).length;
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
