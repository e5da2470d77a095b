#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Shows a generated tileset to real clients: gltf-validator, 3DTilesRendererJS and CesiumJS.
#
#   clients.sh install FOLDER                      npm packages into FOLDER
#   clients.sh tiles PROGRAM FOLDER                makes the tileset (PROGRAM = example outcrop_to_3dtiles)
#   clients.sh validator|three|cesium MODULES TILES
#
# What is not there (npm, the registry, Chromium) is printed as "SKIPPED: reason".
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
skip() { echo "SKIPPED: $1"; exit 0; }

case "$1" in
  install)
    command -v npm >/dev/null || skip "npm is not installed"
    mkdir -p "$2" && cd "$2"
    [ -f package.json ] || echo '{"private": true}' >package.json
    for package in gltf-validator@2.0.0-dev.3.10 three@0.187.0 3d-tiles-renderer@0.5.3 cesium@1.140.0 playwright-core@1.65.1; do
      [ -d "node_modules/${package%@*}" ] && continue
      npm install --no-audit --no-fund --silent "$package" || skip "npm could not install $package"
    done ;;
  tiles)
    rm -rf "$3"
    "$2" "$3" ;;
  validator)
    [ -d "$2/gltf-validator" ] || skip "gltf-validator is not installed"
    node "$here/validate.mjs" "$2" "$3"/tiles/*.glb ;;
  three | cesium)
    [ -d "$2/playwright-core" ] || skip "the npm packages are not installed"
    [ -x "${CHROMIUM:-/usr/bin/chromium}" ] || skip "Chromium is not installed (scripts/deps.sh clients)"
    node "$here/look.mjs" "$1" "$3" "$2" ${PICTURES:+"$PICTURES"} ;;
  *) sed -n '3,10s/^# \{0,1\}//p' "$0"; exit 2 ;;
esac
