#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# An outcrop of the size of Model 1 of Ao et al. 2025, built at ratios 0.5 and 0.8 on one thread and on two. Needs
# ImageMagick and 5 GB. What the photographs show does not matter here: they are one file under 103 names.
# outcrop_model1.sh FOLDER [BUILD_FOLDER]
set -euo pipefail
work=$1
build=${2:-build/release}
lodestone=$(realpath "$build/cli/lodestone")
bench=$(realpath "$build/bench/bench_outcrop")
mkdir -p "$work/model1_textures"
cd "$work"
"$lodestone" generate outcrop -o photo.obj --triangles 2000 --textures 1 --texture-size 6324 --seed 1 --quiet >/dev/null
convert photo_textures/*.png -quality 92 photo.jpg
"$lodestone" generate outcrop -o model1.obj --triangles 1145853 --textures 103 --texture-size 64 --seed 1 --quiet >/dev/null
sed -i 's/\.png/.jpg/' model1.mtl
for i in $(seq -f %03g 0 102); do ln -f photo.jpg "model1_textures/outcrop_$i.jpg"; done
for ratio in 0.5 0.8; do
  for threads in 1 2; do
    "$bench" build model1.obj "tiles_$ratio" "$ratio" "$threads"
    rm -rf "tiles_$ratio"
  done
done
