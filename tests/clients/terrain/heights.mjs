// SPDX-License-Identifier: MIT
// Mountains by a formula on the posts of zoom 5, as an ASCII grid: node heights.mjs FILE. Imported: the same heights.
import { writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

export const step = 0.703125 / 32;
export const grid = { west: 4, south: 42, columns: 480, rows: 360 };
const first = { i: Math.ceil((grid.west + 180) / step), j: Math.ceil((grid.south + 90) / step) };
export const longitude = (i) => (first.i + i) * step - 180;
export const latitude = (j) => (first.j + j) * step - 90;
export const post = (east, north) => [(east + 180) / step - first.i, (north + 90) / step - first.j];  // may lie between posts
export function height(i, j) {
  const a = longitude(i) * Math.PI / 180, b = latitude(j) * Math.PI / 180;
  let sum = 600;
  for (let octave = 0, scale = 1800; octave < 7; ++octave, scale *= 0.55) {
    const k = 9 * 2 ** octave;
    sum += scale * (1 - 2 * Math.abs(Math.sin(k * a + octave) * Math.cos((k + 1) * b + 2 * octave)));
  }
  return Math.fround(sum);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const lines = [`ncols ${grid.columns}`, `nrows ${grid.rows}`, `xllcenter ${longitude(0)}`, `yllcenter ${latitude(0)}`,
                 `cellsize ${step}`, 'NODATA_value -99999'];
  for (let j = grid.rows - 1; j >= 0; --j) {
    lines.push(Array.from({ length: grid.columns }, (_, i) => height(i, j).toFixed(3)).join(' '));
  }
  writeFileSync(process.argv[2], lines.join('\n') + '\n');
}
