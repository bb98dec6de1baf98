#!/usr/bin/env bash
# Records the replay of the sample as an animated picture (WebP), from "Show me" to the result.
#
#     cargo build --release -p epiline && lab/replay-picture.sh target/release/epiline docs/replay.webp
#
# Needs Xvfb, xdotool and ImageMagick. The window runs on a display of its own.
set -euo pipefail

program=$1
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
HOME=$folder "$program" >"$folder/log" 2>&1 &
window=$!
name=$(timeout 30 xdotool search --sync --onlyvisible --name Epiline | head -1)
xdotool windowmove "$name" 0 0 windowsize "$name" 1280 800
sleep 2
# The button "Show me" is the first of the card.
xdotool mousemove 42 628 click 1 mousemove 640 790
for ((k = 0; k < frames; k++)); do
    import -window root "$folder/$(printf %03d "$k").png"
    sleep "$pause"
done
convert -delay 50 -loop 0 "$folder"/*.png -resize 960x -quality 60 "$output"
ls -l "$output"
