#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Shows a generated tileset to real clients: gltf-validator, 3DTilesRendererJS and CesiumJS.
#
#   clients.sh tiles PROGRAM FOLDER                makes the tileset (PROGRAM = example outcrop_to_3dtiles)
#   clients.sh packed PROGRAM FOLDER               one with all that a client must know the extension of (PROGRAM =
#                                                  lodestone): packed vertices, WebP, features (beds, as it were)
#   clients.sh validator|three|cesium MODULES TILES
#
# PICTURES=PREFIX keeps what the browsers show.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../support/need.sh"

case "$1" in
  tiles)
    rm -rf "$3"
    "$2" "$3" | tee "$3.told" ;;
  packed)
    rm -rf "$3" "$3.source" && mkdir -p "$3.source"
    "$2" generate outcrop -o "$3.source/plain.obj" --triangles 12000 --textures 2 --texture-size 256 --quiet
    awk '/^f / && ++faces % 3000 == 1 { print "g bed_" ++beds } 1' "$3.source/plain.obj" >"$3.source/beds.obj"
    "$2" outcrop "$3.source/beds.obj" -o "$3" --compress meshopt --image webp --tile-bytes 60000 --quiet
    grep -aq '"EXT_mesh_features"' "$3"/tiles/L0_0.glb ;;
  validator)
    need_program node
    need_package "$2" gltf-validator
    node "$here/../support/validate.mjs" "$2" "$3/tiles" ;;
  three | cesium)
    need_browser "$2"
    need_package "$2" "$1"
    node "$here/look.mjs" "$1" "$3" "$2" ${PICTURES:+"$PICTURES"} ;;
  *) sed -n '3,11s/^# \{0,1\}//p' "$0"; exit 2 ;;
esac
