// SPDX-License-Identifier: MIT
// gltf-validator over every glb of a tileset, and its volumes: node validate.mjs NODE_MODULES TILESET
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { faults_of } from '../support/validate.mjs';

const [modules, folder] = process.argv.slice(2);
const faults = [];
let count = 0;
const inside = (a, b) => a[0] >= b[0] - 1e-12 && a[1] >= b[1] - 1e-12 && a[2] <= b[2] + 1e-12 && a[3] <= b[3] + 1e-12 &&
                         a[4] >= b[4] && a[5] <= b[5];
async function look(tile, parent) {
  const region = tile.boundingVolume.region;
  if (parent && !inside(region, parent.boundingVolume.region)) faults.push(`${tile.content?.uri} is not inside its parent`);
  if (parent && tile.geometricError > parent.geometricError) faults.push(`${tile.content?.uri} has a larger error than its parent`);
  if (tile.content) {
    faults.push(...await faults_of(modules, path.join(folder, tile.content.uri)));
    ++count;
  }
  for (const child of tile.children ?? []) await look(child, tile);
}
await look(JSON.parse(readFileSync(path.join(folder, 'tileset.json'))).root, null);
if (count < 4) faults.push(`only ${count} tiles`);
console.log(JSON.stringify({ tiles: count, faults }));
process.exit(faults.length > 0 ? 1 : 0);
