#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Shows a generated terrain pyramid to real clients: two quantized-mesh decoders, CesiumJS, gltf-validator.
#
#   clients.sh install FOLDER                         npm packages into FOLDER
#   clients.sh tiles LODESTONE FOLDER                 makes heights and pyramids of them (LODESTONE = the program)
#   clients.sh decoders|cesium|validator MODULES TILES
#
# What is not there (npm, node, the registry, Chromium) is printed as "SKIPPED: reason".
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
skip() { echo "SKIPPED: $1"; exit 0; }
command -v node >/dev/null || skip "node is not installed"

case "$1" in
  install)
    command -v npm >/dev/null || skip "npm is not installed"
    mkdir -p "$2" && cd "$2"
    [ -f package.json ] || echo '{"private": true}' >package.json
    for package in @here/quantized-mesh-decoder@1.2.8 @loaders.gl/core@4.3.3 @loaders.gl/terrain@4.3.3 \
                   gltf-validator@2.0.0-dev.3.10 cesium@1.140.0 playwright-core@1.65.1; do
      [ -d "node_modules/${package%@*}" ] && continue
      npm install --no-audit --no-fund --silent --ignore-scripts "$package" || skip "npm could not install $package"
    done ;;
  tiles)
    rm -rf "$3"
    mkdir -p "$3"
    node "$here/heights.mjs" "$3/heights.asc"
    "$2" terrain "$3/heights.asc" -o "$3/mesh" --max-error 20m --sea-level 0m --quiet
    "$2" terrain "$3/heights.asc" -o "$3/tiles3d" --max-error 40m --max-zoom 3 --as 3dtiles --quiet ;;
  decoders)
    [ -d "$2/@loaders.gl/terrain" ] || skip "the npm packages are not installed"
    node "$here/decoders.mjs" "$2" "$3" ;;
  validator)
    [ -d "$2/gltf-validator" ] || skip "gltf-validator is not installed"
    node "$here/validate.mjs" "$2" "$3/tiles3d" ;;
  cesium)
    [ -d "$2/playwright-core" ] || skip "the npm packages are not installed"
    [ -x "${CHROMIUM:-/usr/bin/chromium}" ] || skip "Chromium is not installed (scripts/deps.sh clients)"
    node "$here/look.mjs" "$3" "$2" ${PICTURES:+"$PICTURES"} ;;
  *) sed -n '3,10s/^# \{0,1\}//p' "$0"; exit 2 ;;
esac
