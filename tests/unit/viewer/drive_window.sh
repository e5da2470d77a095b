#!/bin/sh
# SPDX-License-Identifier: MIT
# Drives the window as a person would, on a display of its own: opens MODEL coloured by triangle size, takes a picture,
# drags the slider to the left, takes another, presses "+" until it is fine again, takes a third, drops file SECOND on it
# (by drop_file), takes a fourth.
# usage: drive_window.sh VIEWER MODEL FOLDER DROPPER SECOND   ->  FOLDER/fine.png, coarse.png, again.png, dropped.png
# Exit code 77: a tool is missing (its name is printed). 78: the X server failed, not the viewer (worth another try).
set -eu
viewer=$1 model=$2 out=$3 dropper=$4 second=$5
for tool in Xvfb xdotool import convert; do
  command -v "$tool" > /dev/null || { echo "missing $tool"; exit 77; }
done

viewer_pid=
xvfb_pid=
stop() {
  [ -z "$viewer_pid" ] || kill "$viewer_pid" 2> /dev/null || true
  [ -z "$xvfb_pid" ] || kill "$xvfb_pid" 2> /dev/null || true
}
trap stop EXIT

# wait_for SECONDS COMMAND...: until the command succeeds.
wait_for() {
  end=$(($(date +%s) + $1))
  shift
  until "$@"; do
    [ "$(date +%s)" -lt $end ] || return 1
    sleep 0.1
  done
}

server_failed() {
  echo "the X server $1; it printed:"
  cat "$out/xvfb.log"
  exit 78
}

# $? of a command that a signal ended is 128 and the signal's number.
viewer_ended() {
  code=0
  wait "$viewer_pid" || code=$?
  viewer_pid=
  DISPLAY=$display xdotool getdisplaygeometry > /dev/null 2>&1 || server_failed "died under the viewer"
  echo "the viewer ended by itself, $([ $code -gt 128 ] && echo "signal $((code - 128))" || echo "code $code"); it printed:"
  cat "$out/stderr"
  exit 1
}

# -noreset: without it the server starts anew whenever its last client leaves, and drops who connects meanwhile; here
# every look for the window may be the last client. `read` succeeds on a whole line only.
rm -f "$out/display"
Xvfb -displayfd 3 -noreset -nolisten tcp -screen 0 1100x700x24 +extension GLX 3> "$out/display" > "$out/xvfb.log" 2>&1 &
xvfb_pid=$!
export xvfb_pid  # for tests of this script, whose viewer ends the server
display_known() {
  kill -0 "$xvfb_pid" 2> /dev/null || server_failed "did not start"
  [ -e "$out/display" ] && read -r number < "$out/display"
}
wait_for 60 display_known || server_failed "named no display"
display=:$number
export DISPLAY="$display" LIBGL_ALWAYS_SOFTWARE=1
wait_for 30 xdotool getdisplaygeometry > /dev/null 2>&1 || server_failed "does not answer"

"$viewer" "$model" --width 1000 --height 640 --lod-colors 2> "$out/stderr" &
viewer_pid=$!
window=
# shows FILE: once the window has its name.
shows() {
  kill -0 "$viewer_pid" 2> /dev/null || viewer_ended
  window=$(xdotool search --name "$(basename "$1") - Lodestone" 2> /dev/null | head -n 1)
  [ -n "$window" ]
}
wait_for 120 shows "$model" || { echo "the window never showed the model"; exit 1; }

# look NAME: takes the picture; `now` becomes a number for what is drawn right of the panel, whose graph of frame times
# never rests.
look() {
  kill -0 "$viewer_pid" 2> /dev/null || viewer_ended
  import -window "$window" "$out/$1.png"
  now=$(convert "$out/$1.png" -crop 640x640+360+0 rgb:- | cksum)
}
# picture NAME: once the model is drawn other than in the picture before, and has then come to rest for a second.
last=
changed() {
  look "$1"
  [ "$now" != "$last" ]
}
at_rest() {
  look "$1"
  if [ "$now" = "$last" ]; then same=$((same + 1)); else same=0; fi
  last=$now
  sleep 0.2
  [ $same -ge 4 ]
}
picture() {
  wait_for 60 changed "$1" || { echo "$1: nothing changes in the window"; exit 1; }
  same=0
  wait_for 60 at_rest "$1" || { echo "$1: the window does not come to rest"; exit 1; }
}

# The slider's row in the panel, measured from the window's corner.
slider_y=85
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
"$dropper" "$window" "$second"
wait_for 60 shows "$second" || { echo "the window never showed what was dropped on it"; exit 1; }
picture dropped
