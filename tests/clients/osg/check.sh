#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A tileset as OpenSceneGraph files: fewer triangles the farther away, just those of the source from near, and after the folder
# was moved. check.sh LODESTONE_OSGB COUNT_TRIANGLES TILESET.json WORK_FOLDER
set -euo pipefail
work=$4
rm -rf "$work" && mkdir -p "$work"
"$1" "$3" "$work/first"
mv "$work/first" "$work/moved"
mapfile -t counts < <("$2" "$work/moved/main.osgb" 500 20 5 0.01)
echo "triangles from 500, 20, 5 and 0.01 radii: ${counts[*]}"
source=$(awk '/triangles in the source/ { print $1 }' "$(dirname "$3").told")
echo "triangles in the source: $source"
[ "${#counts[@]}" = 4 ]
[ "${counts[0]}" -gt 0 ] && [ "${counts[0]}" -lt "${counts[3]}" ]
[ "${counts[3]}" = "$source" ]
[ "${counts[0]}" -le "${counts[1]}" ] && [ "${counts[1]}" -le "${counts[2]}" ] && [ "${counts[2]}" -le "${counts[3]}" ]
rm "$work"/moved/Data/L1_0_children.osgb
if "$2" "$work/moved/main.osgb" 0.01 >/dev/null 2>&1; then echo "a missing file was not noticed"; exit 1; fi
