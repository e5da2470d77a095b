#!/bin/sh
# SPDX-License-Identifier: MIT
# Drives the window as a person would, on a display of its own: opens MODEL coloured by triangle size, takes a picture,
# drags the slider to the left, takes another, presses "+" until it is fine again, takes a third.
# usage: drive_window.sh VIEWER MODEL FOLDER   ->  FOLDER/fine.png, coarse.png, again.png
# Exit code 77: a tool is missing (its name is printed).
set -eu
viewer=$1 model=$2 out=$3
for tool in Xvfb xdotool import; do
  command -v "$tool" > /dev/null || { echo "missing $tool"; exit 77; }
done

display_file=$out/display
Xvfb -displayfd 3 -screen 0 1100x700x24 +extension GLX 3> "$display_file" > /dev/null 2>&1 &
xvfb=$!
viewer_pid=
stop() {
  [ -z "$viewer_pid" ] || kill "$viewer_pid" 2> /dev/null || true
  kill "$xvfb" 2> /dev/null || true
}
trap stop EXIT
for _ in $(seq 100); do
  [ -s "$display_file" ] && break
  sleep 0.1
done
DISPLAY=:$(cat "$display_file")
export DISPLAY LIBGL_ALWAYS_SOFTWARE=1

"$viewer" "$model" --width 1000 --height 640 --lod-colors 2> "$out/stderr" &
viewer_pid=$!
window=
for _ in $(seq 300); do
  window=$(xdotool search --name "$(basename "$model") - Lodestone" 2> /dev/null | head -n 1) && [ -n "$window" ] && break
  kill -0 "$viewer_pid" || { cat "$out/stderr"; exit 1; }
  sleep 0.1
done
[ -n "$window" ] || { echo "the window never showed the model"; exit 1; }
# The slider's row in the panel, measured from the window's corner.
slider_y=85
picture() {
  sleep 4
  import -window "$window" "$out/$1.png"
}
picture fine
xdotool mousemove --window "$window" 320 $slider_y mousedown 1
sleep 0.3
xdotool mousemove --window "$window" 180 $slider_y
sleep 0.3
xdotool mousemove --window "$window" 24 $slider_y
sleep 0.3
xdotool mouseup 1
picture coarse
xdotool mousemove --window "$window" 700 400
for _ in $(seq 25); do
  xdotool key --window "$window" plus
  sleep 0.05
done
picture again
