#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Shows a generated terrain pyramid to real clients: two quantized-mesh decoders, CesiumJS, gltf-validator.
#
#   clients.sh tiles LODESTONE FOLDER                 makes heights and pyramids of them (LODESTONE = the program)
#   clients.sh decoders|cesium|viewer|tiles3d|validator MODULES TILES
#
# PICTURES=PREFIX keeps what the browser shows.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../support/need.sh"
need_program node

case "$1" in
  tiles)
    rm -rf "$3"
    mkdir -p "$3"
    node "$here/heights.mjs" "$3/heights.asc"
    "$2" terrain "$3/heights.asc" -o "$3/mesh" --max-error 20m --sea-level 0m --quiet
    "$2" terrain "$3/heights.asc" -o "$3/tiles3d" --max-error 40m --max-zoom 4 --as 3dtiles --quiet ;;
  decoders)
    need_package "$2" @here/quantized-mesh-decoder
    need_package "$2" @loaders.gl/terrain
    node "$here/decoders.mjs" "$2" "$3" ;;
  validator)
    need_package "$2" gltf-validator
    node "$here/validate.mjs" "$2" "$3/tiles3d" ;;
  cesium)
    need_browser "$2"
    need_package "$2" cesium
    node "$here/look.mjs" "$3" "$2" ${PICTURES:+"${PICTURES}_terrain.png"} ;;
  tiles3d)
    need_browser "$2"
    need_package "$2" cesium
    node "$here/tiles3d.mjs" "$3/tiles3d" "$2" ${PICTURES:+"${PICTURES}_terrain_tiles3d.png"} ;;
  viewer)
    need_browser "$2"
    need_package "$2" cesium
    node "$here/viewer.mjs" "$here/../../../examples/terrain_viewer/index.html" "$3" "$2" ${PICTURES:+"${PICTURES}_terrain_viewer.png"} ;;
  *) sed -n '3,9s/^# \{0,1\}//p' "$0"; exit 2 ;;
esac
