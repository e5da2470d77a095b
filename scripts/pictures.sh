#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the pictures of README.md anew, from generated models, with the program in build/release.
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
