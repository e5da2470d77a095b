// SPDX-License-Identifier: MIT
// gltf-validator: node validate.mjs MODULES FILES_OR_FOLDERS... Imported: faults_of(modules, file), a list of lines.
import fs from 'fs';
import path from 'path';
import { createRequire } from 'module';
import { fileURLToPath } from 'url';

export async function faults_of(modules, file) {
  const validator = createRequire(path.resolve(modules, 'here.js'))('gltf-validator');
  const { issues } = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 20 });
  if (issues.numErrors + issues.numWarnings === 0) return [];
  return issues.messages.filter((one) => one.severity < 2).slice(0, 3)
               .map((one) => `${file}: ${one.code} ${one.pointer}: ${one.message}`);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [modules, ...names] = process.argv.slice(2);
  const files = names.flatMap((name) => fs.statSync(name).isDirectory()
    ? fs.readdirSync(name).filter((one) => one.endsWith('.glb')).map((one) => path.join(name, one)) : [name]);
  let bad = 0;
  for (const file of files) {
    const faults = await faults_of(modules, file);
    if (faults.length > 0) ++bad;
    faults.forEach((fault) => console.log(fault));
  }
  console.log(`${files.length} files, ${bad} with errors or warnings`);
  process.exit(bad > 0 || files.length === 0 ? 1 : 0);
}
