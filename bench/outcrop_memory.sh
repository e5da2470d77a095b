#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Memory of an outcrop whose textures would take 10 GB decoded: 200 images of 4096 x 4096 pixels (four photographs under
# 200 names), built under --max-memory 512MB on one thread and on eight, and with a quarter of the images. Prints what
# the program says of its peak. Needs ImageMagick and 4 GB.
# outcrop_memory.sh FOLDER [BUILD_FOLDER] [TRIANGLES] [LIMIT] [SIZE_PX] ["IMAGES ..."]
set -euo pipefail
work=$1
lodestone=$(realpath "${2:-build/release}/cli/lodestone")
triangles=${3:-300000}
limit=${4:-512MB}
size=${5:-4096}
counts=${6:-200 50}
mkdir -p "$work"
cd "$work"
if [ ! -e photo_3.jpg ]; then
  "$lodestone" generate outcrop -o photo.obj --triangles 2000 --textures 4 --texture-size "$size" --seed 1 --quiet >/dev/null
  i=0
  for png in photo_textures/*.png; do convert "$png" -quality 92 "photo_$i.jpg"; i=$((i + 1)); done
  rm -r photo_textures
fi
for images in $counts; do
  name=outcrop_$images
  "$lodestone" generate outcrop -o "$name.obj" --triangles "$triangles" --textures $images --texture-size 64 --seed 1 --quiet >/dev/null
  sed -i 's/\.png/.jpg/' "$name.mtl"
  i=0
  for file in $(sed -n 's/^map_Kd //p' "$name.mtl"); do ln -f "photo_$((i % 4)).jpg" "$file"; i=$((i + 1)); done
  for threads in 1 8; do
    "$lodestone" outcrop "$name.obj" -o tiles --threads $threads --max-memory "$limit" --json --quiet >"report.json"
    python3 -c 'import json, sys; r = json.load(open("report.json")); print(json.dumps({"images": int(sys.argv[1]),
      "decoded_gigabytes": round(3e-3 * r["decoded_megapixels"], 2), "triangles": r["source_triangles"], "threads": int(sys.argv[2]),
      "max_memory": sys.argv[3], "peak_megabytes": round(1e-6 * r["peak_rss_bytes"]), "seconds": round(r["seconds"], 1)}))' $images $threads "$limit"
    rm -rf tiles
  done
done
