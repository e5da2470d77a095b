#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the pictures of README.md and docs/sweeps.md anew, from generated models, with the program in build/release
# and ImageMagick's montage.
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
"$lodestone" build "$folder/house.obj" --method edge-collapse -o "$folder/collapsed.lode"
"$lodestone" sweep "$folder/collapsed.lode" --frames 600 --and-back --size 320x240 -o "$folder/sweep"
montage "$folder"/sweep/frame_00{000,060,120,160,200,240,280,299}.png -tile 4x2 -geometry 320x240+1+1 -quality 88 \
  docs/images/house_sweep.jpg
