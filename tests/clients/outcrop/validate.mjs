// SPDX-License-Identifier: MIT
// gltf-validator on every payload: node validate.mjs NODE_MODULES FILES...
import fs from 'fs';
import path from 'path';
import { createRequire } from 'module';

const [modules, ...files] = process.argv.slice(2);
const validator = createRequire(path.join(modules, 'here.js'))('gltf-validator');
let faults = 0;
for (const file of files) {
  const { issues } = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 20 });
  if (issues.numErrors + issues.numWarnings === 0) continue;
  ++faults;
  for (const message of issues.messages.slice(0, 3)) console.log(`${file}: ${message.code} ${message.pointer}: ${message.message}`);
}
console.log(`${files.length} files, ${faults} with errors or warnings`);
process.exit(faults > 0 || files.length === 0 ? 1 : 0);
