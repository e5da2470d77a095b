// SPDX-License-Identifier: MIT
// The peer of bench_terrain: npm's delatin on the same tiles. Run where `npm install delatin` was run:
//   node terrain_delatin.mjs N30E079.hgt
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {pathToFileURL} from 'node:url';
const require = createRequire(process.cwd() + '/');
const {default: Delatin} = await import(pathToFileURL(require.resolve('delatin')).href);

const bytes = readFileSync(process.argv[2]);
const side = Math.round(Math.sqrt(bytes.length / 2));
const heights = new Float32Array(side * side);
let last = 0;
for (let i = 0; i < heights.length; i++) {
  const h = bytes.readInt16BE(2 * i);
  heights[i] = last = h === -32768 ? last : h;
}
const tiles = [];
for (let row = 0; row + 256 < side; row += 256) {
  for (let column = 0; column + 256 < side; column += 256) {
    const tile = new Float32Array(257 * 257);
    for (let y = 0; y <= 256; y++) for (let x = 0; x <= 256; x++) tile[y * 257 + x] = heights[(row + y) * side + column + x];
    tiles.push(tile);
  }
}
for (let warm = 0; warm < 4; warm++) new Delatin(tiles[0], 257, 257).run(5);
for (const tolerance of [1, 5, 10]) {
  let triangles = 0;
  const start = process.cpuUsage();
  for (const tile of tiles) {
    const delatin = new Delatin(tile, 257, 257);
    delatin.run(tolerance);
    triangles += delatin.triangles.length / 3;
  }
  const used = process.cpuUsage(start);
  console.log(JSON.stringify({peer: 'delatin', tolerance_m: tolerance, tiles: tiles.length, triangles,
    samples_per_second: Math.round(tiles.length * 65536 / (used.user / 1e6))}));
}
