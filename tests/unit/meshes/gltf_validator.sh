#!/bin/sh
# SPDX-License-Identifier: MIT
# Every GLB that write_glbs makes passes gltf-validator without errors or warnings.
#   gltf_validator.sh WRITE_GLBS FOLDER
# The validator is an npm package, installed into FOLDER; without node, npm or a registry the test is skipped.
set -u
write_glbs=$1
folder=$2
mkdir -p "$folder/glb"
command -v node >/dev/null && command -v npm >/dev/null || { echo "SKIPPED: node and npm are not installed"; exit 77; }
if [ ! -d "$folder/node_modules/gltf-validator" ]; then
  npm install --silent --no-audit --no-fund --prefix "$folder" gltf-validator >/dev/null 2>&1 ||
    { echo "SKIPPED: npm cannot install gltf-validator"; exit 77; }
fi
"$write_glbs" "$folder/glb" || exit 1
cd "$folder" && node -e '
const validator = require("gltf-validator"), fs = require("fs");
(async () => {
  let bad = 0;
  const files = fs.readdirSync("glb").filter(name => name.endsWith(".glb"));
  for (const name of files) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync("glb/" + name)));
    if (report.issues.numErrors + report.issues.numWarnings === 0) continue;
    ++bad;
    for (const m of report.issues.messages) if (m.severity < 2) console.log(name, m.code, m.pointer, m.message);
  }
  console.log(files.length + " files, " + bad + " bad");
  process.exit(files.length > 0 && bad === 0 ? 0 : 1);
})();'
