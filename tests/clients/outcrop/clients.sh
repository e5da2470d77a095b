#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Shows a generated tileset to real clients: gltf-validator, 3DTilesRendererJS and CesiumJS.
#
#   clients.sh tiles PROGRAM FOLDER                makes the tileset (PROGRAM = example outcrop_to_3dtiles)
#   clients.sh validator|three|cesium MODULES TILES
#
# PICTURES=PREFIX keeps what the browsers show.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../support/need.sh"

case "$1" in
  tiles)
    rm -rf "$3"
    "$2" "$3" ;;
  validator)
    need_program node
    need_package "$2" gltf-validator
    node "$here/../support/validate.mjs" "$2" "$3/tiles" ;;
  three | cesium)
    need_browser "$2"
    need_package "$2" "$1"
    node "$here/look.mjs" "$1" "$3" "$2" ${PICTURES:+"$PICTURES"} ;;
  *) sed -n '3,9s/^# \{0,1\}//p' "$0"; exit 2 ;;
esac
