#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The npm packages of all clients, into FOLDER/node_modules: install.sh FOLDER
set -euo pipefail
. "$(dirname "$0")/need.sh"
need_program npm
packages=(gltf-validator@2.0.0-dev.3.10 playwright-core@1.65.1 cesium@1.140.0 three@0.187.0 3d-tiles-renderer@0.5.3
          @here/quantized-mesh-decoder@1.2.8 @loaders.gl/core@4.3.3 @loaders.gl/terrain@4.3.3)
mkdir -p "$1" && cd "$1"
echo '{"private": true}' >package.json
missing() { for one in "${packages[@]}"; do [ -d "node_modules/${one%@*}" ] || echo "$one"; done; }
[ -n "$(missing)" ] || exit 0
options=(--no-audit --no-fund --silent --ignore-scripts)
npm install "${options[@]}" "${packages[@]}" && exit 0
# All at once is fastest; what one lacks must not keep the others from those they have.
for package in $(missing); do npm install "${options[@]}" "$package" || skip "npm could not install $package"; done
