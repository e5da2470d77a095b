#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Shows what Lodestone does, from an empty machine on: installs what is missing, builds, makes a detailed house and an
# outcrop, turns them into progressive models, draws eight levels and an animated sweep of each, and opens the window where
# there is a display.
#
#   scripts/demo.sh [--no-window]
#
# HOUSE_TRIANGLES and OUTCROP_TRIANGLES set the size of the two models, SWEEP_FRAMES the length of the sweeps, DEMO_FOLDER
# (out/demo) where all goes.
set -euo pipefail
cd "$(dirname "$0")/.."
window=yes
case "${1:-}" in
  "") ;;
  --no-window) window=no ;;
  *) sed -n '3,10s/^# \{0,1\}//p' "$0"; exit 1 ;;
esac

step() { printf '\n== %s (%d s)\n' "$1" "$SECONDS"; }

if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CMAKE_C_COMPILER_LAUNCHER=ccache
fi

step "packages"
scripts/deps.sh
step "build"
cmake --preset release | tail -n 1
cmake --build --preset release --target lodestone_program lodestone-view | tail -n 1
lodestone=$PWD/build/release/cli/lodestone

mkdir -p "${DEMO_FOLDER:=out/demo}"
cd "$DEMO_FOLDER"

make() {  # make NAME KIND OPTIONS...: generate, build, verify, sheet, sweep
  local name=$1 kind=$2
  shift 2
  step "$name: generate"
  "$lodestone" generate "$kind" "$@" -o "$name.glb"
  step "$name: build the progressive model"
  "$lodestone" build "$name.glb" -o "$name.lode"
  step "$name: verify every level"
  "$lodestone" verify "$name.lode" --source "$name.glb"
  step "$name: play it back"
  "$lodestone" play "$name.lode"
  step "$name: eight levels and a sweep"
  "$lodestone" render "$name.lode" --sheet 8 --size 480x360 -o "${name}_levels.png"
  "$lodestone" sweep "$name.lode" --frames "${SWEEP_FRAMES:-160}" --from 1 --to 0.01 --and-back --morph-seconds 0.5 \
    --size 480x360 --video "${name}_sweep.gif"
}

make house house --roof hip --triangles "${HOUSE_TRIANGLES:-120000}"
make outcrop outcrop --triangles "${OUTCROP_TRIANGLES:-200000}"

step "done"
echo "In $PWD:"
ls -sh1 -- *.glb *.lode *.png *.gif
if [ $window = yes ] && [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
  echo "Opening the window; drag the slider, close it to end."
  "$lodestone" view house.lode
else
  echo "No window opened; with a display: $lodestone view $PWD/house.lode"
fi
