#!/usr/bin/env bash
# Makes the pictures of the window in docs/ on the samples: start, result, hypothesis, rectified pair, sequences, and the
# replay as an animated picture (WebP).
#
#     cargo build --release -p epiline && lab/pictures.sh target/release/epiline docs
#
# Needs Xvfb, xdotool and ImageMagick. The window runs on a display of its own.
set -euo pipefail

program=$(realpath "$1")
output=$2
display=:93
frames=40
pause=0.4
folder=$(mktemp -d)

Xvfb "$display" -screen 0 1280x800x24 >"$folder/xvfb" 2>&1 &
server=$!
trap 'kill "${window:-}" "$server" 2>/dev/null || true; rm -rf "$folder"' EXIT
sleep 1
export DISPLAY=$display
unset WAYLAND_DISPLAY

# Starts the program, and moves the cursor to a place without a tooltip.
start() {
    HOME=$folder/home "$program" "$@" >"$folder/log" 2>&1 &
    window=$!
    name=$(timeout 30 xdotool search --sync --onlyvisible --pid "$window" --name Epiline | head -1)
    xdotool windowmove "$name" 0 0 windowsize "$name" 1280 800
    xdotool windowfocus --sync "$name"
    sleep 2
}

keys() {
    xdotool key "$@"
}

# Saves a picture of the window.
picture() {
    import -window root "$folder/shot.png"
    convert "$folder/shot.png" -quality 85 "$output/$1.webp"
}

start
xdotool mousemove 250 400
sleep 1
picture inspection-start
xdotool mousemove 640 790
keys s
for ((k = 0; k < frames; k++)); do
    import -window root "$folder/$(printf %03d "$k").png"
    sleep "$pause"
done
convert -delay 50 -loop 0 "$folder"/0*.png -resize 960x -quality 60 "$output/replay.webp"
keys End 2
xdotool mousemove 250 400
sleep 2
picture inspection-result
keys 6
sleep 8
xdotool mousemove 500 220
sleep 1
picture inspection-rectified
keys 5 1
sleep 1
xdotool mousemove 420 684 click 1 mousemove 640 790
sleep 2
picture inspection-hypothesis
kill "$window"
wait "$window" 2>/dev/null || true

start --sequences
sleep 20
keys ctrl+k
sleep 1
xdotool type --delay 40 "find without"
sleep 1
keys Return
sleep 15
keys End 2
sleep 2
picture inspection-sequences
ls -l "$output"/*.webp
