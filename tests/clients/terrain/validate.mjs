// SPDX-License-Identifier: MIT
// gltf-validator over every glb of a tileset, and its volumes: node validate.mjs NODE_MODULES TILESET
import { readdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { faults_of } from '../support/validate.mjs';

const [modules, folder] = process.argv.slice(2);
const faults = [];
const seen = new Set();
const inside = (a, b) => a[0] >= b[0] - 1e-12 && a[1] >= b[1] - 1e-12 && a[2] <= b[2] + 1e-12 && a[3] <= b[3] + 1e-12 &&
                         a[4] >= b[4] && a[5] <= b[5];
let files = 1;
async function look(tile, parent, at) {
  const region = tile.boundingVolume.region;
  if (parent && !inside(region, parent.boundingVolume.region)) faults.push(`${tile.content?.uri} is not inside its parent`);
  if (parent && tile.geometricError > parent.geometricError) faults.push(`${tile.content?.uri} has a larger error than its parent`);
  const content = tile.content && path.join(at, tile.content.uri);
  if (content?.endsWith('.json')) {
    ++files;
    if (tile.children) faults.push(`${content} has children here as well`);
    const below = JSON.parse(readFileSync(path.join(folder, content)));
    if (below.geometricError !== tile.geometricError) faults.push(`${content} has another error than where it is named`);
    await look(below.root, tile, path.dirname(content));
  } else if (content) {
    if (seen.has(content)) faults.push(`${content} is there twice`);
    seen.add(content);
    faults.push(...await faults_of(modules, path.join(folder, content)));
  }
  for (const child of tile.children ?? []) await look(child, tile, at);
}
await look(JSON.parse(readFileSync(path.join(folder, 'tileset.json'))).root, null, '.');
const glbs = readdirSync(folder, { recursive: true }).filter((name) => name.endsWith('.glb'));
if (glbs.length !== seen.size || seen.size < 6) faults.push(`${seen.size} tiles are named of ${glbs.length}`);
if (files < 2) faults.push('no tileset below the first');
console.log(JSON.stringify({ tiles: seen.size, files, faults }));
process.exit(faults.length > 0 ? 1 : 0);
