// SPDX-License-Identifier: MIT
// Every tile of a pyramid through two independent decoders: they agree on places, heights, triangles and borders, and
// neighbours have the same heights and normals on their borders.
//
//     node decoders.mjs NODE_MODULES TILES
import { readFileSync, readdirSync } from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { gunzipSync } from 'node:zlib';

const [modules, tiles] = process.argv.slice(2);
const require = createRequire(path.join(modules, 'here.js'));
const here = require('@here/quantized-mesh-decoder');
const decode = here.default?.default ?? here.default ?? here;
const { parse } = require('@loaders.gl/core');
const { QuantizedMeshLoader } = require('@loaders.gl/terrain');

const root = path.join(tiles, 'mesh');
const faults = [];
const demand = (right, what) => { if (!right && faults.length < 20) faults.push(what); };
const borders = new Map();
let count = 0, vertices = 0;
for (const z of readdirSync(root).filter((name) => /^\d+$/.test(name))) {
  for (const x of readdirSync(path.join(root, z))) {
    for (const file of readdirSync(path.join(root, z, x))) {
      const id = `${z}/${x}/${file}`;
      const bytes = gunzipSync(readFileSync(path.join(root, id)));
      const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
      const mine = decode(buffer);
      const n = mine.vertexData.length / 3;
      const [u, v, h] = [0, 1, 2].map((k) => mine.vertexData.subarray(k * n, (k + 1) * n));
      const { minHeight, maxHeight } = mine.header;
      const bounds = [0, 0, 32767, 32767];
      const other = await parse(buffer, QuantizedMeshLoader, { worker: false, 'quantized-mesh': { bounds } });
      const places = other.attributes.POSITION.value;
      demand(places.length === 3 * n, `${id}: ${places.length / 3} vertices, not ${n}`);
      for (let i = 0; i < n; ++i) {
        const height = minHeight + (maxHeight - minHeight) * h[i] / 32767;
        demand(Math.abs(places[3 * i] - u[i]) < 0.01 && Math.abs(places[3 * i + 1] - v[i]) < 0.01, `${id}: vertex ${i} lies elsewhere`);
        demand(Math.abs(places[3 * i + 2] - height) < 0.01, `${id}: vertex ${i} has another height`);
      }
      const indices = other.indices.value;
      demand(indices.length === mine.triangleIndices.length, `${id}: another number of triangles`);
      mine.triangleIndices.forEach((index, i) => demand(index === indices[i], `${id}: corner ${i} differs`));
      demand(mine.extensions.vertexNormals.length === 2 * n, `${id}: not every vertex has a normal`);
      demand([1, 65536].includes(mine.extensions.waterMask.byteLength), `${id}: no water mask`);
      for (const [side, list, along] of [['west', mine.westIndices, v], ['east', mine.eastIndices, v],
                                         ['south', mine.southIndices, u], ['north', mine.northIndices, u]]) {
        const normals = mine.extensions.vertexNormals;
        const line = Array.from(list, (i) => [along[i], minHeight + (maxHeight - minHeight) * h[i] / 32767, normals[2 * i], normals[2 * i + 1]]);
        borders.set(`${z}/${x}/${parseInt(file)}/${side}`, line.sort((a, b) => a[0] - b[0]));
      }
      ++count;
      vertices += n;
    }
  }
}
// From zoom 2 on every tile has data; the raster is a rectangle, so both tiles of a border have triangles along the same
// part of it.
let compared = 0;
for (const [key, line] of borders) {
  const [z, x, y, side] = key.split('/');
  if (Number(z) < 2 || (side !== 'east' && side !== 'north')) continue;
  const next = side === 'east' ? `${z}/${(Number(x) + 1) % (2 << z)}/${y}/west` : `${z}/${x}/${Number(y) + 1}/south`;
  const other = borders.get(next);
  if (!other || line.length < 2) continue;
  ++compared;
  demand(line.length === other.length && line.every(([a, h, x, y], i) => a === other[i][0] && Math.abs(h - other[i][1]) < 1e-6 && x === other[i][2] && y === other[i][3]),
         `${key} and ${next} differ`);
}
demand(count > 8 && compared > 4, `only ${count} tiles and ${compared} borders`);
console.log(JSON.stringify({ tiles: count, vertices, borders: compared, faults }));
process.exit(faults.length > 0 ? 1 : 0);
