#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the pictures of README.md, docs/sweeps.md and docs/buildings.md anew, from generated models and the IFC house of
# assimp-testmodels, with the programs in build/release and ImageMagick's montage.
set -euo pipefail
cd "$(dirname "$0")/.."
lodestone=$PWD/build/release/cli/lodestone
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
mkdir -p docs/images
for kind in house outcrop; do
  options=(--triangles 100000)
  if [ $kind = house ]; then options+=(--roof hip); fi
  "$lodestone" generate $kind "${options[@]}" -o "$folder/$kind.obj"
  "$lodestone" build "$folder/$kind.obj" -o "$folder/$kind.lode"
  "$lodestone" render "$folder/$kind.lode" --sheet 8 --size 360x270 --white -o "docs/images/${kind}_levels.jpg"
done
"$lodestone" generate house --roof spire --triangles 20000 -o "$folder/spire.obj"
"$lodestone" build "$folder/spire.obj" --method facet-shift -o "$folder/spire.lode"
"$lodestone" render "$folder/spire.lode" --sheet 8 --size 360x270 --white -o docs/images/facet_shift_levels.jpg
ifc=/usr/share/assimp/models/IFC/AC14-FZK-Haus.ifc  # of assimp-testmodels
if [ -e $ifc ]; then
  "$lodestone" build $ifc --method facet-shift -o "$folder/ifc.lode"
  for triangles in 35906 08000 02000 01000 00500 00250 00120 00012; do
    "$lodestone" render "$folder/ifc.lode" --triangles $((10#$triangles)) --white --size 360x270 -o "$folder/ifc_$triangles.png"
  done
  montage $(ls -r "$folder"/ifc_*.png) -tile 4x2 -geometry 360x270+1+1 -quality 86 docs/images/ifc_house_levels.jpg
fi
build/release/examples/street_by_distance "$folder/street.glb"
"$lodestone" render "$folder/street.glb" --eye 0,-30,4 --target 0,100,3 --fov 46 --size 800x450 --wireframe \
  -o docs/images/street_by_distance.jpg
"$lodestone" build "$folder/house.obj" --method edge-collapse -o "$folder/collapsed.lode"
"$lodestone" sweep "$folder/collapsed.lode" --frames 600 --and-back --size 320x240 -o "$folder/sweep"
montage "$folder"/sweep/frame_00{000,060,120,160,200,240,280,299}.png -tile 4x2 -geometry 320x240+1+1 -quality 88 \
  docs/images/house_sweep.jpg

# One tile of generated mountains by all methods of docs/terrain.md, drawn thirty times too high: the posts, then each method.
node tests/clients/terrain/heights.mjs "$folder/heights.asc"
pictures=()
tile() {  # NAME OPTIONS...
  local name=$1
  shift
  "$lodestone" terrain "$folder/heights.asc" -o "$folder/$name" --quiet "$@"
  scripts/terrain_obj.py "$folder/$name/5/33/24.terrain" "$folder/$name.obj" 14000
  for style in shaded wireframe; do
    local options=()
    if [ $style = wireframe ]; then options=(--wireframe); fi
    "$lodestone" render "$folder/$name.obj" --up z --size 400x190 --fov 25 --eye 7000,-13000,13500 --target 7000,5200,1700 \
      "${options[@]}" --quiet -o "$folder/$name-$style.png"
  done
  pictures+=("$folder/$name-shaded.png" "$folder/$name-wireframe.png")
}
tile posts --max-error 0.01m
tile greedy --max-error 100m
tile edge-collapse --max-error 100m --method edge-collapse
tile points-random --max-error 100m --method points-random --keep 0.01
tile points-grid --max-error 100m --method points-grid --cell 10
tile points-hierarchy --max-error 100m --method points-hierarchy --cluster 200
tile points-wlop --max-error 100m --method points-wlop --keep 0.01
montage "${pictures[@]}" -tile 4x -geometry 400x190+1+1 -quality 86 docs/images/terrain_methods.jpg
